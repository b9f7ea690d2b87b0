#include "echofuse/hub/track/path_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echofuse/hub/locate/line_locator.hpp"
#include "echofuse/hub/locate/taylor_3d.hpp"
#include "report_tracks.hpp"

namespace echofuse::hub {
namespace {

constexpr float kMinDepth_m = 0.02f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kMaxWindow = 32;           ///< bits of the updates
constexpr float kGrowthBegins_m = 4.0f;  ///< [m] of a mean path

bool positive(float value) { return value > 0.0f && std::isfinite(value); }
bool not_negative(float value) { return value >= 0.0f && std::isfinite(value); }

template <int kDimension>
bool possible(Span<const Eigen::Matrix<float, kDimension, 1>> rx_m) {
  if (rx_m.size() < static_cast<std::size_t>(kDimension) || rx_m.size() > kMaxArrayReceivers) return false;
  for (std::size_t i = 0; i < rx_m.size(); ++i) {
    if (!rx_m[i].allFinite() || rx_m[i](1) != 0.0f || rx_m[i].isZero(0.0f)) return false;
    for (std::size_t k = 0; k < i; ++k)
      if (rx_m[i] == rx_m[k]) return false;
  }
  return true;
}

/// The second derivative of an antenna's ray by the position, times a vector: how the gradient, a unit vector in air, turns
/// when the position moves. With q the tangent of its angle, along the wall that is by cos^3 / (d lateral / d q) a metre,
/// and about the antenna's normal by sin / lateral. offset_m: position less antenna.
Eigen::Vector3f turned(const Wall& wall, const Eigen::Vector3f& offset_m, const Eigen::Vector3f& gradient,
                       const Eigen::Vector3f& by) {
  const float sine = std::sqrt(gradient(0) * gradient(0) + gradient(2) * gradient(2));
  const float cosine = gradient(1);
  const float lateral_m = std::sqrt(offset_m(0) * offset_m(0) + offset_m(2) * offset_m(2));
  const float per_spread = cosine / wall.spread_m({0.0f, sine, cosine}, offset_m(1));
  const float per_lateral = lateral_m > 0.0f ? sine / lateral_m : per_spread;
  const float per_sine = sine > 0.0f ? 1.0f / sine : 0.0f;
  const Eigen::Vector3f outwards(gradient(0) * per_sine, 0.0f, gradient(2) * per_sine);
  const Eigen::Vector3f steeper(cosine * outwards(0), -sine, cosine * outwards(2));
  const Eigen::Vector3f along_wall(by(0), 0.0f, by(2));
  return (per_spread * steeper.dot(by)) * steeper + per_lateral * (along_wall - outwards.dot(by) * outwards);
}

int count_bits(std::uint32_t bits) {
  int n = 0;
  for (; bits != 0; bits &= bits - 1) ++n;
  return n;
}

}  // namespace

const char* invalid_field(const PathTrackerConfig& config) {
  if (!positive(config.acceleration_density_m2ps3)) return "acceleration_density_m2ps3";
  if (!not_negative(config.turn_density_m2ps3)) return "turn_density_m2ps3";
  if (!(config.turn_begin_probability > 0.0f && config.turn_begin_probability < 1.0f))
    return "turn_begin_probability";
  if (!(config.turn_end_probability > 0.0f && config.turn_end_probability < 1.0f)) return "turn_end_probability";
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
  if (!not_negative(config.path_std_growth)) return "path_std_growth";
  if (!not_negative(config.body_half_height_m)) return "body_half_height_m";
  return nullptr;
}

template <int kDimension>
Status PathTracker<kDimension>::configure(const PathTrackerConfig& config, const WallConfig& wall,
                                          Span<const Vector> rx_m, const Vector& least_m,
                                          const Vector& most_m, float body_radius_m) {
  if (invalid_field(config) != nullptr || invalid_field(wall) != nullptr) return Status::kInvalidConfig;
  if (!possible<kDimension>(rx_m) || !(body_radius_m >= 0.0f && std::isfinite(body_radius_m)))
    return Status::kInvalidConfig;
  for (int axis = 0; axis < kDimension; ++axis)
    if (!(std::isfinite(least_m(axis)) && most_m(axis) > least_m(axis) && std::isfinite(most_m(axis))))
      return Status::kInvalidConfig;
  if (!(least_m(1) > 0.0f)) return Status::kInvalidConfig;
  (void)wall_.configure(wall);
  config_ = config;
  least_m_ = least_m;
  most_m_ = most_m;
  if constexpr (kDimension == 3) {
    const float half_height_m = config.body_half_height_m > 0.0f ? config.body_half_height_m : body_radius_m;
    body_radius_m_ = body_radius_m;
    body_m2_ = Vector(body_radius_m, body_radius_m, half_height_m).cwiseAbs2();
  }
  n_receivers_ = rx_m.size();
  std::copy(rx_m.begin(), rx_m.end(), rx_m_.begin());
  reset();
  return Status::kOk;
}

template <int kDimension>
void PathTracker<kDimension>::reset() {
  tracks_.clear();
  next_id_ = 1;
  dropped_births_ = 0;
  dropped_combinations_ = 0;
}

template <int kDimension>
Status PathTracker<kDimension>::update(Span<const FrameDetection> paths, float dt_s,
                                       Span<std::int32_t> owners) {
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

template <int kDimension>
Status PathTracker<kDimension>::begin(const Vector& position_m, const PositionCovariance& covariance_m2) {
  if (n_receivers_ == 0) return Status::kNotConfigured;
  for (const TrackState& track : tracks_)
    if ((track.filter.position() - position_m).norm() < config_.birth_exclusion_m) return Status::kOk;
  if (tracks_.size() >= static_cast<std::size_t>(config_.max_tracks)) {
    ++dropped_births_;
    return Status::kTruncated;
  }
  const float shared = config_.common_path_std_m * config_.common_path_std_m / 4.0f;
  TrackState track;
  track.id = next_id_++;
  track.confirmed = config_.confirm_updates <= 1;
  const PositionCovariance covariance_here_m2 = covariance_m2 + shared * PositionCovariance::Identity();
  track.filter = {Filter::Filter::at(position_m, covariance_here_m2, Vector::Zero(), config_.velocity_std_mps),
                  config_.turn_density_m2ps3 > 0.0f};
  ECHOFUSE_CHECK(tracks_.try_push_back(track));
  return Status::kOk;
}

template <int kDimension>
void PathTracker<kDimension>::report(link::Tracks& tracks) const {
  tracks.tracks.clear();
  for (const TrackState& track : tracks_) {
    const auto seen = track.misses == 0 ? link::TrackState::kConfirmed : link::TrackState::kSilent;
    ECHOFUSE_CHECK(tracks.tracks.try_push_back(to_message(
        track.id, track.confirmed ? seen : link::TrackState::kUnconfirmed, track.misses, track.filter.mixture())));
  }
}

template <int kDimension>
bool PathTracker<kDimension>::well_formed(Span<const FrameDetection> paths) const {
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
template <int kDimension>
void PathTracker<kDimension>::predict(float dt_s) {
  const float fade =
      config_.silent_velocity_time_s > 0.0f ? std::exp(-dt_s / config_.silent_velocity_time_s) : 0.0f;
  const estimation::TurningMotion motion{config_.acceleration_density_m2ps3, config_.turn_density_m2ps3,
                                         config_.turn_begin_probability, config_.turn_end_probability};
  for (TrackState& track : tracks_) {
    const bool silent = track.confirmed && track.misses > 0;
    track.filter.predict(dt_s, motion, silent ? fade : 1.0f);
    for (int axis = 0; axis < kDimension; ++axis) track.filter.hold(axis, least_m_(axis), most_m_(axis));
  }
}

/// The best combinations go first, as long as their traces are free; a track whose traces went takes its next best.
template <int kDimension>
void PathTracker<kDimension>::share_out(bool confirmed) {
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

template <int kDimension>
bool PathTracker<kDimension>::all_free(const Traces& traces) const {
  for (std::size_t r = 0; r < n_receivers_; ++r)
    if (traces[r] != kNone && owners_[index(r, traces[r])] != 0) return false;
  return true;
}

/// Of all combinations of at least two receivers' free traces within the gate, by depth first search: a combination so far
/// is given up when it is no better than the best one, for a further receiver never makes it less distant.
template <int kDimension>
typename PathTracker<kDimension>::Choice PathTracker<kDimension>::best_choice(const TrackState& track) {
  const Prediction prediction = predicted(track);
  const auto& covariance = track.filter.covariance();
  std::array<Partial, kMaxArrayReceivers + 1> partials;
  std::array<int, kMaxArrayReceivers + 1> next{};
  partials[0].covariance.setZero();
  partials[0].covariance(0, 0) = prediction.common_m2;
  for (int row = 0; row < kDimension; ++row)
    for (int column = 0; column < kDimension; ++column)
      partials[0].covariance(1 + row, 1 + column) = covariance(2 * row, 2 * column);
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
template <int kDimension>
bool PathTracker<kDimension>::add(const Prediction& prediction, std::size_t receiver, int trace,
                                  Partial& partial) const {
  if (trace == kNone) {
    partial.distance += config_.missing_cost;
    return partial.present + static_cast<int>(n_receivers_ - receiver) > 2;
  }
  if (owners_[index(receiver, trace)] != 0) return false;
  typename Partial::State shown;
  shown << 1.0f, prediction.gradient[receiver];
  const typename Partial::State with_shown = partial.covariance * shown;
  const float variance = shown.dot(with_shown) + prediction.own_m2;
  const float innovation =
      paths_[index(receiver, trace)].path_m - prediction.path_m[receiver] - shown.dot(partial.state);
  partial.distance += innovation * innovation / variance;
  partial.state += with_shown * (innovation / variance);
  partial.covariance -= with_shown * with_shown.transpose() / variance;
  ++partial.present;
  return true;
}

template <int kDimension>
typename PathTracker<kDimension>::Prediction PathTracker<kDimension>::predicted(
    const TrackState& track) const {
  Vector position = track.filter.position();
  position(1) = std::max(position(1), kMinDepth_m);
  const Leg tx = leg(position, Vector::Zero());
  Prediction prediction;
  for (std::size_t r = 0; r < n_receivers_; ++r) {
    const Leg rx = leg(position, rx_m_[r]);
    prediction.path_m[r] = tx.optical_m + rx.optical_m;
    prediction.gradient[r] = tx.gradient + rx.gradient;
  }
  if constexpr (kDimension == 3) {
    for (std::size_t r = 0; r < n_receivers_ && body_radius_m_ > 0.0f; ++r) {
      Vector& gradient = prediction.gradient[r];
      const Vector rx_gradient = gradient - tx.gradient;
      Vector by = body_m2_.cwiseProduct(gradient);
      const float support_m = std::sqrt(gradient.dot(by));
      by /= support_m;
      prediction.path_m[r] += 2.0f * body_radius_m_ - support_m;
      gradient -=
          turned(wall_, position, tx.gradient, by) + turned(wall_, position - rx_m_[r], rx_gradient, by);
    }
  }
  float sum_m = 0.0f;
  for (std::size_t r = 0; r < n_receivers_; ++r) sum_m += prediction.path_m[r];
  const float beyond_m = std::max(sum_m / static_cast<float>(n_receivers_) - kGrowthBegins_m, 0.0f);
  const float growth = 1.0f + config_.path_std_growth * beyond_m;
  const float own_m = growth * config_.path_std_m;
  const float common_m = growth * config_.common_path_std_m;
  prediction.own_m2 = own_m * own_m;
  prediction.common_m2 = common_m * common_m;
  return prediction;
}

template <int kDimension>
typename PathTracker<kDimension>::Leg PathTracker<kDimension>::leg(const Vector& position,
                                                                   const Vector& antenna) const {
  if constexpr (kDimension == 2) {
    const AntennaRay ray = antenna_ray(wall_, {position(0), position(1)}, antenna(0));
    return {ray.optical_m, {ray.gradient.x_m, ray.gradient.y_m}};
  } else {
    const AntennaRay3d ray =
        antenna_ray_3d(wall_, {position(0), position(1), position(2)}, {antenna(0), antenna(1), antenna(2)});
    return {ray.optical_m, {ray.gradient.x_m, ray.gradient.y_m, ray.gradient.z_m}};
  }
}

/// Their mean first, then the contrasts of Helmert: each receiver against the mean of those before. The noises of all of
/// these are independent, and the common one is in the mean alone.
template <int kDimension>
void PathTracker<kDimension>::take(TrackState& track, const Traces& traces) const {
  const Prediction prediction = predicted(track);
  std::array<float, kMaxArrayReceivers> innovation_m{};
  std::array<Vector, kMaxArrayReceivers> gradient;
  std::size_t n = 0;
  for (std::size_t r = 0; r < n_receivers_; ++r) {
    if (traces[r] == kNone) continue;
    innovation_m[n] = paths_[index(r, traces[r])].path_m - prediction.path_m[r];
    gradient[n++] = prediction.gradient[r];
  }
  const Vector before = track.filter.position();
  for (std::size_t row = 0; row < n; ++row) {
    const std::size_t last = row == 0 ? n - 1 : row;
    const auto k = static_cast<float>(row);
    const float scale = 1.0f / std::sqrt(row == 0 ? static_cast<float>(n) : k * (k + 1.0f));
    Vector direction = Vector::Zero();
    float innovation = 0.0f;
    for (std::size_t i = 0; i <= last; ++i) {
      const float weight = scale * (row > 0 && i == row ? -k : 1.0f);
      direction += weight * gradient[i];
      innovation += weight * innovation_m[i];
    }
    innovation -= direction.dot(track.filter.position() - before);
    const float variance =
        prediction.own_m2 + (row == 0 ? static_cast<float>(n) * prediction.common_m2 : 0.0f);
    take_along(track, direction, innovation, variance, row > 0);
  }
}

template <int kDimension>
void PathTracker<kDimension>::take_along(TrackState& track, const Vector& direction, float innovation_m,
                                         float variance_m2, bool cut) const {
  if (cut) {
    const float most = config_.cut_off * std::sqrt(track.filter.variance_along(direction) + variance_m2);
    innovation_m = std::clamp(innovation_m, -most, most);
  }
  track.filter.update_along(direction, innovation_m, variance_m2);
}

/// The free trace that a confirmed track explains best, along its own path.
template <int kDimension>
bool PathTracker<kDimension>::take_lone(TrackState& track) {
  if (!track.confirmed || track.lone >= config_.lone_limit) return false;
  const Prediction prediction = predicted(track);
  const float noise = prediction.own_m2 + prediction.common_m2;
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
template <int kDimension>
bool PathTracker<kDimension>::lives(TrackState& track, float dt_s) const {
  const std::uint32_t window = config_.confirm_window == kMaxWindow
                                   ? ~std::uint32_t{0}
                                   : (std::uint32_t{1} << config_.confirm_window) - 1u;
  const int n = count_bits(track.updates & window);
  track.confirmed = track.confirmed || n >= config_.confirm_updates;
  if (track.confirmed) return !(track.silent_time_s > config_.silent_time_s + 0.5f * dt_s);
  return track.age - n <= config_.confirm_window - config_.confirm_updates;
}

/// Two tracks of one person.
template <int kDimension>
bool PathTracker<kDimension>::same(const TrackState& one, const TrackState& other) const {
  if (!one.confirmed || !other.confirmed) return false;
  const float distance = (one.filter.position() - other.filter.position()).norm();
  const float speed = (one.filter.velocity() - other.filter.velocity()).norm();
  return distance < config_.merge_distance_m && speed < config_.merge_speed_mps;
}

template class PathTracker<2>;
template class PathTracker<3>;

}  // namespace echofuse::hub
