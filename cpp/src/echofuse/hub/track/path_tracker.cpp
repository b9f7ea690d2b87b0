#include "echofuse/hub/track/path_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace echofuse::hub {
namespace {

constexpr float kMinDepth_m = 0.02f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kMaxWindow = 32;  ///< bits of the updates

using Filter = estimation::ConstantVelocityFilter<2>;

bool positive(float value) { return value > 0.0f && std::isfinite(value); }
bool not_negative(float value) { return value >= 0.0f && std::isfinite(value); }

int count_bits(std::uint32_t bits) {
  int n = 0;
  for (; bits != 0; bits &= bits - 1) ++n;
  return n;
}

}  // namespace

const char* invalid_field(const PathTrackerConfig& config) {
  if (!positive(config.acceleration_density_m2ps3)) return "acceleration_density_m2ps3";
  if (!positive(config.velocity_std_mps)) return "velocity_std_mps";
  if (!positive(config.path_std_m)) return "path_std_m";
  if (!not_negative(config.common_path_std_m)) return "common_path_std_m";
  if (!positive(config.gate)) return "gate";
  if (!not_negative(config.missing_cost)) return "missing_cost";
  if (!not_negative(config.lone_gate)) return "lone_gate";
  if (config.lone_limit < 0) return "lone_limit";
  if (!positive(config.cut_off)) return "cut_off";
  if (config.confirm_updates < 1) return "confirm_updates";
  if (config.confirm_window < config.confirm_updates || config.confirm_window > kMaxWindow)
    return "confirm_window";
  if (!not_negative(config.silent_time_s)) return "silent_time_s";
  if (!not_negative(config.silent_velocity_time_s)) return "silent_velocity_time_s";
  if (!not_negative(config.birth_exclusion_m)) return "birth_exclusion_m";
  if (!not_negative(config.merge_distance_m)) return "merge_distance_m";
  if (!not_negative(config.merge_speed_mps)) return "merge_speed_mps";
  if (config.max_tracks < 1 || config.max_tracks > static_cast<int>(kMaxTracks)) return "max_tracks";
  return nullptr;
}

Status PathTracker::configure(const PathTrackerConfig& config, const WallConfig& wall,
                              Span<const float> rx_x_m, const Area& area) {
  LineLocator line;  // for what it says of receivers and wall
  if (invalid_field(config) != nullptr || line.configure({wall}, rx_x_m) != Status::kOk)
    return Status::kInvalidConfig;
  if (invalid_field(area) != nullptr || !(area.min_y_m > 0.0f)) return Status::kInvalidConfig;
  (void)wall_.configure(wall);
  config_ = config;
  area_ = area;
  n_receivers_ = rx_x_m.size();
  std::copy(rx_x_m.begin(), rx_x_m.end(), rx_x_m_.begin());
  reset();
  return Status::kOk;
}

void PathTracker::reset() {
  tracks_.clear();
  next_id_ = 1;
  dropped_births_ = 0;
  dropped_combinations_ = 0;
}

Status PathTracker::update(Span<const FrameDetection> paths, float dt_s, Span<std::int32_t> owners) {
  if (n_receivers_ == 0) return Status::kNotConfigured;
  if (owners.size() != paths.size() || !positive(dt_s) || !well_formed(paths)) return Status::kInvalidInput;
  paths_ = paths;
  owners_ = owners;
  combinations_ = 0;
  const std::uint32_t dropped = dropped_combinations_;
  std::fill(owners.begin(), owners.end(), 0);
  first_.fill(paths.size());
  for (std::size_t i = paths.size(); i-- > 0;)
    for (int r = paths[i].node_index; r >= 0; --r) first_[static_cast<std::size_t>(r)] = i;

  predict(dt_s);
  share_out(true);
  share_out(false);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    TrackState& track = tracks_[i];
    bool updated = choices_[i].distance < kInfinity;
    if (updated) {
      take(track, choices_[i].traces);
      track.lone = 0;
    } else {
      updated = take_lone(track);
    }
    track.updates = (track.updates << 1) | (updated ? 1u : 0u);
    track.age = std::min(track.age + 1, config_.confirm_window);
    track.misses = updated ? 0 : track.misses + 1;
    track.silent_time_s = updated ? 0.0f : track.silent_time_s + dt_s;
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!lives(tracks_[i], dt_s)) continue;
    bool double_of_other = false;
    for (std::size_t k = 0; k < kept; ++k) double_of_other |= same(tracks_[i], tracks_[k]);
    if (double_of_other) continue;
    if (kept != i) tracks_[kept] = tracks_[i];
    ++kept;
  }
  while (tracks_.size() > kept) tracks_.pop_back();
  paths_ = {};
  owners_ = {};
  return dropped_combinations_ == dropped ? Status::kOk : Status::kTruncated;
}

