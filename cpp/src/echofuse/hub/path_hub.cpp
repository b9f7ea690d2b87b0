#include "echofuse/hub/path_hub.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "echofuse/core/constants.hpp"
#include "measure/show_frame.hpp"
#include "track/report_tracks.hpp"

namespace echofuse::hub {
namespace {

constexpr float kSameTrace = 0.5f;  ///< [sample]

}  // namespace

template <int kDimension>
void PathHub<kDimension>::configure(const Setup& setup) {
  n_receivers_ = setup.rx_m.size();
  room_ = setup.room;
  frame_period_s_ = setup.frame_period_s;
  same_trace_m_ = kSameTrace / setup.trace_pairing.clock_hz * kSpeedOfLight_mps;
  track_aided_ = setup.track_aided;
  share_detections_ = setup.trace_pairing.rule == PairingRule::kAllPairs;
  const Status made[] = {
      frame_assembler_.configure(setup.frame_assembler, setup.nodes),
      path_tracker_.configure(setup.path_tracker, setup.wall, setup.rx_m, room_.inner_least_m(),
                              room_.inner_most_m(), room_.body_radius_m),
      kalman_tracker_.configure(setup.tracks)};
  for (const Status status : made)
    ECHOFUSE_CHECK(status == Status::kOk);  // the hub's invalid_field() saw to it
  configured_ = true;
  reset();
}

template <int kDimension>
void PathHub<kDimension>::reset() {
  counted_ = PathHubCounters{};
  frame_assembler_.reset();
  clock_.reset();
  path_tracker_.reset();
  kalman_tracker_.reset();
}

template <int kDimension>
Status PathHub<kDimension>::receive(const link::Detections& report, std::int64_t now_us) {
  if (!configured_) return Status::kNotConfigured;
  return frame_assembler_.receive(report, now_us);
}

template <int kDimension>
Status PathHub<kDimension>::open(std::int64_t now_us, bool& opened) {
  opened = false;
  if (!configured_) return Status::kNotConfigured;
  if (const Status status = frame_assembler_.poll(now_us, frame_, opened); status != Status::kOk || !opened)
    return status;
  show_frame(taps_, frame_, {tap_rows_.data(), tap_rows_.size()});
  step_s_ = clock_.step_s(frame_.time_us, frame_period_s_);
  for (FrameDetection& detection : frame_.detections) detection.path_m += 2.0f * room_.body_radius_m;
  associated_.fill(0);
  points_.clear();
  target_ = 0;
  if (!track_aided_) return Status::kOk;
  return path_tracker_.update(frame_.detections.span(), step_s_,
                              {associated_.data(), frame_.detections.size()});
}

template <int kDimension>
void PathHub<kDimension>::free_delays(std::size_t receiver, Delays& delay_s) const {
  for (std::size_t i = 0; i < frame_.detections.size(); ++i) {
    const FrameDetection& detection = frame_.detections[i];
    if (detection.node_index != static_cast<int>(receiver) || associated_[i] != 0) continue;
    ECHOFUSE_CHECK(delay_s.try_push_back(detection.path_m / kSpeedOfLight_mps));
  }
}

template <int kDimension>
void PathHub<kDimension>::begin_target() {
  --target_;
  weight_.fill(0.0f);
  least_weight_ = 0.0f;
}

template <int kDimension>
void PathHub<kDimension>::take(const TraceCouple& couple, std::size_t receiver1, std::size_t receiver2) {
  for (const auto& [receiver, delay_s] :
       {std::pair{receiver1, couple.delay1_s}, {receiver2, couple.delay2_s}}) {
    const float path_m = delay_s * kSpeedOfLight_mps;
    (void)use(receiver, path_m, same_trace_m_);
    path_m_[receiver] = path_m;
    weight_[receiver] = 1.0f;
  }
}

/// A detection that no track took, nor, where one belongs to one target, an earlier target.
template <int kDimension>
bool PathHub<kDimension>::available(std::size_t detection) const {
  return share_detections_ ? associated_[detection] <= 0 : associated_[detection] == 0;
}

template <int kDimension>
bool PathHub<kDimension>::use(std::size_t receiver, float path_m, float reach_m) {
  std::size_t best = frame_.detections.size();
  float least_m = reach_m;
  for (std::size_t i = 0; i < frame_.detections.size(); ++i) {
    const FrameDetection& detection = frame_.detections[i];
    if (detection.node_index != static_cast<int>(receiver) || !available(i)) continue;
    const float apart_m = std::abs(detection.path_m - path_m);
    if (!(apart_m < least_m)) continue;
    least_m = apart_m;
    best = i;
  }
  if (best == frame_.detections.size()) return false;
  associated_[best] = target_;
  path_m_[receiver] = frame_.detections[best].path_m;
  weight_[receiver] = 1.0f;
  const float weight = frame_.detections[best].weight;
  least_weight_ = least_weight_ == 0.0f ? weight : std::min(least_weight_, weight);
  return true;
}

template <int kDimension>
Status PathHub<kDimension>::keep(const Vector& position_m, const PositionCovariance& covariance_m2) {
  const Vector at_m = position_m + room_.tx_m;
  if (!(at_m.array() >= room_.least_m.array() && at_m.array() <= room_.most_m.array()).all()) {
    ++counted_.outside_area;
    return Status::kOk;
  }
  const auto n_paths = static_cast<int>(std::count(weight_.begin(), weight_.end(), 1.0f));
  ECHOFUSE_CHECK(points_.try_push_back({position_m, n_paths, least_weight_}));  // no more targets than points
  return track_aided_ ? path_tracker_.begin(position_m, covariance_m2) : Status::kOk;
}

template <int kDimension>
Status PathHub<kDimension>::close(link::Tracks& tracks) {
  show_associated();
  show_points();
  const Status status = track(tracks);
  tracks.time_us = frame_.time_us;
  tracks.frame = frame_.frame;
  show_tracks<kDimension>(taps_, tracks);
  return status;
}

template <int kDimension>
Status PathHub<kDimension>::track(link::Tracks& tracks) {
  if (track_aided_) {
    path_tracker_.report(tracks);
    for (link::Track& track : tracks.tracks) {
      track.x_m += room_.tx_m(0);
      track.y_m += room_.tx_m(1);
      if constexpr (kDimension == 3) track.z_m += room_.tx_m(2);
    }
    return Status::kOk;
  }
  BoundedVector<Vector, kMaxPointsPerFrame> positions;
  for (const LocatedPoint& point : points_)
    ECHOFUSE_CHECK(positions.try_push_back(point.position_m + room_.tx_m));
  return kalman_tracker_.process(positions.span(), step_s_, tracks);
}

template <int kDimension>
PathHubCounters PathHub<kDimension>::counters() const {
  PathHubCounters counted = counted_;
  counted.reports = frame_assembler_.counters();
  counted.dropped_births =
      track_aided_ ? path_tracker_.dropped_births() : kalman_tracker_.manager().dropped_births();
  counted.dropped_combinations = path_tracker_.dropped_combinations();
  counted.clock_faults = clock_.faults();
  return counted;
}

template <int kDimension>
void PathHub<kDimension>::show_associated() {
  if (!taps_.wants(TapId::kAssociated)) return;
  const std::size_t n = frame_.detections.size();
  for (std::size_t i = 0; i < n; ++i) tap_rows_[i] = static_cast<float>(associated_[i]);
  taps_(TapId::kAssociated, {tap_rows_.data(), n});
}

template <int kDimension>
void PathHub<kDimension>::show_points() {
  constexpr TapId kTap = kDimension == 2 ? TapId::kPoints : TapId::kSpatialPoints;
  if (!taps_.wants(kTap)) return;
  std::size_t n = 0;
  for (const LocatedPoint& point : points_) {
    for (int axis = 0; axis < kDimension; ++axis) tap_rows_[n++] = point.position_m(axis) + room_.tx_m(axis);
    tap_rows_[n++] = static_cast<float>(point.n_paths);
    tap_rows_[n++] = point.weight;
  }
  taps_(kTap, {tap_rows_.data(), n});
}

template class PathHub<2>;
template class PathHub<3>;

}  // namespace echofuse::hub
