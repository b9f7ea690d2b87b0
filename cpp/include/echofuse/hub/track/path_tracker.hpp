#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/eigen.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/estimation/turning_filter.hpp"
#include "echofuse/hub/locate/wall.hpp"
#include "echofuse/hub/measure/frame.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

struct PathTrackerConfig {
  float acceleration_density_m2ps3 = 1.0f;  ///< [m^2/s^3] velocity variance gained per second, > 0
  float velocity_std_mps = 1.0f;            ///< [m/s] of a velocity not seen yet, per coordinate, > 0
  float path_std_m = 0.06f;                 ///< [m] of one receiver's path for itself, > 0
  float common_path_std_m = 0.1f;  ///< [m] of what all receivers' paths share: where a body reflects, >= 0
  float gate = 16.0f;              ///< [1] squared distance of a combination of traces, > 0
  float missing_cost = 4.0f;       ///< [1] added for each receiver without a trace, of more than two, >= 0
  float lone_gate = 6.6f;          ///< [1] squared distance of a single trace, >= 0; 0: none is taken
  int lone_limit = 9;              ///< responses in a row with a single trace, >= 0
  float cut_off = 1.5f;            ///< [1] deviations beyond which a difference of paths counts no more, > 0
  int confirm_updates = 5;         ///< of the last confirm_window responses, >= 1
  int confirm_window = 8;          ///< in [confirm_updates, 32]
  float silent_time_s = 1.0f;      ///< [s] for which a confirmed track may be silent, >= 0
  float silent_velocity_time_s = 0.5f;  ///< [s] a silent track's velocity fades with this constant, >= 0
  float birth_exclusion_m = 0.7f;       ///< [m] no track begins nearer to another one, >= 0
  float merge_distance_m = 0.3f;        ///< [m] two confirmed tracks nearer than that, >= 0
  float merge_speed_mps = 0.6f;         ///< [m/s] and as fast, are one person, >= 0
  int max_tracks = 10;                  ///< in [1, kMaxTracks]
  float path_std_growth = 0.0f;         ///< [1/m] of both path deviations, beyond 4 m of the mean path, >= 0
  float turn_density_m2ps3 = 0.0f;      ///< [m^2/s^3] velocity variance gained by one who turns, >= 0; 0: nobody does
  float turn_begin_probability = 0.005f;  ///< [1] that somebody begins to turn in one response, in (0, 1)
  float turn_end_probability = 0.05f;     ///< [1] that somebody who turns walks straight on in the next, in (0, 1)
  float body_half_height_m = 0.0f;      ///< [m] of an upright body, in space alone, >= 0; 0: a ball
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const PathTrackerConfig& config);

/// Tracks from the paths of traces before a plane of antennas: an extended Kalman filter a person, whose prediction takes
/// part in the pairing (the through-wall paper, section 4, names what goes wrong without). Each track looks among
/// all combinations of the receivers' traces for the one of least Mahalanobis distance; the best go first. Of the traces
/// taken, the mean path is used as it is, and what differs between receivers (the cross-range) is cut off at a few
/// deviations, since one in ten is wrong by decimetres. The transmitter is the origin, x runs along the wall, y > 0
/// is the depth, z points upwards. In space a body is an upright ellipsoid of half-width a and half-height h, and its
/// echo begins where it is nearest: the path is that of its middle less s(g) = sqrt(a^2 (gx^2 + gy^2) + h^2 gz^2), g
/// the gradient of the middle's path. Reference: python/echofuse/reference/hub/track/path_tracker.py
template <int kDimension>
class PathTracker {
  using Filter = estimation::TurningFilter<kDimension>;

 public:
  using Vector = typename Filter::Vector;                          ///< [m] x, y, and in space z
  using PositionCovariance = typename Filter::Filter::PositionCovariance;  ///< [m^2]