Status PathTracker::begin(const LineFix& fix) {
  if (n_receivers_ == 0) return Status::kNotConfigured;
  for (const TrackState& track : tracks_) {
    const float dx = track.filter.state()(0) - fix.position.x_m;
    const float dy = track.filter.state()(2) - fix.position.y_m;
    if (std::sqrt(dx * dx + dy * dy) < config_.birth_exclusion_m) return Status::kOk;
  }
  if (tracks_.size() >= static_cast<std::size_t>(config_.max_tracks)) {
    ++dropped_births_;
    return Status::kTruncated;
  }
  Filter::Covariance covariance = Filter::Covariance::Zero();
  const float shared = config_.common_path_std_m * config_.common_path_std_m / 4.0f;
  covariance(0, 0) = fix.covariance_xx_m2 + shared;
  covariance(0, 2) = covariance(2, 0) = fix.covariance_xy_m2;
  covariance(2, 2) = fix.covariance_yy_m2 + shared;
  covariance(1, 1) = covariance(3, 3) = config_.velocity_std_mps * config_.velocity_std_mps;
  TrackState track;
  track.id = next_id_++;
  track.confirmed = config_.confirm_updates <= 1;
  track.filter = {{fix.position.x_m, 0.0f, fix.position.y_m, 0.0f}, covariance};
  ECHOFUSE_CHECK(tracks_.try_push_back(track));
  return Status::kOk;
}

void PathTracker::report(link::Tracks& tracks) const {
  tracks.tracks.clear();
  for (const TrackState& track : tracks_) {
    const auto& state = track.filter.state();
    const auto& covariance = track.filter.covariance();
    const auto seen = track.misses == 0 ? link::TrackState::kConfirmed : link::TrackState::kSilent;
    ECHOFUSE_CHECK(tracks.tracks.try_push_back(
        {track.id, track.confirmed ? seen : link::TrackState::kUnconfirmed, track.misses, state(0), state(2),
         0.0f, state(1), state(3), 0.0f, covariance(0, 0), covariance(0, 2), covariance(2, 2)}));
  }
}

bool PathTracker::well_formed(Span<const FrameDetection> paths) const {
  int n = 0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const bool first = i == 0 || paths[i].node_index != paths[i - 1].node_index;
    n = first ? 1 : n + 1;
    if (n > static_cast<int>(kMaxDetectionsPerNode) || !std::isfinite(paths[i].path_m)) return false;
    if (paths[i].node_index < 0 || paths[i].node_index >= static_cast<int>(n_receivers_)) return false;
    if (i > 0 && paths[i].node_index < paths[i - 1].node_index) return false;
  }
  return true;
}

/// A silent track comes to rest, and none leaves the room through its walls.
void PathTracker::predict(float dt_s) {
  const float fade =
      config_.silent_velocity_time_s > 0.0f ? std::exp(-dt_s / config_.silent_velocity_time_s) : 0.0f;
  for (TrackState& track : tracks_) {
    const bool silent = track.confirmed && track.misses > 0;
    track.filter.predict(dt_s, config_.acceleration_density_m2ps3, silent ? fade : 1.0f);
    Filter::State state = track.filter.state();
    const auto hold = [&state](int axis, float low, float high) {
      if (state(axis) >= low && state(axis) <= high) return;
      state(axis) = std::clamp(state(axis), low, high);
      state(axis + 1) = 0.0f;
    };
    hold(0, area_.min_x_m, area_.max_x_m);
    hold(2, area_.min_y_m, area_.max_y_m);
    track.filter = {state, track.filter.covariance()};
  }
}

