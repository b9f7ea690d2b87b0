#include "echofuse/hub/track/range_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "echofuse/core/check.hpp"
#include "report_tracks.hpp"

namespace echofuse::hub {
namespace {

using Filter = estimation::ConstantVelocityFilter<2>;

constexpr float kOutside_m = 0.2f;      ///< [m] a track may leave the area by so much
constexpr float kDouble_m = 0.3f;       ///< [m] two confirmed tracks nearer than this
constexpr float kDouble_mps = 0.7f;     ///< [m/s] and alike in velocity are one person
constexpr float kBirthShare = 0.5f;     ///< [1] of a birth's score that it keeps: the place was chosen for it
constexpr float kDemotedScore = 30.0f;  ///< [1] of a track that is confirmed no more: it may come back
constexpr float kLeastSureness = 0.05f;                          ///< [1] a less sure detection moves nobody
constexpr int kNewestOnly = static_cast<int>(kMaxWindowFrames);  ///< [frame] an age: nothing to be filled in
constexpr int kMaxBirthPlaces = 24;                              ///< [1] looked at in a frame

Point place_of(const Filter& filter) {
  const Eigen::Vector2f at = filter.position();
  return {at.x(), at.y()};
}

bool within(float value, float least, float most) { return value >= least && value <= most; }

}  // namespace

Status RangeTracker::configure(const RangeTrackerConfig& config, float body_radius_m,
                               Span<const NodeSite> nodes, const Area& area) {
  if (invalid_field(config) != nullptr || !(body_radius_m >= 0.0f)) return Status::kInvalidConfig;
  if (nodes.size() > kMaxNodes || invalid_site(nodes, area) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  n_nodes_ = nodes.size();
  area_ = area;
  likelihood_.configure(config, body_radius_m, nodes);
  search_.configure(config);
  births_.configure(config, area, n_nodes_);
  lone_ = LoneScore(config);
  configured_ = true;
  reset();
  return Status::kOk;
}

void RangeTracker::reset() {
  likelihood_.reset();
  tracks_.clear();
  next_id_ = 1;
  dropped_births_ = 0;
}

Status RangeTracker::process(Span<const FrameDetection> detections, float dt_s, link::Tracks& tracks) {
  tracks.tracks.clear();
  if (!configured_) return Status::kNotConfigured;
  if (!(dt_s > 0.0f) || !std::isfinite(dt_s) || !well_formed(detections)) return Status::kInvalidInput;
  likelihood_.add_frame(detections, dt_s);
  predict(dt_s);
  update_confirmed();
  advance();
  choose_people();
  const bool all_began = begin_tracks();
  report(tracks);
  show_tracks<2>(sink_, tracks);
  return all_began ? Status::kOk : Status::kTruncated;
}

bool RangeTracker::well_formed(Span<const FrameDetection> detections) const {
  if (detections.size() > kMaxFrameDetections) return false;
  int node = 0;
  float path = 0.0f;
  std::size_t of_node = 0;
  for (const FrameDetection& detection : detections) {
    if (detection.node_index < node || detection.node_index >= static_cast<int>(n_nodes_)) return false;
    if (detection.node_index > node) {
      path = 0.0f;
      of_node = 0;
    }
    if (!(detection.path_m >= path && std::isfinite(detection.path_m))) return false;
    if (++of_node > kMaxDetectionsPerNode) return false;
    node = detection.node_index;
    path = detection.path_m;
  }
  return true;
}

/// Moves all tracks, and puts them in order: confirmed ones as they were, then the others by score.
void RangeTracker::predict(float dt_s) {
  for (RangeTrack& track : tracks_) track.filter.predict(dt_s, config_.acceleration_density_m2ps3);
  const auto before = [](const RangeTrack& a, const RangeTrack& b) {
    if (a.confirmed != b.confirmed) return a.confirmed;
    return !a.confirmed && a.score > b.score;
  };
  for (std::size_t i = 1; i < tracks_.size(); ++i)  // insertion: stable, and they are nearly in order
    for (std::size_t j = i; j > 0 && before(tracks_[j], tracks_[j - 1]); --j)
      std::swap(tracks_[j], tracks_[j - 1]);
}

/// Confirmed tracks share out the detections of each node, and follow theirs the more the surer it is.
void RangeTracker::update_confirmed() {
  BoundedVector<const Trail*, kMaxTargets> people;
  for (RangeTrack& track : tracks_) {
    if (!track.confirmed) break;
    likelihood_.lay(track.filter, kNewestOnly, track.trail);
    track.n_own = 0;
    ECHOFUSE_CHECK(people.try_push_back(&track.trail));
  }
  const float noise = config_.path_std_m * config_.path_std_m;
  std::array<float, kMaxTargets> stds_m{};
  std::array<PeopleLikelihood::Claim, kMaxTargets> claims;
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    for (std::size_t i = 0; i < people.size(); ++i) {
      Point gradient;
      (void)likelihood_.visible_path(place_of(tracks_[i].filter), node, &gradient);
      stds_m[i] = std::sqrt(tracks_[i].filter.variance_along({gradient.x_m, gradient.y_m}) + noise);
    }
    likelihood_.claim({people.data(), people.size()}, {stds_m.data(), people.size()}, node,
                      {claims.data(), people.size()});
    for (std::size_t i = 0; i < people.size(); ++i) {
      if (claims[i].detection < 0 || claims[i].sureness < kLeastSureness) continue;
      RangeTrack& track = tracks_[i];
      Point gradient;
      const float path = likelihood_.visible_path(place_of(track.filter), node, &gradient);
      if (path < 0.0f) continue;
      const float measured = likelihood_.paths(node)[static_cast<std::size_t>(claims[i].detection)];
      track.filter.update_along({gradient.x_m, gradient.y_m}, measured - path,
                                noise / (claims[i].sureness * claims[i].sureness));
      ++track.n_own;
    }
  }
}

/// Updates an unconfirmed track by each node's nearest detection; its score in this frame.
float RangeTracker::follow(RangeTrack& track) const {
  const float noise = config_.path_std_m * config_.path_std_m;
  float score = 0.0f;
  track.n_own = 0;
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    Point gradient;
    const float path = likelihood_.visible_path(place_of(track.filter), node, &gradient);
    if (path < 0.0f) continue;
    const Span<const float> paths = likelihood_.paths(node);
    const int own = nearest(paths, path, config_.gate_m);
    if (own < 0) {
      score += lone_.missed;
      continue;
    }
    const Eigen::Vector2f direction(gradient.x_m, gradient.y_m);
    const float std_m = std::sqrt(track.filter.variance_along(direction) + noise);
    const float error = paths[static_cast<std::size_t>(own)] - path;
    score += lone_(error, std_m, std::log(std_m));
    track.filter.update_along(direction, error, noise);
    ++track.n_own;
  }
  return score;
}

