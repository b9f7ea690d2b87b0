#include "echofuse/hub/measure/frame_assembler.hpp"

#include <cmath>

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
  opened_any_ = false;
  interval_us_ = 0;
  counters_ = FrameAssemblerCounters{};
}

bool FrameAssembler::well_formed(const link::Detections& report) const {
  float previous_s = 0.0f;
  for (const link::Detection& detection : report.detections) {
    if (!(detection.delay_s >= previous_s && detection.delay_s <= config_.max_delay_s)) return false;
    if (!(detection.weight >= 0.0f && std::isfinite(detection.weight))) return false;
    previous_s = detection.delay_s;
  }
  return true;
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
  if (node.aligned && report.frame == node.last_frame) {
    ++counters_.doubled;
    return Status::kOk;
  }
  if (!node.aligned) line_up(node, index, report.frame, now_us);
  std::int32_t ahead = ahead_of(node, report.frame);
  if (out_of_step(ahead, now_us)) {
    const bool far = ahead > kFarFrames || ahead < -kFarFrames;
    if (!far && ++node.out_of_step < config_.resync_after_reports) {
      ++(ahead < 0 ? counters_.late : counters_.early);
      return Status::kOk;
    }
    ++counters_.resynchronised;
    line_up(node, index, report.frame, now_us);
    ahead = ahead_of(node, report.frame);
  }
  if (!any_open()) {  // nobody is waited for: the frames in between were lost by all
    skip(ahead);
    ahead = 0;
  }
  accept(report, index, static_cast<std::size_t>(ahead), now_us);
  return Status::kOk;
}

/// Frames from the oldest one to that of a node's report; negative when it is closed.
std::int32_t FrameAssembler::ahead_of(const NodeState& node, std::uint32_t frame) const {
  return static_cast<std::int32_t>(frame + node.offset - number_);
}

/// Takes a node's report as one of the frame that is open, or of the next one.
void FrameAssembler::line_up(NodeState& node, std::size_t node_index, std::uint32_t frame,
                             std::int64_t now_us) {
  const OpenFrame& head = slot(0);
  const bool is_past = interval_us_ > 0 && 2 * (now_us - head.opened_us) > interval_us_;
  const bool is_next = head.open && (head.reports[node_index].count >= 0 || is_past);
  node.offset = number_ + (is_next ? 1U : 0U) - frame;
  node.aligned = true;
  node.out_of_step = 0;
}

/// Whether a report is not one of the frames that are open, and would open none that can be due.
bool FrameAssembler::out_of_step(std::int32_t ahead, std::int64_t now_us) {
  if (ahead < 0) return true;
  if (ahead >= static_cast<std::int32_t>(kOpenFrames)) {
    if (any_open()) return true;
  } else if (slot(static_cast<std::size_t>(ahead)).open) {
    return false;
  }
  if (!opened_any_ || interval_us_ == 0) return false;
  const std::int64_t steps =
      static_cast<std::int32_t>(number_ + static_cast<std::uint32_t>(ahead) - newest_number_);
  return steps > 0 && 2 * (now_us - newest_us_) < (2 * steps - 1) * interval_us_;
}

/// Passes over frames of which nothing came.
void FrameAssembler::skip(std::int32_t frames) {
  for (; frames > 0 && any_live(); --frames) close_head(nullptr);
  counters_.absent += static_cast<std::uint32_t>(frames) * static_cast<std::uint32_t>(n_nodes_);
  number_ += static_cast<std::uint32_t>(frames);
}

void FrameAssembler::learn_interval(std::uint32_t number, std::int64_t now_us) {
  const std::int64_t steps = static_cast<std::int32_t>(number - newest_number_);
  if (opened_any_ && steps <= 0) return;
  if (opened_any_) {
    const std::int64_t step_us = (now_us - newest_us_) / steps;
    interval_us_ = interval_us_ == 0 ? step_us : interval_us_ + (step_us - interval_us_) / 4;
  }
  opened_any_ = true;
  newest_number_ = number;
  newest_us_ = now_us;
}

void FrameAssembler::accept(const link::Detections& report, std::size_t node_index, std::size_t ahead,
                            std::int64_t now_us) {
  OpenFrame& frame = slot(ahead);
  if (!frame.open) {
    frame.open = true;
    frame.opened_us = now_us;
    for (Report& kept : frame.reports) kept.count = -1;
    learn_interval(number_ + static_cast<std::uint32_t>(ahead), now_us);
  }
  Report& kept = frame.reports[node_index];
  if (kept.count >= 0) {  // lined up anew onto a scan that is there already
    ++counters_.doubled;
    return;
  }
  kept.count = static_cast<int>(report.detections.size());
  for (std::size_t i = 0; i < report.detections.size(); ++i) kept.detections[i] = report.detections[i];
  NodeState& node = nodes_[node_index];
  node.last_frame = report.frame;
  node.out_of_step = 0;
  node.live = true;
  ++counters_.accepted;
  if (2 * (now_us - frame.opened_us) > config_.deadline_us) ++counters_.slow;
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