/// The best combinations go first, as long as their traces are free; a track whose traces went takes its next best.
void PathTracker::share_out(bool confirmed) {
  std::array<bool, kMaxTracks> waits{};
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    waits[i] = tracks_[i].confirmed == confirmed;
    if (waits[i]) choices_[i] = best_choice(tracks_[i]);
  }
  for (;;) {
    std::size_t best = tracks_.size();
    for (std::size_t i = 0; i < tracks_.size(); ++i)
      if (waits[i] && choices_[i].distance < (best == tracks_.size() ? kInfinity : choices_[best].distance))
        best = i;
    if (best == tracks_.size()) return;
    if (!all_free(choices_[best].traces)) {
      choices_[best] = best_choice(tracks_[best]);
      continue;
    }
    waits[best] = false;
    for (std::size_t r = 0; r < n_receivers_; ++r)
      if (choices_[best].traces[r] != kNone) owners_[index(r, choices_[best].traces[r])] = tracks_[best].id;
  }
}

bool PathTracker::all_free(const Traces& traces) const {
  for (std::size_t r = 0; r < n_receivers_; ++r)
    if (traces[r] != kNone && owners_[index(r, traces[r])] != 0) return false;
  return true;
}

/// Of all combinations of at least two receivers' free traces within the gate, by depth first search: a combination so far
/// is given up when it is no better than the best one, for a further receiver never makes it less distant.
PathTracker::Choice PathTracker::best_choice(const TrackState& track) {
  const Prediction prediction = predicted(track);
  const auto& covariance = track.filter.covariance();
  std::array<Partial, kMaxArrayReceivers + 1> partials;
  std::array<int, kMaxArrayReceivers + 1> next{};
  partials[0].covariance << config_.common_path_std_m * config_.common_path_std_m, 0.0f, 0.0f,  //
      0.0f, covariance(0, 0), covariance(0, 2),                                                 //
      0.0f, covariance(2, 0), covariance(2, 2);
  Choice best{kInfinity, {}};
  Traces traces;
  traces.fill(kNone);
  for (int level = 0; level >= 0;) {
    const auto receiver = static_cast<std::size_t>(level);
    if (receiver == n_receivers_) {
      best = {partials[receiver].distance, traces};
      --level;
      continue;
    }
    const int trace = next[receiver]++;
    if (trace > n_traces(receiver) || combinations_ >= kMaxTuplesPerFrame) {
      --level;
      continue;
    }
    ++combinations_;
    traces[receiver] = static_cast<std::int8_t>(trace == n_traces(receiver) ? kNone : trace);
    Partial& extended = partials[receiver + 1];
    extended = partials[receiver];
    if (!add(prediction, receiver, traces[receiver], extended)) continue;
    if (!(extended.distance < std::min(best.distance, config_.gate))) continue;
    next[receiver + 1] = 0;
    ++level;
  }
  if (combinations_ >= kMaxTuplesPerFrame) ++dropped_combinations_;
  return best;
}

/// False when it can be no combination.
bool PathTracker::add(const Prediction& prediction, std::size_t receiver, int trace, Partial& partial) const {
  if (trace == kNone) {
    partial.distance += config_.missing_cost;
    return partial.present + static_cast<int>(n_receivers_ - receiver) > 2;
  }
  if (owners_[index(receiver, trace)] != 0) return false;
  const Eigen::Vector2f& gradient = prediction.gradient[receiver];
  const Eigen::Vector3f shown(1.0f, gradient(0), gradient(1));
  const Eigen::Vector3f with_shown = partial.covariance * shown;
  const float variance = shown.dot(with_shown) + config_.path_std_m * config_.path_std_m;
  const float innovation =
      paths_[index(receiver, trace)].path_m - prediction.path_m[receiver] - shown.dot(partial.state);
  partial.distance += innovation * innovation / variance;
  partial.state += with_shown * (innovation / variance);
  partial.covariance -= with_shown * with_shown.transpose() / variance;
  ++partial.present;
  return true;
}

PathTracker::Prediction PathTracker::predicted(const TrackState& track) const {
  const Eigen::Vector2f at = track.filter.position();
  const Point position{at.x(), std::max(at.y(), kMinDepth_m)};
  const AntennaRay tx = antenna_ray(wall_, position, 0.0f);
  Prediction prediction;
  for (std::size_t r = 0; r < n_receivers_; ++r) {
    const AntennaRay path = tx + antenna_ray(wall_, position, rx_x_m_[r]);
    prediction.path_m[r] = path.optical_m;
    prediction.gradient[r] = {path.gradient.x_m, path.gradient.y_m};
  }
  return prediction;
}