  /// rx_m: (n,) kDimension <= n <= kMaxArrayReceivers, y = 0, all different and none at the transmitter. least_m, most_m:
  /// corners of where a person's middle can be, behind the antennas. body_radius_m: in space, a >= 0, of which update()'s
  /// paths hold 2 a more than was measured. Also resets. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const PathTrackerConfig& config, const WallConfig& wall, Span<const Vector> rx_m,
                   const Vector& least_m, const Vector& most_m, float body_radius_m = 0.0f);
  void reset();

  /// One response, dt_s > 0 [s] after the last. paths: ascending receiver (node_index), then path [m].
  /// owners: (paths.size(),) id of the track that took each, 0 if none did. kTruncated: combinations were left out.
  /// kInvalidInput: sizes, a receiver not configured or something not finite; nothing changes.
  Status update(Span<const FrameDetection> paths, float dt_s, Span<std::int32_t> owners);

  /// Begins a track at a fix that no track explains. kTruncated: no room for it. Near another track none begins.
  Status begin(const Vector& position_m, const PositionCovariance& covariance_m2);

  /// All that live, ascending id; its time and frame stay the caller's.
  void report(link::Tracks& tracks) const;

  std::uint32_t dropped_births() const { return dropped_births_; }
  std::uint32_t dropped_combinations() const { return dropped_combinations_; }  ///< searches cut short

 private:
  static constexpr int kNone = -1;
  using Traces = std::array<std::int8_t, kMaxArrayReceivers>;  ///< index among a receiver's paths, or kNone

  struct TrackState {
    std::int32_t id = 0;
    bool confirmed = false;
    std::uint32_t updates = 1;  ///< one bit a response, the newest lowest
    int age = 1;                ///< responses in updates, up to confirm_window
    std::int32_t misses = 0;
    int lone = 0;
    float silent_time_s = 0.0f;
    Filter filter;
  };
  struct Leg {  ///< one way between a position and an antenna
    float optical_m;
    Vector gradient;  ///< [1] of it with respect to the position
  };
  struct Prediction {  ///< of each receiver's path
    std::array<float, kMaxArrayReceivers> path_m{};
    std::array<Vector, kMaxArrayReceivers> gradient;
    float own_m2 = 0.0f, common_m2 = 0.0f;  ///< [m^2] variances of paths as long
  };
  struct Choice {
    float distance = 0.0f;  ///< infinite: none
    Traces traces{};
  };
  /// The combination so far, as a filter of what its errors have in common and of the position: a Mahalanobis distance
  /// in steps, one receiver at a time.
  struct Partial {
    using State = Eigen::Matrix<float, 1 + kDimension, 1>;
    State state = State::Zero();  ///< [m] common error, then the position, about the prediction
    Eigen::Matrix<float, 1 + kDimension, 1 + kDimension> covariance;  ///< [m^2]
    float distance = 0.0f;
    int present = 0;  ///< receivers with a trace
  };

  bool well_formed(Span<const FrameDetection> paths) const;
  int n_traces(std::size_t receiver) const {
    return static_cast<int>(first_[receiver + 1] - first_[receiver]);
  }
  std::size_t index(std::size_t receiver, int trace) const {
    return first_[receiver] + static_cast<std::size_t>(trace);
  }
  bool all_free(const Traces& traces) const;
  void predict(float dt_s);
  void share_out(bool confirmed);
  Choice best_choice(const TrackState& track);
  bool add(const Prediction& prediction, std::size_t receiver, int trace, Partial& partial) const;
  Prediction predicted(const TrackState& track) const;
  Leg leg(const Vector& position, const Vector& antenna) const;
  void take(TrackState& track, const Traces& traces) const;
  void take_along(TrackState& track, const Vector& direction, float innovation_m, float variance_m2,
                  bool cut) const;
  bool take_lone(TrackState& track);
  bool lives(TrackState& track, float dt_s) const;
  bool same(const TrackState& one, const TrackState& other) const;

  PathTrackerConfig config_;
  Wall wall_;
  Vector least_m_ = Vector::Zero(), most_m_ = Vector::Zero();
  Vector body_m2_ = Vector::Zero();  ///< [m^2] squared half axes of a body
  float body_radius_m_ = 0.0f;
  std::array<Vector, kMaxArrayReceivers> rx_m_;
  std::size_t n_receivers_ = 0;  ///< 0 until configured

  BoundedVector<TrackState, kMaxTracks> tracks_;
  std::int32_t next_id_ = 1;
  std::uint32_t dropped_births_ = 0;
  std::uint32_t dropped_combinations_ = 0;

  Span<const FrameDetection> paths_;                         ///< of this response
  std::array<std::size_t, kMaxArrayReceivers + 1> first_{};  ///< index of each receiver's first path
  Span<std::int32_t> owners_;
  std::array<Choice, kMaxTracks> choices_{};
  std::size_t combinations_ = 0;  ///< looked at in this response
};

}  // namespace echofuse::hub
