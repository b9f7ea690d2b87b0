#include "echofuse/hub/through_wall.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "echofuse/core/constants.hpp"
#include "measure/show_frame.hpp"
#include "track/report_tracks.hpp"

namespace echofuse::hub {
namespace {

constexpr float kOnLine_m = 1e-3f;       ///< [m] antennas may stand so far from their line
constexpr float kSameTrace = 0.5f;       ///< [sample] a couple's delay is this trace's
constexpr float kBetweenDeviations = 3;  ///< of a further receiver's path from what a couple predicts

bool on_a_line(Span<const NodeSite> nodes) {
  const Point& tx = nodes[0].tx;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (invalid_field(nodes[i]) != nullptr) return false;
    if (nodes[i].tx.x_m != tx.x_m || nodes[i].tx.y_m != tx.y_m) return false;
    if (nodes[i].rx.x_m == tx.x_m || !(std::abs(nodes[i].rx.y_m - tx.y_m) <= kOnLine_m)) return false;
    for (std::size_t k = 0; k < i; ++k)
      if (nodes[i].node_id == nodes[k].node_id || nodes[i].rx.x_m == nodes[k].rx.x_m) return false;
  }
  return true;
}

/// Where people's middles can be, from the transmitter.
Area inner_area(const ThroughWallHubConfig& config) {
  const Point& tx = config.nodes[0].tx;
  const float margin_m = config.body_radius_m;
  return {config.area.min_x_m - tx.x_m + margin_m, config.area.min_y_m - tx.y_m + margin_m,
          config.area.max_x_m - tx.x_m - margin_m, config.area.max_y_m - tx.y_m - margin_m};
}

}  // namespace

const char* invalid_field(const ThroughWallHubConfig& config) {
  if (config.n_nodes < 2 || config.n_nodes > static_cast<int>(kMaxArrayReceivers)) return "n_nodes";
  if (!on_a_line({config.nodes.data(), static_cast<std::size_t>(config.n_nodes)})) return "nodes";
  if (invalid_field(config.area) != nullptr || !(config.area.min_y_m > config.nodes[0].tx.y_m)) return "area";
  if (!(config.frame_period_s > 0.0f && std::isfinite(config.frame_period_s))) return "frame_period_s";
  if (!(config.body_radius_m >= 0.0f) || invalid_field(inner_area(config)) != nullptr) return "body_radius_m";
  if (invalid_field(config.frame_assembler) != nullptr) return "frame_assembler";
  if (invalid_field(config.trace_pairing) != nullptr) return "trace_pairing";
  if (invalid_field(config.line_locator) != nullptr) return "line_locator";
  if (invalid_field(config.path_tracker) != nullptr) return "path_tracker";
  if (invalid_field(config.tracks) != nullptr) return "tracks";
  return nullptr;
}

Status ThroughWallHub::configure(const ThroughWallHubConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  const Span<const NodeSite> nodes{config_.nodes.data(), static_cast<std::size_t>(config.n_nodes)};
  tx_ = nodes[0].tx;
  first_ = last_ = 0;
  for (std::size_t r = 0; r < nodes.size(); ++r) {
    rx_x_m_[r] = nodes[r].rx.x_m - tx_.x_m;
    if (rx_x_m_[r] < rx_x_m_[first_]) first_ = r;
    if (rx_x_m_[r] > rx_x_m_[last_]) last_ = r;
  }
  const Span<const float> rx_x_m{rx_x_m_.data(), nodes.size()};
  std::array<Eigen::Vector2f, kMaxArrayReceivers> rx_m;
  for (std::size_t r = 0; r < nodes.size(); ++r) rx_m[r] = {rx_x_m_[r], 0.0f};
  const Area inner = inner_area(config);
  TracePairingConfig pairing = config.trace_pairing;
  pairing.separation_m = rx_x_m_[last_] - rx_x_m_[first_];
  if (config.track_aided) pairing.completion_limit = 0;  // tracks do that, and better
  const Status made[] = {
      frame_assembler_.configure(config.frame_assembler, nodes), trace_pairing_.configure(pairing),
      line_locator_.configure(config.line_locator, rx_x_m),
      path_tracker_.configure(config.path_tracker, config.line_locator.wall, {rx_m.data(), nodes.size()},
                              {inner.min_x_m, inner.min_y_m}, {inner.max_x_m, inner.max_y_m}),
      kalman_tracker_.configure(config.tracks)};
  for (const Status status : made) ECHOFUSE_CHECK(status == Status::kOk);  // invalid_field() saw to it
  configured_ = true;
  reset();
  return Status::kOk;
}

