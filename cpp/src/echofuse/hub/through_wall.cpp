#include "echofuse/hub/through_wall.hpp"

#include <cmath>

namespace echofuse::hub {
namespace {

constexpr float kOnLine_m = 1e-3f;       ///< [m] antennas may stand so far from their line
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

Room<2> room_of(const ThroughWallHubConfig& config) {
  const Point& tx = config.nodes[0].tx;
  const Area& area = config.area;
  return {{tx.x_m, tx.y_m}, {area.min_x_m, area.min_y_m}, {area.max_x_m, area.max_y_m}, config.body_radius_m};
}

}  // namespace

const char* invalid_field(const ThroughWallHubConfig& config) {
  if (config.n_nodes < 2 || config.n_nodes > static_cast<int>(kMaxArrayReceivers)) return "n_nodes";
  if (!on_a_line({config.nodes.data(), static_cast<std::size_t>(config.n_nodes)})) return "nodes";
  if (invalid_field(config.area) != nullptr || !(config.area.min_y_m > config.nodes[0].tx.y_m)) return "area";
  if (!(config.frame_period_s > 0.0f && std::isfinite(config.frame_period_s))) return "frame_period_s";
  if (!room_of(config).has_room()) return "body_radius_m";
  if (invalid_field(config.frame_assembler) != nullptr) return "frame_assembler";
  if (invalid_field(config.trace_pairing) != nullptr) return "trace_pairing";
  if (invalid_field(config.line_locator) != nullptr) return "line_locator";
  if (invalid_field(config.path_tracker) != nullptr) return "path_tracker";
  if (invalid_field(config.tracks) != nullptr) return "tracks";
  return nullptr;
}

Status ThroughWallHub::configure(const ThroughWallHubConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  n_receivers_ = static_cast<std::size_t>(config.n_nodes);
  path_variance_m2_ = config.line_locator.path_std_m * config.line_locator.path_std_m;
  const Span<const NodeSite> nodes{config.nodes.data(), n_receivers_};
  std::array<Eigen::Vector2f, kMaxArrayReceivers> rx_m;
  first_ = last_ = 0;
  for (std::size_t r = 0; r < n_receivers_; ++r) {
    rx_x_m_[r] = nodes[r].rx.x_m - nodes[0].tx.x_m;
    rx_m[r] = {rx_x_m_[r], 0.0f};
    if (rx_x_m_[r] < rx_x_m_[first_]) first_ = r;
    if (rx_x_m_[r] > rx_x_m_[last_]) last_ = r;
  }
  TracePairingConfig pairing = config.trace_pairing;
  pairing.separation_m = rx_x_m_[last_] - rx_x_m_[first_];
  if (config.track_aided) pairing.completion_limit = 0;  // tracks do that, and better
  const Status made[] = {trace_pairing_.configure(pairing),
                         line_locator_.configure(config.line_locator, {rx_x_m_.data(), n_receivers_})};
  for (const Status status : made) ECHOFUSE_CHECK(status == Status::kOk);  // invalid_field() saw to it
  PathHub<2>::Setup setup;
  setup.nodes = nodes;
  setup.rx_m = {rx_m.data(), n_receivers_};
  setup.room = room_of(config);
  setup.frame_period_s = config.frame_period_s;
  setup.track_aided = config.track_aided;
  setup.frame_assembler = config.frame_assembler;
  setup.trace_pairing = config.trace_pairing;
  setup.wall = config.line_locator.wall;
  setup.path_tracker = config.path_tracker;
  setup.tracks = config.tracks;
  paths_.configure(setup);
  return Status::kOk;
}

void ThroughWallHub::reset() {
  paths_.reset();
  trace_pairing_.reset();
}

Status ThroughWallHub::poll(std::int64_t now_us, link::Tracks& tracks, bool& closed) {
  tracks.tracks.clear();
  // 1. Tracks take what they explain.
  Status status = paths_.open(now_us, closed);
  if (!closed) return status;

  // 2. What is left is paired and located.
  BoundedVector<TraceCouple, kMaxPointsPerFrame> couples;
  if (const Status paired = pair(couples); paired != Status::kOk) status = paired;
  for (const TraceCouple& couple : couples)
    if (const Status located = locate(couple); located != Status::kOk) status = located;

  // 3. Tracks.
  if (const Status tracked = paths_.close(tracks); tracked != Status::kOk) status = tracked;
  return status;
}

/// Of the two receivers that are farthest apart.
Status ThroughWallHub::pair(BoundedVector<TraceCouple>& couples) {
  PathHub<2>::Delays first, last;
  paths_.free_delays(first_, first);
  paths_.free_delays(last_, last);
  const Status status = trace_pairing_.process(first.span(), last.span(), couples);
  paths_.count_couples(couples.size());
  if (status == Status::kTruncated) paths_.count_dropped_points();
  return status;
}

/// kTruncated: no room for its track.
Status ThroughWallHub::locate(const TraceCouple& couple) {
  paths_.begin_target();
  paths_.take(couple, first_, last_);
  LineFix fix = locate_paths();
  if (fix.status == LineFixStatus::kFix && use_between(fix)) fix = locate_paths();
  if (fix.status != LineFixStatus::kFix) {
    paths_.count_unlocated();
    return Status::kOk;
  }
  Eigen::Matrix2f covariance;
  covariance << fix.covariance_xx_m2, fix.covariance_xy_m2, fix.covariance_xy_m2, fix.covariance_yy_m2;
  return paths_.keep({fix.position.x_m, fix.position.y_m}, covariance);
}

LineFix ThroughWallHub::locate_paths() {
  LineFix fix;
  (void)line_locator_.process(paths_.path_m(), paths_.weight(), fix);
  return fix;
}

/// The traces of the receivers between those of a couple that its fix explains; whether there are any.
bool ThroughWallHub::use_between(const LineFix& fix) {
  const AntennaRay tx = antenna_ray(line_locator_.wall(), fix.position, 0.0f);
  bool found = false;
  for (std::size_t r = 0; r < n_receivers_; ++r) {
    if (r == first_ || r == last_) continue;
    const AntennaRay path = tx + antenna_ray(line_locator_.wall(), fix.position, rx_x_m_[r]);
    const float x = path.gradient.x_m;
    const float y = path.gradient.y_m;
    const float variance = x * x * fix.covariance_xx_m2 + 2.0f * x * y * fix.covariance_xy_m2 +
                           y * y * fix.covariance_yy_m2 + path_variance_m2_;
    found = paths_.use(r, path.optical_m, kBetweenDeviations * std::sqrt(variance)) || found;
  }
  return found;
}

}  // namespace echofuse::hub
