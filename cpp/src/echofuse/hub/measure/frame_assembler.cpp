#include "echofuse/hub/measure/frame_assembler.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "echofuse/core/constants.hpp"

namespace echofuse::hub {

const char* invalid_field(const FrameAssemblerConfig& config) {
  if (config.deadline_us <= 0) return "deadline_us";
  if (config.dead_after_frames < 1) return "dead_after_frames";
  if (config.resync_after_reports < 1) return "resync_after_reports";
  if (!(config.max_delay_s > 0.0f && std::isfinite(config.max_delay_s))) return "max_delay_s";
  return nullptr;
}

Status FrameAssembler::configure(const FrameAssemblerConfig& config, Span<const NodeSite> nodes) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  if (nodes.empty() || nodes.size() > kMaxNodes) return Status::kInvalidConfig;
  config_ = config;
  n_nodes_ = nodes.size();
  for (std::size_t i = 0; i < n_nodes_; ++i) nodes_[i].node_id = nodes[i].node_id;
  reset();
  return Status::kOk;
}

void FrameAssembler::reset() {
  for (NodeState& node : nodes_) {
    const std::int32_t node_id = node.node_id;
    node = NodeState{};
    node.node_id = node_id;
  }
  for (OpenFrame& frame : slots_) frame.open = false;
  head_ = 0;
  number_ = 0;
  interval_us_ = 0;
  odd_intervals_ = 0;
  counters_ = FrameAssemblerCounters{};
}

bool FrameAssembler::well_formed(const link::Detections& report) const {
  float previous_s = 0.0f;
  for (const link::Detection& detection : report.detections) {
    if (!(detection.delay_s >= previous_s && detection.delay_s <= config_.max_delay_s)) return false;
    if (!(detection.weight >= 0.0f && std::isfinite(detection.weight))) return false;
    previous_s = detection.delay_s;
  }
  return report.time_us >= 0 && report.time_us < (std::int64_t{1} << 56);
}

bool FrameAssembler::any_open() const {
  for (const OpenFrame& frame : slots_)
    if (frame.open) return true;
  return false;
}

bool FrameAssembler::any_live() const {
  for (std::size_t i = 0; i < n_nodes_; ++i)
    if (nodes_[i].live) return true;
  return false;
}

Status FrameAssembler::receive(const link::Detections& report, std::int64_t now_us) {
  if (n_nodes_ == 0) return Status::kNotConfigured;
  std::size_t index = 0;
  while (index < n_nodes_ && nodes_[index].node_id != report.node_id) ++index;
  if (index == n_nodes_) {
    ++counters_.unknown_node;
    return Status::kInvalidInput;
  }
  if (!well_formed(report)) {
    ++counters_.malformed;
    return Status::kInvalidInput;
  }
  NodeState& node = nodes_[index];
  if (node.heard && report.frame == node.frame) {
    ++counters_.doubled;
    return Status::kOk;
  }
  place(index, report.frame, report.time_us == 0 ? now_us : report.time_us, now_us);
  std::int32_t ahead = ahead_of(node.number);
  if (ahead < 0) {
    count_late(node);
    return Status::kOk;
  }
  if (!any_open()) {  // nobody is waited for: the frames in between were lost by all
    skip(ahead);
    ahead = 0;
  }
  if (ahead >= static_cast<std::int32_t>(kOpenFrames)) {
    ++counters_.early;
    return Status::kOk;
  }
  accept(report, index, static_cast<std::size_t>(ahead), now_us);
  return Status::kOk;
}

void FrameAssembler::count_late(NodeState& node) {
  ++counters_.late;
  if (node.live) return;
  node.live = true;  // nobody waited for it: the next frame does, and gives up at once if it is in vain
  node.missed = config_.dead_after_frames - 1;
}