/// It is a person's place and, while it is unconfirmed, speed and score.
bool RangeTracker::lives(const RangeTrack& track) const {
  const Point at = place_of(track.filter);
  if (!within(at.x_m, area_.min_x_m - kOutside_m, area_.max_x_m + kOutside_m)) return false;
  if (!within(at.y_m, area_.min_y_m - kOutside_m, area_.max_y_m + kOutside_m)) return false;
  if (track.confirmed) return true;
  return track.score >= config_.drop_score && track.filter.velocity().norm() <= config_.max_speed_mps;
}

/// Is a better track the same person.
bool RangeTracker::crowded(std::size_t index) const {
  const RangeTrack& track = tracks_[index];
  for (std::size_t i = 0; i < index; ++i) {
    const RangeTrack& better = tracks_[i];
    const float distance = (better.filter.position() - track.filter.position()).norm();
    if (!track.confirmed && distance < config_.merge_distance_m) return true;
    const float apart_mps = (better.filter.velocity() - track.filter.velocity()).norm();
    if (track.confirmed && distance < kDouble_m && apart_mps < kDouble_mps) return true;
  }
  return false;
}

/// Unconfirmed tracks follow what is nearest; who is no person, or one twice, ends.
void RangeTracker::advance() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    RangeTrack& track = tracks_[i];
    if (!track.confirmed) track.score = config_.candidate_memory * track.score + follow(track);
    ++track.age;
    track.frames_since_update = track.n_own >= config_.silent_nodes ? 0 : track.frames_since_update + 1;
    if (!lives(track)) continue;
    if (kept != i) tracks_[kept] = track;
    if (crowded(kept)) continue;
    ++kept;
  }
  (void)tracks_.resize_within(kept);
}

