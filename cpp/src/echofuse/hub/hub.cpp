#include "echofuse/hub/hub.hpp"

#include <algorithm>
#include <cmath>

#include "measure/show_frame.hpp"

namespace echofuse::hub {

const char* invalid_field(const SensorRadarHubConfig& config) {
  if (config.n_nodes < 3 || config.n_nodes > static_cast<int>(kMaxNodes)) return "n_nodes";
  const Span<const NodeSite> nodes{config.nodes.data(), static_cast<std::size_t>(config.n_nodes)};
  if (const char* field = invalid_site(nodes, config.area); field != nullptr) return field;
  if (!(config.frame_period_s > 0.0f && std::isfinite(config.frame_period_s))) return "frame_period_s";
  if (config.aid_missed_frames < 0) return "aid_missed_frames";
  if (config.tracker > Tracker::kRange) return "tracker";
  if (invalid_field(config.frame_assembler) != nullptr) return "frame_assembler";
  if (invalid_field(config.ellipse) != nullptr) return "ellipse";
  if (invalid_field(config.selection) != nullptr || !suits(config.selection, nodes)) return "selection";
  if (invalid_field(config.point_clusters) != nullptr) return "point_clusters";
  if (invalid_field(config.phd) != nullptr) return "phd";
  if (invalid_field(config.em) != nullptr) return "em";
  if (invalid_field(config.tracks) != nullptr) return "tracks";
  if (invalid_field(config.ranges) != nullptr) return "ranges";
  return nullptr;
}

Status SensorRadarHub::configure(const SensorRadarHubConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  const Span<const NodeSite> nodes{config_.nodes.data(), static_cast<std::size_t>(config.n_nodes)};
  const std::array<Status, 6> made{
      frame_assembler_.configure(config.frame_assembler, nodes),
      selection_.configure(config.selection, config.ellipse, nodes, config.area),
      point_clusters_.configure(config.point_clusters),
      phd_tracker_.configure(config.phd, config.em, config.tracks),
      kalman_tracker_.configure(config.tracks),
      range_tracker_.configure(config.ranges, config.ellipse.body_radius_m, nodes, config.area)};
  for (const Status status : made) ECHOFUSE_CHECK(status == Status::kOk);  // invalid_field() saw to it
  configured_ = true;
  reset();
  return Status::kOk;
}

void SensorRadarHub::reset() {
  frame_assembler_.reset();
  selection_.reset();
  point_clusters_.reset();
  phd_tracker_.reset();
  kalman_tracker_.reset();
  range_tracker_.reset();
  known_.clear();
  clock_.reset();
}

void SensorRadarHub::set_tap_sink(const TapSink& sink) {
  taps_ = sink;
  phd_tracker_.set_tap_sink(sink);
  kalman_tracker_.set_tap_sink(sink);
  range_tracker_.set_tap_sink(sink);
}

Status SensorRadarHub::receive(const link::Detections& report, std::int64_t now_us) {
  if (!configured_) return Status::kNotConfigured;
  return frame_assembler_.receive(report, now_us);
}

Status SensorRadarHub::poll(std::int64_t now_us, link::Tracks& tracks, bool& closed) {
  closed = false;
  tracks.tracks.clear();
  if (!configured_) return Status::kNotConfigured;
  if (const Status status = frame_assembler_.poll(now_us, frame_, closed); status != Status::kOk || !closed)
    return status;
  show_frame(taps_, frame_, {tap_rows_.data(), tap_rows_.size()});
  const float dt_s = clock_.step_s(frame_.time_us, config_.frame_period_s);

  BoundedVector<Point, kMaxTracks> people;
  predict_people(dt_s, people);
  const Status selected =
      selection_.process(frame_.detections.span(), frame_.n_reported, people.span(), measurements_);
  tap_selected();

  const Status clustered = point_clusters_.process(measurements_.span(), points_);
  tap_points();

  const Status tracked = track(dt_s, tracks);
  tracks.time_us = frame_.time_us;
  tracks.frame = frame_.frame;
  known_.clear();
  for (const link::Track& track : tracks.tracks) ECHOFUSE_CHECK(known_.try_push_back(track));
  for (const Status status : {selected, clustered, tracked})
    if (status != Status::kOk) return status;
  return Status::kOk;
}

/// By the configured tracker.
Status SensorRadarHub::track(float dt_s, link::Tracks& tracks) {
  if (config_.tracker == Tracker::kRange)
    return range_tracker_.process(frame_.detections.span(), dt_s, tracks);
  BoundedVector<Eigen::Vector2f, kMaxPointsPerFrame> positions;
  for (const PointCluster& point : points_) ECHOFUSE_CHECK(positions.try_push_back({point.x_m, point.y_m}));
  if (config_.tracker == Tracker::kPhd) return phd_tracker_.process(positions.span(), dt_s, tracks);
  return kalman_tracker_.process(positions.span(), dt_s, tracks);
}

/// Where the known people should be by now.
void SensorRadarHub::predict_people(float dt_s, BoundedVector<Point>& people) const {
  for (const link::Track& track : known_) {
    if (track.state == link::TrackState::kUnconfirmed) continue;
    if (track.frames_since_update > config_.aid_missed_frames) continue;
    ECHOFUSE_CHECK(people.try_push_back({track.x_m + dt_s * track.vx_mps, track.y_m + dt_s * track.vy_mps}));
  }
}

SensorRadarHubCounters SensorRadarHub::counters() const {
  std::uint32_t dropped_births = range_tracker_.dropped_births();
  if (config_.tracker == Tracker::kPhd) dropped_births = phd_tracker_.manager().dropped_births();
  if (config_.tracker == Tracker::kKalman) dropped_births = kalman_tracker_.manager().dropped_births();
  return {frame_assembler_.counters(), selection_.counters(), point_clusters_.dropped(), dropped_births,
          clock_.faults()};
}

void SensorRadarHub::tap_selected() {
  if (!taps_.wants(TapId::kSelected)) return;
  std::size_t n = 0;
  for (const Measurement& m : measurements_)
    for (const float value : {m.x_m, m.y_m, m.weight, m.range_residual_m, static_cast<float>(m.n_nodes)})
      tap_rows_[n++] = value;
  taps_(TapId::kSelected, {tap_rows_.data(), n});
}

void SensorRadarHub::tap_points() {
  if (!taps_.wants(TapId::kPoints)) return;
  std::size_t n = 0;
  for (const PointCluster& p : points_)
    for (const float value : {p.x_m, p.y_m, static_cast<float>(p.members), p.weight}) tap_rows_[n++] = value;
  taps_(TapId::kPoints, {tap_rows_.data(), n});
}

}  // namespace echofuse::hub