/// Notes a node's newest report and the frame that its scan belongs to, by its time.
void FrameAssembler::place(std::size_t node_index, std::uint32_t frame, std::int64_t time_us,
                           std::int64_t now_us) {
  NodeState& node = nodes_[node_index];
  std::int64_t lag_us = now_us - time_us;
  if (node.heard) {
    learn_interval(static_cast<std::int32_t>(frame - node.frame), time_us - node.time_us);
    lag_us = std::min(lag_us, node.lag_us + (now_us - node.arrived_us) / kLagLeak);
  }
  std::uint32_t number = due(node_index, time_us + lag_us);
  const std::int32_t ahead = ahead_of(number);
  if (ahead < 0 && (++node.out_of_step >= config_.resync_after_reports || ahead < -kFarFrames)) {
    lag_us = now_us - time_us;  // its clock is another one
    node.out_of_step = 0;
    number = due(node_index, now_us);
  }
  node.heard = true;
  node.frame = frame;
  node.number = number;
  node.time_us = time_us;
  node.arrived_us = now_us;
  node.lag_us = lag_us;
}

/// The number of the frame at a time of the hub's clock: the median of what the other nodes' newest reports say.
std::uint32_t FrameAssembler::due(std::size_t node_index, std::int64_t scan_us) const {
  const NodeState* newest = nullptr;
  for (std::size_t i = 0; i < n_nodes_; ++i) {
    const NodeState& node = nodes_[i];
    if (node.heard && (newest == nullptr || static_cast<std::int32_t>(node.number - newest->number) > 0))
      newest = &node;
  }
  if (newest == nullptr || interval_us_ == 0) return newest_open();

  std::array<std::int64_t, kMaxNodes> since_us{};  // from the newest frame to the scan, ascending
  std::size_t n = 0;
  const auto add = [&](const NodeState& node) {
    const std::int64_t frames = static_cast<std::int32_t>(node.number - newest->number);
    if (!node.heard || frames < -kFarFrames) return;
    const std::int64_t value_us = frames * interval_us_ + scan_us - (node.time_us + node.lag_us);
    std::size_t place = n++;
    for (; place > 0 && since_us[place - 1] > value_us; --place) since_us[place] = since_us[place - 1];
    since_us[place] = value_us;
  };
  for (std::size_t i = 0; i < n_nodes_; ++i)
    if (i != node_index) add(nodes_[i]);
  if (n == 0) add(nodes_[node_index]);
  const std::int64_t twice_us = 2 * since_us[(n - 1) / 2] + interval_us_;
  std::int64_t frames = twice_us / (2 * interval_us_);
  if (twice_us < 0 && twice_us % (2 * interval_us_) != 0) --frames;  // rounds down
  constexpr std::int64_t kMost = 1 << 30;  // so that numbers compare across the wrap
  return newest->number + static_cast<std::uint32_t>(std::max(-kMost, std::min(frames, kMost)));
}

/// Of the newest open frame, or of the one that is opened next.
std::uint32_t FrameAssembler::newest_open() const {
  std::uint32_t newest = 0;
  for (std::size_t ahead = 0; ahead < kOpenFrames; ++ahead)
    if (slots_[(head_ + ahead) % kOpenFrames].open) newest = static_cast<std::uint32_t>(ahead);
  return number_ + newest;
}

/// Passes over frames of which nothing came.
void FrameAssembler::skip(std::int32_t frames) {
  for (; frames > 0 && any_live(); --frames) close_head(nullptr);
  counters_.absent += static_cast<std::uint32_t>(frames) * static_cast<std::uint32_t>(n_nodes_);
  number_ += static_cast<std::uint32_t>(frames);
}

/// From two reports of one node: so the link's delays are not in it.
void FrameAssembler::learn_interval(std::int32_t frames, std::int64_t elapsed_us) {
  if (frames < 1 || frames > kFarFrames || elapsed_us <= 0) return;
  const std::int64_t interval_us = elapsed_us / frames;
  if (interval_us < kIntervalLeast_us || interval_us > kIntervalMost_us) return;
  const std::int64_t change_us = interval_us - interval_us_;
  if (4 * std::abs(change_us) <= interval_us_) {
    interval_us_ += change_us / 8;
    odd_intervals_ = 0;
    return;
  }
  // A scan missed or counted twice, a clock that is set; or all have another pace.
  if (interval_us_ == 0 || ++odd_intervals_ >= 2 * static_cast<int>(n_nodes_)) {
    interval_us_ = interval_us;
    odd_intervals_ = 0;
  }
}