void ThroughWallHub::reset() {
  counted_ = ThroughWallHubCounters{};
  frame_assembler_.reset();
  clock_.reset();
  trace_pairing_.reset();
  path_tracker_.reset();
  kalman_tracker_.reset();
}

void ThroughWallHub::set_tap_sink(const TapSink& sink) { taps_ = sink; }

Status ThroughWallHub::receive(const link::Detections& report, std::int64_t now_us) {
  if (!configured_) return Status::kNotConfigured;
  return frame_assembler_.receive(report, now_us);
}

Status ThroughWallHub::poll(std::int64_t now_us, link::Tracks& tracks, bool& closed) {
  closed = false;
  tracks.tracks.clear();
  if (!configured_) return Status::kNotConfigured;
  if (const Status status = frame_assembler_.poll(now_us, frame_, closed); status != Status::kOk || !closed)
    return status;
  show_frame(taps_, frame_, {tap_rows_.data(), tap_rows_.size()});
  const float dt_s = clock_.step_s(frame_.time_us, config_.frame_period_s);
  for (FrameDetection& detection : frame_.detections) detection.path_m += 2.0f * config_.body_radius_m;

  // 1. Tracks take what they explain.
  associated_.fill(0);
  points_.clear();
  Status status = Status::kOk;
  if (config_.track_aided)
    status =
        path_tracker_.update(frame_.detections.span(), dt_s, {associated_.data(), frame_.detections.size()});

  // 2. What is left is paired and located.
  BoundedVector<TraceCouple, kMaxPointsPerFrame> couples;
  if (const Status paired = pair(couples); paired != Status::kOk) status = paired;
  std::int32_t number = 0;
  for (const TraceCouple& couple : couples)
    if (const Status located = locate(couple, --number); located != Status::kOk) status = located;
  show_associated();
  show_points();

  // 3. Tracks.
  if (const Status tracked = track(dt_s, tracks); tracked != Status::kOk) status = tracked;
  tracks.time_us = frame_.time_us;
  tracks.frame = frame_.frame;
  show_tracks<2>(taps_, tracks);
  return status;
}

/// Of the detections that nothing took, ascending.
void ThroughWallHub::free_delays(std::size_t receiver, Delays& delay_s) const {
  for (std::size_t i = 0; i < frame_.detections.size(); ++i) {
    const FrameDetection& detection = frame_.detections[i];
    if (detection.node_index != static_cast<int>(receiver) || associated_[i] != 0) continue;
    ECHOFUSE_CHECK(delay_s.try_push_back(detection.path_m / kSpeedOfLight_mps));
  }
}

/// Of the two receivers that are farthest apart.
Status ThroughWallHub::pair(BoundedVector<TraceCouple>& couples) {
  Delays first, last;
  free_delays(first_, first);
  free_delays(last_, last);
  const Status status = trace_pairing_.process(first.span(), last.span(), couples);
  counted_.couples += static_cast<std::uint32_t>(couples.size());
  if (status == Status::kTruncated) ++counted_.dropped_points;
  return status;
}

/// number: of the couple, -1 or less. kTruncated: no room for its track.
Status ThroughWallHub::locate(const TraceCouple& couple, std::int32_t number) {
  const float reach_m = kSameTrace / config_.trace_pairing.clock_hz * kSpeedOfLight_mps;
  weight_.fill(0.0f);
  least_weight_ = 0.0f;
  for (const auto& [receiver, delay_s] : {std::pair{first_, couple.delay1_s}, {last_, couple.delay2_s}}) {
    const float path_m = delay_s * kSpeedOfLight_mps;
    (void)use(receiver, path_m, reach_m, number);
    path_m_[receiver] = path_m;  // which of a completed couple is nobody's
    weight_[receiver] = 1.0f;
  }
  LineFix fix = locate_paths();
  if (fix.status == LineFixStatus::kFix && use_between(fix, number)) fix = locate_paths();
  if (fix.status != LineFixStatus::kFix) {
    ++counted_.unlocated;
    return Status::kOk;
  }
  if (!contains(config_.area, {fix.position.x_m + tx_.x_m, fix.position.y_m + tx_.y_m})) {
    ++counted_.outside_area;
    return Status::kOk;
  }
  const auto n_paths = static_cast<int>(std::count(weight_.begin(), weight_.end(), 1.0f));
  ECHOFUSE_CHECK(points_.try_push_back({fix.position, n_paths, least_weight_}));  // as many as couples
  if (!config_.track_aided) return Status::kOk;
  Eigen::Matrix2f covariance;
  covariance << fix.covariance_xx_m2, fix.covariance_xy_m2, fix.covariance_xy_m2, fix.covariance_yy_m2;
  return path_tracker_.begin({fix.position.x_m, fix.position.y_m}, covariance);
}

