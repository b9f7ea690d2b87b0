#include "echofuse/hub/through_wall_3d.hpp"

#include <cmath>

#include "echofuse/core/constants.hpp"
#include "echofuse/estimation/assignment.hpp"

namespace echofuse::hub {
namespace {

constexpr float kOnCross_m = 1e-3f;  ///< [m] antennas may stand so far from a perfect cross
constexpr float kMaxSpacing_m = 5.0f;
constexpr std::size_t kLeft = 0, kRight = 1, kLow = 2, kHigh = 3;  ///< receivers

bool near(const Point3& a, const Point3& b) {
  return std::abs(a.x_m - b.x_m) <= kOnCross_m && std::abs(a.y_m - b.y_m) <= kOnCross_m &&
         std::abs(a.z_m - b.z_m) <= kOnCross_m;
}

/// [m] d, the mean of the arms.
float spacing_m(const ThroughWall3dHubConfig& config) {
  const auto& nodes = config.nodes;
  return 0.25f * (nodes[kRight].rx.x_m - nodes[kLeft].rx.x_m + nodes[kHigh].rx.z_m - nodes[kLow].rx.z_m);
}

bool is_cross(const ThroughWall3dHubConfig& config) {
  const float d = spacing_m(config);
  const Point3& tx = config.nodes[0].tx;
  const Point3 perfect[] = {{tx.x_m - d, tx.y_m, tx.z_m},
                            {tx.x_m + d, tx.y_m, tx.z_m},
                            {tx.x_m, tx.y_m, tx.z_m - d},
                            {tx.x_m, tx.y_m, tx.z_m + d}};
  if (!(d > kOnCross_m && d <= kMaxSpacing_m)) return false;
  for (std::size_t i = 0; i < config.nodes.size(); ++i) {
    const NodeSite3d& node = config.nodes[i];
    if (invalid_field(node) != nullptr || !near(node.tx, tx) || !near(node.rx, perfect[i])) return false;
    for (std::size_t k = 0; k < i; ++k)
      if (node.node_id == config.nodes[k].node_id) return false;
  }
  return true;
}

Room<3> room_of(const ThroughWall3dHubConfig& config) {
  const Point3& tx = config.nodes[0].tx;
  const Box& area = config.area;
  return {{tx.x_m, tx.y_m, tx.z_m},
          {area.min_x_m, area.min_y_m, area.min_z_m},
          {area.max_x_m, area.max_y_m, area.max_z_m},
          config.body_radius_m};
}

bool locates(const Taylor3dConfig& config) {
  return invalid_field(config) == nullptr && config.start != Taylor3dStart::kGiven &&
         config.range_kind == RangeKind::kBistatic;
}

}  // namespace

const char* invalid_field(const ThroughWall3dHubConfig& config) {
  if (config.n_nodes != static_cast<int>(config.nodes.size())) return "n_nodes";
  if (!is_cross(config)) return "nodes";
  if (invalid_field(config.area) != nullptr || !(config.area.min_y_m > config.nodes[0].tx.y_m)) return "area";
  if (!(config.frame_period_s > 0.0f && std::isfinite(config.frame_period_s))) return "frame_period_s";
  if (!room_of(config).has_room()) return "body_radius_m";
  if (invalid_field(config.frame_assembler) != nullptr) return "frame_assembler";
  if (invalid_field(config.trace_pairing) != nullptr) return "trace_pairing";
  if (!(config.range_difference_m > 0.0f && std::isfinite(config.range_difference_m)))
    return "range_difference_m";
  if (!locates(config.taylor_3d)) return "taylor_3d";
  if (!(config.path_std_m >= 1e-3f && config.path_std_m <= 1e3f)) return "path_std_m";
  if (invalid_field(config.path_tracker) != nullptr) return "path_tracker";
  if (invalid_field(config.tracks) != nullptr) return "tracks";
  return nullptr;
}

Status ThroughWall3dHub::configure(const ThroughWall3dHubConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  spacing_m_ = spacing_m(config);
  range_difference_m_ = config.range_difference_m;
  all_pairs_ = config.trace_pairing.rule == PairingRule::kAllPairs;
  variance_m2_ = config.path_std_m * config.path_std_m;
  Wall wall;
  std::array<Point3, 4> cross;
  cross[kLeft].x_m = cross[kLow].z_m = -spacing_m_;
  cross[kRight].x_m = cross[kHigh].z_m = spacing_m_;
  TracePairingConfig pairing = config.trace_pairing;
  pairing.separation_m = 2.0f * spacing_m_;
  if (config.track_aided) pairing.completion_limit = 0;  // tracks do that, and better
  const Status made[] = {wall.configure(config.taylor_3d.wall), pairing_along_.configure(pairing),
                         pairing_up_.configure(pairing), taylor_3d_.configure(config.taylor_3d, {}, cross)};
  for (const Status status : made) ECHOFUSE_CHECK(status == Status::kOk);  // invalid_field() saw to it
  excess_m_ = 2.0f * wall.normal_excess_m();

  std::array<NodeSite, 4> nodes;
  std::array<Eigen::Vector3f, 4> rx_m;
  for (std::size_t r = 0; r < nodes.size(); ++r) {
    nodes[r].node_id = config.nodes[r].node_id;
    rx_m[r] = {cross[r].x_m, cross[r].y_m, cross[r].z_m};
  }
  PathHub<3>::Setup setup;
  setup.nodes = nodes;
  setup.rx_m = rx_m;
  setup.room = room_of(config);
  setup.frame_period_s = config.frame_period_s;
  setup.track_aided = config.track_aided;
  setup.frame_assembler = config.frame_assembler;
  setup.trace_pairing = config.trace_pairing;
  setup.wall = config.taylor_3d.wall;
  setup.path_tracker = config.path_tracker;
  setup.tracks = config.tracks;
  paths_.configure(setup);
  reset();
  return Status::kOk;
}

void ThroughWall3dHub::reset() {
  paths_.reset();
  pairing_along_.reset();
  pairing_up_.reset();
  quads_found_ = clipped_ = 0;
}

Status ThroughWall3dHub::poll(std::int64_t now_us, link::Tracks& tracks, bool& closed) {
  tracks.tracks.clear();
  // 1. Tracks take what they explain.
  Status status = paths_.open(now_us, closed);
  if (!closed) return status;

  // 2. What is left is paired on each axis and over both, and located.
  if (const Status paired = pair(); paired != Status::kOk) status = paired;
  for (const Quad& quad : quads_)
    if (const Status located = locate(quad); located != Status::kOk) status = located;

  // 3. Tracks.
  if (const Status tracked = paths_.close(tracks); tracked != Status::kOk) status = tracked;
  return status;
}

/// kTruncated: more couples or quads than points of a frame.
Status ThroughWall3dHub::pair() {
  std::array<PathHub<3>::Delays, 4> delay_s;
  for (std::size_t r = 0; r < delay_s.size(); ++r) paths_.free_delays(r, delay_s[r]);
  const Status along = pairing_along_.process(delay_s[kLeft].span(), delay_s[kRight].span(), along_);
  const Status up = pairing_up_.process(delay_s[kLow].span(), delay_s[kHigh].span(), up_);
  paths_.count_couples(along_.size() + up_.size());
  for (std::size_t i = 0; i < along_.size(); ++i)
    for (std::size_t k = 0; k < up_.size(); ++k)
      difference_m_[i * up_.size() + k] = std::abs(range_m(along_[i]) - range_m(up_[k]));
  quads_.clear();
  const bool room = all_pairs_ ? match_all() : match_by_assignment();
  quads_found_ += static_cast<std::uint32_t>(quads_.size());
  if (room && along == Status::kOk && up == Status::kOk) return Status::kOk;
  paths_.count_dropped_points();
  return Status::kTruncated;
}

/// [m] between transmitter and target.
float ThroughWall3dHub::range_m(const TraceCouple& couple) const {
  const float d1 = couple.delay1_s * kSpeedOfLight_mps - excess_m_;
  const float d2 = couple.delay2_s * kSpeedOfLight_mps - excess_m_;
  return (d1 * d1 + d2 * d2 - 2.0f * spacing_m_ * spacing_m_) / (2.0f * (d1 + d2));
}

/// False when there is no room.
bool ThroughWall3dHub::match_all() {
  for (std::size_t i = 0; i < along_.size(); ++i)
    for (std::size_t k = 0; k < up_.size(); ++k)
      if (difference_m_[i * up_.size() + k] <= range_difference_m_ && !quads_.try_push_back({i, k}))
        return false;
  return true;
}

bool ThroughWall3dHub::match_by_assignment() {
  if (along_.empty() || up_.empty()) return true;
  const float none_m = 2.0f * range_difference_m_;  // one more quad is worth any difference
  const Span<float> cost{difference_m_.data(), along_.size() * up_.size()};
  for (float& difference : cost)
    if (!(difference <= range_difference_m_)) difference = none_m;
  std::array<int, kMaxPointsPerFrame> partner{};
  const Status status = estimation::assign(cost, along_.size(), up_.size(), {partner.data(), along_.size()});
  ECHOFUSE_CHECK(status == Status::kOk);
  for (std::size_t i = 0; i < along_.size(); ++i) {
    if (partner[i] == estimation::kUnassigned) continue;
    const auto k = static_cast<std::size_t>(partner[i]);
    if (cost[i * up_.size() + k] < none_m) ECHOFUSE_CHECK(quads_.try_push_back({i, k}));  // as few as couples
  }
  return true;
}

/// kTruncated: no room for its track.
Status ThroughWall3dHub::locate(const Quad& quad) {
  paths_.begin_target();
  paths_.take(along_[quad.along], kLeft, kRight);
  paths_.take(up_[quad.up], kLow, kHigh);
  const std::array<float, 4> variance_m2{variance_m2_, variance_m2_, variance_m2_, variance_m2_};
  Taylor3dFix fix;
  (void)taylor_3d_.process(paths_.path_m(), variance_m2, {}, fix);  // paths of no sense have no start
  if (fix.clipped_start) ++clipped_;
  if (fix.status == Taylor3dStatus::kSingular || fix.status == Taylor3dStatus::kNoStart) {
    paths_.count_unlocated();
    return Status::kOk;
  }
  const auto& [xx, xy, xz, yy, yz, zz] = fix.covariance_m2;
  Eigen::Matrix3f covariance;
  covariance << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return paths_.keep({fix.position.x_m, fix.position.y_m, fix.position.z_m}, covariance);
}

ThroughWall3dHubCounters ThroughWall3dHub::counters() const {
  return {paths_.counters(), quads_found_, clipped_};
}

}  // namespace echofuse::hub
