#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/hub/locate/ellipse_least_squares.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame.hpp"

namespace echofuse::hub {

enum class SelectionMethod : std::uint8_t {
  kConsensus,  ///< the position that most nodes support explains its detections, then the next one
  kAllTuples,  ///< the paper: every nu-tuple whose weight and residual pass
};

enum class SelectionResidual : std::uint8_t {
  kRangeResidual,     ///< [m] RR (docs/decisions/0002-range-residual.md)
  kEquationResidual,  ///< [m^3] the paper's RE; needs one transmitter for all nodes; kAllTuples only
};

struct SelectionConfig {
  SelectionMethod method = SelectionMethod::kConsensus;
  SelectionResidual residual = SelectionResidual::kRangeResidual;
  int nodes_per_tuple = 3;                  ///< nu, in [3, n_nodes]
  float min_weight = 0.0f;                  ///< [1] least sum of the detections' weights (the paper: 40)
  float max_range_residual_m = 0.25f;       ///< [m] RR of a tuple or of a supported position, > 0
  float max_equation_residual_m3 = 6e-13f;  ///< [m^3] RE of a tuple, >= 0 (the paper, in float64)
  // kConsensus only
  float coarse_residual_m = 1.0f;     ///< [m] RR of (23), above which a tuple is not refined, > 0
  float support_gate_m = 0.3f;        ///< [m] a node supports a position by a path this near, > 0
  int min_support = 3;                ///< nodes that support a position, at least this, >= 3
  float min_support_fraction = 0.6f;  ///< [1] and at least this part of the nodes that reported, in [0, 1]
  int min_own_support = 3;            ///< of them by a detection that no better position explains, >= 1
  float echo_tail_m = 0.0f;           ///< [m] paths this far behind a person's are his too, >= 0
  bool track_aided = true;            ///< predicted positions of known people choose first
  float track_gate_m = 0.6f;          ///< [m] around them, in path and in position, > 0
  int track_min_support = 3;          ///< nodes that support a known person, >= 2
  int track_min_own_support = 2;      ///< of them by a detection of his own, >= 1
};

const char* invalid_field(const SelectionConfig& config);

/// Can it work on these nodes: enough of them for a tuple, and for kEquationResidual all with one transmitter.
bool suits(const SelectionConfig& config, Span<const NodeSite> nodes);

struct Measurement {
  float x_m = 0.0f;               ///< [m]
  float y_m = 0.0f;               ///< [m]
  float weight = 0.0f;            ///< [1] sum over its detections
  float range_residual_m = 0.0f;  ///< [m]
  int n_nodes = 0;                ///< nodes whose detections it rests on
};

/// Health of the stage since reset().
struct SelectionCounters {
  std::uint64_t frames = 0;
  std::uint64_t tuples = 0;                ///< looked at
  std::uint64_t dropped_tuples = 0;        ///< left out: kMaxTuplesPerFrame
  std::uint64_t dropped_detections = 0;    ///< in no tuple for the same reason: the lightest of their node
  std::uint64_t dropped_measurements = 0;  ///< did not fit into kMaxMeasurementsPerFrame or the output
};

/// Positions from a frame's detections (sensor-radar paper, V-A and V-B).
///
/// Tuples beyond kMaxTuplesPerFrame: each node keeps its heaviest detections, as many as leave at most eight
/// times too many tuples, then every n-th choice of nodes is taken.
///
/// kConsensus: each tuple that passes a coarse residual is refined; of every node the detection nearest to
/// the predicted path, within the gate, supports the position, which is refined again with all supporters.
/// Then the best position (most own supporters, then most supporters, then the least residual) takes its
/// detections and the others that shared them are looked at again: a detection may support two positions,
/// for two echoes at one delay are one detection, but each needs enough of its own.
/// Reference: python/echofuse/reference/hub/measure/measurement_selection.py
class MeasurementSelection {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const SelectionConfig& config, const EllipseConfig& ellipse, Span<const NodeSite> nodes,
                   const Area& area);

  void reset();

  /// detections: by ascending node, then path. predictions: where known people are expected, may be empty.
  /// measurements: cleared, then filled; kTruncated: work was cut and counted, what is there is valid.
  Status process(Span<const FrameDetection> detections, int n_reported, Span<const Point> predictions,
                 BoundedVector<Measurement>& measurements);

  const SelectionCounters& counters() const { return counters_; }

 private:
  static constexpr std::uint8_t kNoDetection = 0xFF;
  static constexpr std::size_t kMaxCandidates = kMaxMeasurementsPerFrame;

  struct Candidate {
    Point position;
    float residual_m;
    float weight;
    std::uint8_t support;                        ///< nodes
    std::uint8_t own;                            ///< of them, whose detection is not taken yet
    std::array<std::uint8_t, kMaxNodes> chosen;  ///< each node's detection within the node, or kNoDetection
  };
  /// A nu-tuple: parallel nodes and their detections within the node.
  struct Tuple {
    int size = 0;
    std::array<std::uint8_t, kMaxNodes> node;
    std::array<std::uint8_t, kMaxNodes> detection;
  };
  /// Least support of a position [nodes].
  struct Needed {
    int support;
    int own;
  };
  using Visit = void (MeasurementSelection::*)(const Tuple&, BoundedVector<Measurement>&);

  bool index_frame(Span<const FrameDetection> detections);
  void choose_depth();
  void for_each_tuple(Visit visit, BoundedVector<Measurement>& measurements);
  std::size_t visit_choice(Tuple& tuple, std::size_t room, Visit visit,
                           BoundedVector<Measurement>& measurements);
  void visit_all(const Tuple& tuple, BoundedVector<Measurement>& measurements);
  void visit_consensus(const Tuple& tuple, BoundedVector<Measurement>& measurements);
  std::size_t gather(const Tuple& tuple, std::array<RangeEllipse, kMaxNodes>& ellipses) const;
  bool explained(const Tuple& tuple) const;
  void choose_supporters(Candidate& candidate, float gate_m) const;
  bool support(Candidate& candidate, float gate_m, const Needed& needed) const;
  void aid(Span<const Point> predictions, BoundedVector<Measurement>& measurements);
  void take(const Needed& needed, BoundedVector<Measurement>& measurements);
  void mark_taken(const Candidate& winner);
  bool shares_taken(const Candidate& candidate) const;
  void emit(const Candidate& candidate, BoundedVector<Measurement>& measurements);

  SelectionConfig config_;
  EllipseLeastSquares ellipse_;
  std::array<NodeSite, kMaxNodes> nodes_;
  std::size_t n_nodes_ = 0;
  Area area_;
  SelectionCounters counters_;

  // of the frame in work
  Span<const FrameDetection> detections_;
  std::array<std::uint16_t, kMaxNodes + 1> first_{};  ///< where each node's detections begin
  std::array<std::uint16_t, kMaxNodes> taken_{};      ///< bit d: the node's detection d is explained
  std::array<std::uint16_t, kMaxNodes> in_tuples_{};  ///< bit d: the node's detection d is in tuples
  std::size_t stride_ = 1;                            ///< every n-th choice of nodes
  Needed needed_{};
  bool cut_ = false;
  BoundedVector<Candidate, kMaxCandidates> candidates_;
};

}  // namespace echofuse::hub
