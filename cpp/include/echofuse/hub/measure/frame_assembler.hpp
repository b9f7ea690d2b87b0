#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

struct FrameAssemblerConfig {
  std::int32_t deadline_us = 80000;  ///< [us] after its first report a frame closes, > 0
  int dead_after_frames = 10;        ///< a node that missed this many in a row is not waited for, >= 1
  int resync_after_reports = 10;     ///< out of step this often in a row, a node is lined up anew, >= 1
  float max_delay_s = 1e-6f;         ///< [s] a longer delay makes a report malformed, > 0
};

const char* invalid_field(const FrameAssemblerConfig& config);

/// Health of the stage since configure() or reset(). Every report is in exactly one of the first six.
struct FrameAssemblerCounters {
  std::uint32_t accepted = 0;
  std::uint32_t late = 0;          ///< its frame was closed
  std::uint32_t early = 0;         ///< more than two frames ahead of the one that is waited for
  std::uint32_t doubled = 0;       ///< the node's same scan again
  std::uint32_t malformed = 0;     ///< not finite, not ascending, too long, negative weight
  std::uint32_t unknown_node = 0;  ///< not of this site
  std::uint32_t lost = 0;          ///< missing from a closed frame, of a node that was waited for
  std::uint32_t resynchronised = 0;
  std::uint32_t frames = 0;  ///< closed
};

/// Lines up the nodes' reports: one frame holds each node's scan of the same instant.
///
/// A node's scan counter tells its frames apart; its offset against the hub's counter is learnt from the
/// node's first report, which belongs to the frame then open. A frame closes when all live nodes are in, when
/// its deadline has passed, or when a report came that is two frames ahead. Time is an argument.
/// Reference: python/echofuse/reference/hub/measure/frame_assembler.py
class FrameAssembler {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const FrameAssemblerConfig& config, Span<const NodeSite> nodes);

  void reset();

  /// kInvalidInput: malformed, or from a node that the site does not list. A report that is late, early or
  /// doubled is dropped and counted, with kOk. now_us: the hub's clock, never decreasing.
  Status receive(const link::Detections& report, std::int64_t now_us);

  /// closed: whether `frame` was filled with a frame that is complete; ask again until it is false.
  Status poll(std::int64_t now_us, Frame& frame, bool& closed);

  const FrameAssemblerCounters& counters() const { return counters_; }

 private:
  static constexpr std::size_t kOpenFrames = 3;

  struct Report {
    int count = -1;  ///< detections, -1: none came
    std::array<link::Detection, kMaxDetectionsPerNode> detections;
  };
  struct OpenFrame {
    bool open = false;
    std::int64_t opened_us = 0;
    std::array<Report, kMaxNodes> reports;
  };
  struct NodeState {
    std::int32_t node_id = 0;
    bool aligned = false;
    bool live = true;
    std::uint32_t offset = 0;      ///< hub's frame minus node's frame, modulo 2^32
    std::uint32_t last_frame = 0;  ///< of the node, accepted last
    int out_of_step = 0;           ///< reports in a row
    int missed = 0;                ///< frames in a row
  };

  bool well_formed(const link::Detections& report) const;
  OpenFrame& slot(std::size_t ahead) { return slots_[(head_ + ahead) % kOpenFrames]; }
  bool any_open() const;
  bool complete();
  void count_out_of_step(NodeState& node, std::uint32_t& counter);
  void accept(const link::Detections& report, std::size_t node_index, std::size_t ahead, std::int64_t now_us);
  void close_head(Frame* frame);

  FrameAssemblerConfig config_;
  std::array<NodeState, kMaxNodes> nodes_;
  std::size_t n_nodes_ = 0;
  std::array<OpenFrame, kOpenFrames> slots_;
  std::size_t head_ = 0;      ///< index of the oldest frame's slot
  std::uint32_t number_ = 0;  ///< of the oldest frame
  FrameAssemblerCounters counters_;
};

}  // namespace echofuse::hub
