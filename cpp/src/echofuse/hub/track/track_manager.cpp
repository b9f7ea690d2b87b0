#include "echofuse/hub/track/track_manager.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/estimation/assignment.hpp"
#include "report_tracks.hpp"

namespace echofuse::hub {
namespace {

using estimation::kUnassigned;
using link::TrackState;

bool within(float value, float least, float most) { return value >= least && value <= most; }

}  // namespace

const char* invalid_field(const TrackManagerConfig& config) {
  constexpr float kMost = 1e6f;
  if (config.association != AssociationRule::kPerPair &&
      config.association != AssociationRule::kHypothesisCost)
    return "association";
  if (config.update != TrackUpdate::kEstimate && config.update != TrackUpdate::kKalman) return "update";
  if (!within(config.gate_m, 1e-6f, kMost)) return "gate_m";
  if (!within(config.cost_max_m, 0.0f, kMost)) return "cost_max_m";
  if (!within(config.gate_sigma, 0.0f, kMost)) return "gate_sigma";
  if (!within(config.silent_gate_growth_mps, 0.0f, kMost)) return "silent_gate_growth_mps";
  if (!within(config.silent_gate_max_m, 0.0f, kMost)) return "silent_gate_max_m";
  if (!within(config.birth_exclusion_m, 0.0f, kMost)) return "birth_exclusion_m";
  if (config.confirm_updates < 1 || config.confirm_updates > 10000) return "confirm_updates";
  if (!within(config.silent_time_min_s, 0.0f, kMost)) return "silent_time_min_s";
  if (!within(config.silent_time_per_confirmed, 0.0f, kMost)) return "silent_time_per_confirmed";
  if (!within(config.silent_time_max_s, 0.0f, kMost)) return "silent_time_max_s";
  if (!within(config.silent_velocity_time_s, 0.0f, kMost)) return "silent_velocity_time_s";
  if (!within(config.acceleration_density_m2ps3, 0.0f, kMost)) return "acceleration_density_m2ps3";
  if (!within(config.measurement_std_m, 1e-3f, 1e3f)) return "measurement_std_m";
  if (!within(config.velocity_std_mps, 1e-3f, 1e3f)) return "velocity_std_mps";
  return nullptr;
}

template <int kDimension>
Status TrackManager<kDimension>::configure(const TrackManagerConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  reset();
  return Status::kOk;
}

template <int kDimension>
void TrackManager<kDimension>::reset() {
  tracks_.clear();
  next_id_ = 1;
  dropped_births_ = 0;
  n_associated_ = 0;
}

template <int kDimension>
Status TrackManager<kDimension>::process(Span<const Estimate> points, float dt_s, link::Tracks& tracks) {
  tracks.tracks.clear();
  if (!configured_) return Status::kNotConfigured;
  if (!(dt_s > 0.0f) || !std::isfinite(dt_s)) return Status::kInvalidInput;
  for (const Estimate& point : points)
    if (!point.position_m.allFinite() || !point.velocity_mps.allFinite() || !point.covariance_m2.allFinite())
      return Status::kInvalidInput;
  bool truncated = points.size() > kMaxAssignment;
  const auto used = points.first(std::min(points.size(), kMaxAssignment));

  for (ManagedTrack& track : tracks_) predict(track, dt_s);
  associate(used);
  std::array<bool, kMaxAssignment> taken{};
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n_associated_; ++i) {
    const int point = point_of_track_[i];
    if (point != kUnassigned) taken[static_cast<std::size_t>(point)] = true;
    const bool alive = point == kUnassigned ? miss(tracks_[i], dt_s)
                                            : hit(tracks_[i], used[static_cast<std::size_t>(point)], dt_s);
    if (alive) tracks_[kept++] = tracks_[i];
  }
  (void)tracks_.resize_within(kept);
  for (std::size_t p = 0; p < used.size(); ++p)
    if (!taken[p] && !begin(used[p])) truncated = true;
  report(tracks);
  return truncated ? Status::kTruncated : Status::kOk;
}

template <int kDimension>
void TrackManager<kDimension>::predict(ManagedTrack& track, float dt_s) const {
  float decay = 1.0f;
  if (track.state == TrackState::kSilent)
    decay = config_.silent_velocity_time_s / (config_.silent_velocity_time_s + dt_s);
  track.motion *= decay;
  track.filter.predict(dt_s, config_.acceleration_density_m2ps3 * track.motion, decay);
}

template <int kDimension>
void TrackManager<kDimension>::associate(Span<const Estimate> points) {
  n_associated_ = tracks_.size();
  std::fill_n(point_of_track_.begin(), n_associated_, kUnassigned);
  if (tracks_.empty() || points.empty()) return;
  if (config_.association == AssociationRule::kPerPair)
    associate_per_pair(points);
  else
    associate_by_hypothesis(points);
}

/// A pair costs its distance, at most the track's gate; a pair at the gate is none. So the assignment weighs
/// a far pair against no pair at all.
template <int kDimension>
void TrackManager<kDimension>::associate_per_pair(Span<const Estimate> points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const float gate = gate_m(tracks_[i]);
    for (std::size_t p = 0; p < n; ++p) {
      const float distance = distance_m(tracks_[i], points[p]);
      const bool allowed = distance < gate && within_sigma(tracks_[i], points[p]);
      cost_[i * n + p] = allowed ? distance : gate;
    }
  }
  const Status status = estimation::assign({cost_.data(), tracks_.size() * n}, tracks_.size(), n,
                                           {point_of_track_.data(), n_associated_});
  ECHOFUSE_CHECK(status == Status::kOk);
  for (std::size_t i = 0; i < n_associated_; ++i) {
    int& point = point_of_track_[i];
    if (point == kUnassigned) continue;
    if (cost_[i * n + static_cast<std::size_t>(point)] >= gate_m(tracks_[i])) point = kUnassigned;
  }
}

