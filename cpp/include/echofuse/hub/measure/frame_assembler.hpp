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
  int resync_after_reports = 3;  ///< the so many-th report out of step in a row lines a node up anew, >= 1
  float max_delay_s = 1e-6f;     ///< [s] a longer delay makes a report malformed, > 0
};

const char* invalid_field(const FrameAssemblerConfig& config);

/// Health of the stage since configure() or reset(). Every report is in exactly one of the first six; and of the
/// reports that every node should have sent for every frame so far, open ones left out, each is in exactly one of
/// accepted, lost and absent.
struct FrameAssemblerCounters {
  std::uint32_t accepted = 0;
  std::uint32_t late = 0;          ///< its frame was closed
  std::uint32_t early = 0;         ///< more than two frames ahead, or before its frame can be due
  std::uint32_t doubled = 0;       ///< the node's same scan again
  std::uint32_t malformed = 0;     ///< not finite, not ascending, too long, negative weight
  std::uint32_t unknown_node = 0;  ///< not of this site
  std::uint32_t lost = 0;          ///< missing from a closed frame, of a node that was waited for
  std::uint32_t resynchronised = 0;
  std::uint32_t frames = 0;  ///< closed
  std::uint32_t absent = 0;  ///< as lost, of a node that was not waited for
  std::uint32_t slow = 0;    ///< accepted, but when more than half of the deadline had passed
};

/// Lines up the nodes' reports: one frame holds each node's scan of the same instant.
///
/// A node's scan counter tells its frames apart; its offset against the hub's counter is learnt from the
/// node's first report, which belongs to the frame then open, or to the next one if half of the usual time between
/// frames has passed. A frame closes when all live nodes are in, when its deadline has passed, or when a report came
/// that is two frames ahead. Time is an argument.
///
/// A report is out of step when its frame is closed, far ahead, or cannot be due: less than half of the usual time
/// between frames has passed (so a node that counts one scan too many does not open frames before the others).
/// A node is lined up anew when that happens several times in a row, and at once when it is off by more frames than
/// any link delays a report: it has restarted.
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

  static constexpr std::int32_t kFarFrames = 16;  ///< farther off, a node has restarted

  bool well_formed(const link::Detections& report) const;
  OpenFrame& slot(std::size_t ahead) { return slots_[(head_ + ahead) % kOpenFrames]; }
  bool any_open() const;
  bool any_live() const;
  bool complete();
  std::int32_t ahead_of(const NodeState& node, std::uint32_t frame) const;
  void line_up(NodeState& node, std::size_t node_index, std::uint32_t frame, std::int64_t now_us);
  bool out_of_step(std::int32_t ahead, std::int64_t now_us);
  void skip(std::int32_t frames);
  void learn_interval(std::uint32_t number, std::int64_t now_us);
  void accept(const link::Detections& report, std::size_t node_index, std::size_t ahead, std::int64_t now_us);
  void close_head(Frame* frame);

  FrameAssemblerConfig config_;
  std::array<NodeState, kMaxNodes> nodes_;
  std::size_t n_nodes_ = 0;
  std::array<OpenFrame, kOpenFrames> slots_;
  std::size_t head_ = 0;      ///< index of the oldest frame's slot
  std::uint32_t number_ = 0;  ///< of the oldest frame
  bool opened_any_ = false;
  std::uint32_t newest_number_ = 0;  ///< of the newest frame that was opened
  std::int64_t newest_us_ = 0;       ///< [us] when it was
  std::int64_t interval_us_ = 0;     ///< [us] usual time from frame to frame; 0: not known yet
  FrameAssemblerCounters counters_;
};

}  // namespace echofuse::hub