/// Their mean first, then the contrasts of Helmert: each receiver against the mean of those before. The noises of all of
/// these are independent, and the common one is in the mean alone.
void PathTracker::take(TrackState& track, const Traces& traces) const {
  const Prediction prediction = predicted(track);
  std::array<float, kMaxArrayReceivers> innovation_m{};
  std::array<Eigen::Vector2f, kMaxArrayReceivers> gradient;
  std::size_t n = 0;
  for (std::size_t r = 0; r < n_receivers_; ++r) {
    if (traces[r] == kNone) continue;
    innovation_m[n] = paths_[index(r, traces[r])].path_m - prediction.path_m[r];
    gradient[n++] = prediction.gradient[r];
  }
  const Eigen::Vector2f before = track.filter.position();
  const float own = config_.path_std_m * config_.path_std_m;
  const float common = config_.common_path_std_m * config_.common_path_std_m;
  for (std::size_t row = 0; row < n; ++row) {
    const std::size_t last = row == 0 ? n - 1 : row;
    const auto k = static_cast<float>(row);
    const float scale = 1.0f / std::sqrt(row == 0 ? static_cast<float>(n) : k * (k + 1.0f));
    Eigen::Vector2f direction = Eigen::Vector2f::Zero();
    float innovation = 0.0f;
    for (std::size_t i = 0; i <= last; ++i) {
      const float weight = scale * (row > 0 && i == row ? -k : 1.0f);
      direction += weight * gradient[i];
      innovation += weight * innovation_m[i];
    }
    innovation -= direction.dot(track.filter.position() - before);
    const float variance = own + (row == 0 ? static_cast<float>(n) * common : 0.0f);
    take_along(track, direction, innovation, variance, row > 0);
  }
}

void PathTracker::take_along(TrackState& track, const Eigen::Vector2f& direction, float innovation_m,
                             float variance_m2, bool cut) const {
  if (cut) {
    const float most = config_.cut_off * std::sqrt(track.filter.variance_along(direction) + variance_m2);
    innovation_m = std::clamp(innovation_m, -most, most);
  }
  track.filter.update_along(direction, innovation_m, variance_m2);
}

/// The free trace that a confirmed track explains best, along its own path.
bool PathTracker::take_lone(TrackState& track) {
  if (!track.confirmed || track.lone >= config_.lone_limit) return false;
  const Prediction prediction = predicted(track);
  const float noise =
      config_.path_std_m * config_.path_std_m + config_.common_path_std_m * config_.common_path_std_m;
  float least = config_.lone_gate;
  std::size_t best_receiver = 0;
  int best_trace = kNone;
  for (std::size_t r = 0; r < n_receivers_; ++r) {
    const float variance = track.filter.variance_along(prediction.gradient[r]) + noise;
    for (int k = 0; k < n_traces(r); ++k) {
      if (owners_[index(r, k)] != 0) continue;
      const float innovation = paths_[index(r, k)].path_m - prediction.path_m[r];
      const float distance = innovation * innovation / variance;
      if (!(distance < least)) continue;
      least = distance;
      best_receiver = r;
      best_trace = k;
    }
  }
  if (best_trace == kNone) return false;
  const std::size_t at = index(best_receiver, best_trace);
  owners_[at] = track.id;
  const float innovation = paths_[at].path_m - prediction.path_m[best_receiver];
  take_along(track, prediction.gradient[best_receiver], innovation, noise, true);
  ++track.lone;
  return true;
}

/// Confirms it, or says that it is dead.
bool PathTracker::lives(TrackState& track, float dt_s) const {
  const std::uint32_t window = config_.confirm_window == kMaxWindow
                                   ? ~std::uint32_t{0}
                                   : (std::uint32_t{1} << config_.confirm_window) - 1u;
  const int n = count_bits(track.updates & window);
  track.confirmed = track.confirmed || n >= config_.confirm_updates;
  if (track.confirmed) return !(track.silent_time_s > config_.silent_time_s + 0.5f * dt_s);
  return track.age - n <= config_.confirm_window - config_.confirm_updates;
}

/// Two tracks of one person.
bool PathTracker::same(const TrackState& one, const TrackState& other) const {
  if (!one.confirmed || !other.confirmed) return false;
  const Filter::State apart = one.filter.state() - other.filter.state();
  const float distance = std::sqrt(apart(0) * apart(0) + apart(2) * apart(2));
  const float speed = std::sqrt(apart(1) * apart(1) + apart(3) * apart(3));
  return distance < config_.merge_distance_m && speed < config_.merge_speed_mps;
}

}  // namespace echofuse::hub
