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
  int resync_after_reports = 3;  ///< the so many-th late report in a row has a node's clock learnt anew, >= 1
  float max_delay_s = 1e-6f;     ///< [s] a longer delay makes a report malformed, > 0
};

const char* invalid_field(const FrameAssemblerConfig& config);

/// Health of the stage since configure() or reset(). Every report is in exactly one of the first six; and of the
/// reports that every node should have sent for every frame so far, open ones left out, each is in exactly one of
/// accepted, lost and absent.
struct FrameAssemblerCounters {
  std::uint32_t accepted = 0;
  std::uint32_t late = 0;            ///< its frame was closed
  std::uint32_t early = 0;           ///< more than two frames ahead of the oldest that is open
  std::uint32_t doubled = 0;         ///< the node's same scan again
  std::uint32_t malformed = 0;       ///< not finite, not ascending, too long, negative weight
  std::uint32_t unknown_node = 0;    ///< not of this site
  std::uint32_t lost = 0;            ///< missing from a closed frame, of a node that was waited for
  std::uint32_t resynchronised = 0;  ///< accepted, and the node's counter means other frames than before
  std::uint32_t frames = 0;          ///< closed
  std::uint32_t absent = 0;          ///< as lost, of a node that was not waited for
  std::uint32_t slow = 0;            ///< accepted, but when more than half of the deadline had passed
};

/// Lines up the nodes' reports: one frame holds each node's scan of the same instant.
///
/// A report belongs to the frame that is due when its scan was taken. The scan's time by the hub's clock is its time by the
/// node's clock plus the least time that a report of that node took from there to its arrival (so the clocks need not agree,
/// and a report that a link held up is placed as well as any other); which frame was due then is the median of what
/// the other nodes' newest reports say. A frame closes when all live nodes are in, when its deadline has passed, or when a
/// report came that is two frames ahead. Time is an argument.
///
/// A report whose frame is closed is late. When that happens several times in a row, or by more frames than any link
/// delays a report, the node's clock is another one (it has restarted) and is learnt anew. A node that was given up is
/// waited for again from its first report on, and if all were, all are from the next report of any.
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
    bool live = true;
    int missed = 0;       ///< frames in a row
    int out_of_step = 0;  ///< reports in a row
    bool accepted_any = false;
    std::uint32_t offset = 0;  ///< number minus frame of its report accepted last, modulo 2^32

    bool heard = false;           ///< and this was its newest report:
    std::uint32_t frame = 0;      ///< by the node's counter
    std::uint32_t number = 0;     ///< of the frame it belongs to
    std::int64_t time_us = 0;     ///< [us] by the node's clock
    std::int64_t arrived_us = 0;  ///< [us]
    std::int64_t lag_us = 0;      ///< [us] least time from its clock to an arrival
  };

  static constexpr std::int32_t kFarFrames = 16;  ///< farther behind than any link delays a report
  static constexpr std::int64_t kLagLeak = 1024;  ///< a clock may lose one part in so many against the hub's
  static constexpr std::int64_t kIntervalLeast_us = 1'000, kIntervalMost_us = 10'000'000;

  bool well_formed(const link::Detections& report) const;
  OpenFrame& slot(std::size_t ahead) { return slots_[(head_ + ahead) % kOpenFrames]; }
  std::int32_t ahead_of(std::uint32_t number) const { return static_cast<std::int32_t>(number - number_); }
  bool any_open() const;
  bool any_live() const;
  bool complete();
  void count_late(NodeState& node);
  void wait_for_all();
  void place(std::size_t node_index, std::uint32_t frame, std::int64_t time_us, std::int64_t now_us);
  std::uint32_t due(std::size_t node_index, std::int64_t scan_us) const;
  std::uint32_t newest_open() const;
  void skip(std::int32_t frames);
  void learn_interval(std::int32_t frames, std::int64_t elapsed_us);
  void accept(const link::Detections& report, std::size_t node_index, std::size_t ahead, std::int64_t now_us);
  void close_head(Frame* frame);

  FrameAssemblerConfig config_;
  std::array<NodeState, kMaxNodes> nodes_;
  std::size_t n_nodes_ = 0;
  std::array<OpenFrame, kOpenFrames> slots_;
  std::size_t head_ = 0;          ///< index of the oldest frame's slot
  std::uint32_t number_ = 0;      ///< of the oldest frame
  std::int64_t interval_us_ = 0;  ///< [us] usual time from frame to frame; 0: not known yet
  int odd_intervals_ = 0;         ///< in a row that were not like it
  FrameAssemblerCounters counters_;
};

}  // namespace echofuse::hub