LineFix ThroughWallHub::locate_paths() {
  const auto n = static_cast<std::size_t>(config_.n_nodes);
  LineFix fix;
  (void)line_locator_.process({path_m_.data(), n}, {weight_.data(), n}, fix);
  return fix;
}

/// A detection that no track took, nor, where one belongs to one couple, an earlier couple.
bool ThroughWallHub::available(std::size_t detection) const {
  if (config_.trace_pairing.rule == PairingRule::kAllPairs) return associated_[detection] <= 0;
  return associated_[detection] == 0;
}

/// The receiver's available detection that is nearest to a path, if there is one within reach.
bool ThroughWallHub::use(std::size_t receiver, float path_m, float reach_m, std::int32_t number) {
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
  associated_[best] = number;
  path_m_[receiver] = frame_.detections[best].path_m;
  weight_[receiver] = 1.0f;
  const float weight = frame_.detections[best].weight;
  least_weight_ = least_weight_ == 0.0f ? weight : std::min(least_weight_, weight);
  return true;
}

/// The traces of the receivers between those of a couple that its fix explains; whether there are any.
bool ThroughWallHub::use_between(const LineFix& fix, std::int32_t number) {
  const AntennaRay tx = antenna_ray(line_locator_.wall(), fix.position, 0.0f);
  bool found = false;
  for (std::size_t r = 0; r < static_cast<std::size_t>(config_.n_nodes); ++r) {
    if (r == first_ || r == last_) continue;
    const AntennaRay path = tx + antenna_ray(line_locator_.wall(), fix.position, rx_x_m_[r]);
    const float x = path.gradient.x_m;
    const float y = path.gradient.y_m;
    const float variance = x * x * fix.covariance_xx_m2 + 2.0f * x * y * fix.covariance_xy_m2 +
                           y * y * fix.covariance_yy_m2 +
                           config_.line_locator.path_std_m * config_.line_locator.path_std_m;
    found = use(r, path.optical_m, kBetweenDeviations * std::sqrt(variance), number) || found;
  }
  return found;
}

Status ThroughWallHub::track(float dt_s, link::Tracks& tracks) {
  if (config_.track_aided) {
    path_tracker_.report(tracks);
    for (link::Track& track : tracks.tracks) {
      track.x_m += tx_.x_m;
      track.y_m += tx_.y_m;
    }
    return Status::kOk;
  }
  BoundedVector<Eigen::Vector2f, kMaxPointsPerFrame> positions;
  for (const LocatedPoint& point : points_)
    ECHOFUSE_CHECK(positions.try_push_back({point.position.x_m + tx_.x_m, point.position.y_m + tx_.y_m}));
  return kalman_tracker_.process(positions.span(), dt_s, tracks);
}

ThroughWallHubCounters ThroughWallHub::counters() const {
  ThroughWallHubCounters counted = counted_;
  counted.reports = frame_assembler_.counters();
  counted.dropped_births =
      config_.track_aided ? path_tracker_.dropped_births() : kalman_tracker_.manager().dropped_births();
  counted.dropped_combinations = path_tracker_.dropped_combinations();
  counted.clock_faults = clock_.faults();
  return counted;
}

void ThroughWallHub::show_associated() {
  if (!taps_.wants(TapId::kAssociated)) return;
  const std::size_t n = frame_.detections.size();
  for (std::size_t i = 0; i < n; ++i) tap_rows_[i] = static_cast<float>(associated_[i]);
  taps_(TapId::kAssociated, {tap_rows_.data(), n});
}

void ThroughWallHub::show_points() {
  if (!taps_.wants(TapId::kPoints)) return;
  std::size_t n = 0;
  for (const LocatedPoint& point : points_)
    for (const float value : {point.position.x_m + tx_.x_m, point.position.y_m + tx_.y_m,
                              static_cast<float>(point.n_paths), point.weight})
      tap_rows_[n++] = value;
  taps_(TapId::kPoints, {tap_rows_.data(), n});
}

}  // namespace echofuse::hub