void FrameAssembler::accept(const link::Detections& report, std::size_t node_index, std::size_t ahead,
                            std::int64_t now_us) {
  OpenFrame& frame = slot(ahead);
  if (!frame.open) {
    frame.open = true;
    frame.opened_us = now_us;
    for (Report& kept : frame.reports) kept.count = -1;
    if (!any_live()) wait_for_all();
  }
  NodeState& node = nodes_[node_index];
  Report& kept = frame.reports[node_index];
  if (kept.count >= 0) {  // another scan at the same time
    ++counters_.doubled;
    ++node.out_of_step;
    return;
  }
  kept.count = static_cast<int>(report.detections.size());
  for (std::size_t i = 0; i < report.detections.size(); ++i) kept.detections[i] = report.detections[i];
  const std::uint32_t offset = node.number - report.frame;
  if (node.accepted_any && node.offset != offset) ++counters_.resynchronised;
  node.accepted_any = true;
  node.offset = offset;
  node.out_of_step = 0;
  node.live = true;
  ++counters_.accepted;
  if (2 * (now_us - frame.opened_us) > config_.deadline_us) ++counters_.slow;
}

/// All were away: so all may be back.
void FrameAssembler::wait_for_all() {
  for (std::size_t i = 0; i < n_nodes_; ++i) {
    nodes_[i].live = true;
    nodes_[i].missed = 0;
  }
}

bool FrameAssembler::complete() {
  for (std::size_t i = 0; i < n_nodes_; ++i)
    if (nodes_[i].live && slot(0).reports[i].count < 0) return false;
  return true;
}

Status FrameAssembler::poll(std::int64_t now_us, Frame& frame, bool& closed) {
  closed = false;
  frame.detections.clear();
  if (n_nodes_ == 0) return Status::kNotConfigured;
  if (!any_open()) return Status::kOk;
  while (!slot(0).open) close_head(nullptr);  // lost by all
  const bool overdue = now_us - slot(0).opened_us >= config_.deadline_us;
  if (!overdue && !complete() && !slot(kOpenFrames - 1).open) return Status::kOk;
  close_head(&frame);
  closed = true;
  return Status::kOk;
}

/// Ends the oldest frame: into `frame` when not null, and counts who was missing.
void FrameAssembler::close_head(Frame* frame) {
  OpenFrame& head = slot(0);
  int n_reported = 0;
  for (std::size_t i = 0; i < n_nodes_; ++i) {
    NodeState& node = nodes_[i];
    const Report& report = head.reports[i];
    if (!head.open || report.count < 0) {
      if (!node.live) {
        ++counters_.absent;
        continue;
      }
      ++counters_.lost;
      if (++node.missed >= config_.dead_after_frames) node.live = false;
      continue;
    }
    node.missed = 0;
    ++n_reported;
    for (std::size_t d = 0; frame != nullptr && d < static_cast<std::size_t>(report.count); ++d) {
      const link::Detection& detection = report.detections[d];
      const bool fits = frame->detections.try_push_back(
          {static_cast<int>(i), detection.delay_s * kSpeedOfLight_mps, detection.weight});
      ECHOFUSE_CHECK(fits);  // kMaxFrameDetections is the product of both capacities
    }
  }
  if (frame != nullptr) {
    frame->time_us = head.opened_us;
    frame->frame = number_;
    frame->n_reported = n_reported;
    ++counters_.frames;
  }
  head.open = false;
  head_ = (head_ + 1) % kOpenFrames;
  ++number_;
}

}  // namespace echofuse::hub