/// Confirmed is the set of tracks that explains the window best.
void RangeTracker::choose_people() {
  BoundedVector<Candidate, kMaxTracks> candidates;
  std::array<std::size_t, kMaxTracks> index{};
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    RangeTrack& track = tracks_[i];
    const bool eligible = track.confirmed || track.age >= config_.confirm_frames;
    likelihood_.lay(track.filter, eligible ? track.age : kNewestOnly, track.trail);
    if (!eligible) continue;
    index[candidates.size()] = i;
    ECHOFUSE_CHECK(candidates.try_push_back({&track.trail, track.confirmed}));
  }
  std::array<bool, kMaxTracks> there{};
  search_.process(likelihood_, {candidates.data(), candidates.size()}, {there.data(), candidates.size()});
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    RangeTrack& track = tracks_[index[i]];
    if (track.confirmed && !there[i]) track.score = kDemotedScore;
    track.confirmed = there[i];
  }
}

/// At the places that fit best; false when there was no room for one.
bool RangeTracker::begin_tracks() {
  BoundedVector<RangeBirths::Place, kMaxBirthPlaces> places;
  births_.process(likelihood_, places);
  const std::size_t before = tracks_.size();
  bool all_began = true;
  for (const RangeBirths::Place& place : places) {
    if (tracks_.size() - before >= static_cast<std::size_t>(config_.max_births)) break;
    if (!begin_at(place.at)) all_began = false;
  }
  return all_began;
}

/// False when there is no room for a track that should begin.
bool RangeTracker::begin_at(const Point& place) {
  const Eigen::Vector2f at(place.x_m, place.y_m);
  for (const RangeTrack& track : tracks_)
    if ((track.filter.position() - at).norm() < config_.birth_exclusion_m) return true;
  const float variance_m2 = config_.newborn_position_std_m * config_.newborn_position_std_m;
  RangeTrack track;
  track.filter = Filter::at(at, variance_m2 * Eigen::Matrix2f::Identity(), Eigen::Vector2f::Zero(),
                            config_.newborn_velocity_std_mps);
  const float score = follow(track);
  if (!(score >= config_.birth_score) || track.n_own == 0) return true;  // 0: where all nodes are blind
  track.score = kBirthShare * score;
  track.id = next_id_;
  likelihood_.lay(track.filter, kNewestOnly, track.trail);
  if (!tracks_.try_push_back(track)) {
    ++dropped_births_;
    return false;
  }
  ++next_id_;
  return true;
}

void RangeTracker::report(link::Tracks& tracks) const {
  for (const RangeTrack& track : tracks_) {
    link::TrackState state = link::TrackState::kUnconfirmed;
    if (track.confirmed)
      state = track.frames_since_update == 0 ? link::TrackState::kConfirmed : link::TrackState::kSilent;
    ECHOFUSE_CHECK(
        tracks.tracks.try_push_back(to_message(track.id, state, track.frames_since_update, track.filter)));
    for (std::size_t i = tracks.tracks.size() - 1; i > 0 && tracks.tracks[i].id < tracks.tracks[i - 1].id;
         --i)
      std::swap(tracks.tracks[i], tracks.tracks[i - 1]);
  }
}

}  // namespace echofuse::hub