template <int kDimension>
void TrackManager<kDimension>::associate_by_hypothesis(Span<const Estimate> points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    for (std::size_t p = 0; p < n; ++p) cost_[i * n + p] = distance_m(tracks_[i], points[p]);
  const Status status = estimation::assign({cost_.data(), tracks_.size() * n}, tracks_.size(), n,
                                           {point_of_track_.data(), n_associated_});
  ECHOFUSE_CHECK(status == Status::kOk);
  float total = 0.0f;
  for (std::size_t i = 0; i < n_associated_; ++i)
    if (point_of_track_[i] != kUnassigned)
      total += cost_[i * n + static_cast<std::size_t>(point_of_track_[i])];
  const auto n_pairs = static_cast<float>(std::min(n_associated_, n));
  if (total <= config_.cost_max_m * n_pairs) return;
  for (std::size_t i = 0; i < n_associated_; ++i) {
    int& point = point_of_track_[i];
    if (point == kUnassigned) continue;
    const auto p = static_cast<std::size_t>(point);
    if (cost_[i * n + p] >= gate_m(tracks_[i]) || !within_sigma(tracks_[i], points[p])) point = kUnassigned;
  }
}

template <int kDimension>
float TrackManager<kDimension>::distance_m(const ManagedTrack& track, const Estimate& point) {
  return (point.position_m - track.filter.position()).norm();
}

template <int kDimension>
float TrackManager<kDimension>::gate_m(const ManagedTrack& track) const {
  const float grown = config_.gate_m + config_.silent_gate_growth_mps * track.silent_time_s;
  return std::max(config_.gate_m, std::min(grown, config_.silent_gate_max_m));
}

template <int kDimension>
bool TrackManager<kDimension>::within_sigma(const ManagedTrack& track, const Estimate& point) const {
  if (config_.update == TrackUpdate::kEstimate || config_.gate_sigma == 0.0f) return true;
  const float squared = track.filter.squared_distance(point.position_m, measurement_covariance());
  return squared < config_.gate_sigma * config_.gate_sigma;
}

template <int kDimension>
bool TrackManager<kDimension>::hit(ManagedTrack& track, const Estimate& point, float dt_s) const {
  if (config_.update == TrackUpdate::kKalman)
    track.filter.update(point.position_m, measurement_covariance());
  else
    track.filter = filter_of(point);
  track.frames_since_update = 0;
  track.silent_time_s = 0.0f;
  track.motion = 1.0f;
  if (track.state == TrackState::kUnconfirmed) {
    if (++track.updates < config_.confirm_updates) return true;
  } else {
    track.confirmed_time_s += dt_s;
  }
  track.state = TrackState::kConfirmed;
  return true;
}

/// False when the track dies of this frame without a point. Times are multiples of the frame's duration, so
/// they are compared half a frame apart.
template <int kDimension>
bool TrackManager<kDimension>::miss(ManagedTrack& track, float dt_s) const {
  if (track.state == TrackState::kUnconfirmed) return false;
  track.state = TrackState::kSilent;
  ++track.frames_since_update;
  track.silent_time_s += dt_s;
  const float earned = config_.silent_time_per_confirmed * track.confirmed_time_s;
  const float limit = std::min(std::max(earned, config_.silent_time_min_s), config_.silent_time_max_s);
  return track.silent_time_s <= limit + 0.5f * dt_s;
}

/// False when there is no room for a track that should begin.
template <int kDimension>
bool TrackManager<kDimension>::begin(const Estimate& point) {
  for (const ManagedTrack& track : tracks_)
    if (distance_m(track, point) < config_.birth_exclusion_m) return true;
  ManagedTrack track;
  track.id = next_id_;
  if (config_.confirm_updates <= 1) track.state = TrackState::kConfirmed;
  track.filter = filter_of(point);
  if (!tracks_.try_push_back(track)) {
    ++dropped_births_;
    return false;
  }
  ++next_id_;
  return true;
}

template <int kDimension>
typename TrackManager<kDimension>::Filter TrackManager<kDimension>::filter_of(const Estimate& point) const {
  return Filter::at(point.position_m, point.covariance_m2, point.velocity_mps, config_.velocity_std_mps);
}

/// Of a bare point.
template <int kDimension>
typename TrackManager<kDimension>::Filter::PositionCovariance
TrackManager<kDimension>::measurement_covariance() const {
  return Filter::PositionCovariance::Identity() * (config_.measurement_std_m * config_.measurement_std_m);
}

template <int kDimension>
void TrackManager<kDimension>::report(link::Tracks& tracks) const {
  for (const ManagedTrack& track : tracks_)
    ECHOFUSE_CHECK(tracks.tracks.try_push_back(
        to_message(track.id, track.state, track.frames_since_update, track.filter)));
}

template class TrackManager<2>;
template class TrackManager<3>;

}  // namespace echofuse::hub
