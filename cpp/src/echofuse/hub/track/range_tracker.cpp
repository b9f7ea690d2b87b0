#include "echofuse/hub/track/range_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/core/check.hpp"
#include "show_tracks.hpp"

namespace echofuse::hub {
namespace {

using estimation::ConstantVelocityFilter;

constexpr float kLogSqrtTwoPi = 0.91893853f;
constexpr float kGateSigmas = 3.0f;
constexpr float kBody_m = 1.0f;        ///< [m] clutter_body_per_m reaches so far
constexpr float kEcho_m = 2.5f;        ///< [m] clutter_echo_per_m
constexpr float kFar_m = 8.0f;         ///< [m] clutter_far_per_m
constexpr float kGridVariance = 0.3f;  ///< [1] times the step squared: of a path at the nearest grid point
constexpr float kBirthShare = 0.5f;    ///< [1] of a birth's score that it keeps: the place was chosen for it
constexpr float kOutside_m = 0.2f;     ///< [m] a track may leave the area by so much
constexpr float kSharedVariance = 4.0f;  ///< [1] times wider: a detection that is perhaps another's
constexpr float kDouble_m = 0.3f;        ///< [m] two confirmed tracks nearer than this
constexpr float kDouble_mps = 0.7f;      ///< [m/s] and alike in velocity are one person

bool within(float value, float least, float most) { return value >= least && value <= most; }

float distance_m(const estimation::Position& a, const estimation::Position& b) {
  const float x = a.x_m - b.x_m;
  const float y = a.y_m - b.y_m;
  return std::sqrt(x * x + y * y);
}

float speed_mps(float vx_mps, float vy_mps) { return std::sqrt(vx_mps * vx_mps + vy_mps * vy_mps); }

const char* invalid_model(const RangeTrackerConfig& c) {
  constexpr float kMost = 1e3f;
  if (!within(c.detection_probability, 0.01f, 0.99f)) return "detection_probability";
  if (!within(c.path_std_m, 1e-3f, kMost)) return "path_std_m";
  if (!within(c.clutter_ahead_per_m, 1e-6f, kMost)) return "clutter_ahead_per_m";
  if (!within(c.clutter_body_per_m, 1e-6f, kMost)) return "clutter_body_per_m";
  if (!within(c.clutter_echo_per_m, 1e-6f, kMost)) return "clutter_echo_per_m";
  if (!within(c.clutter_far_per_m, 1e-6f, kMost)) return "clutter_far_per_m";
  if (!within(c.blind_path_m, 0.0f, kMost)) return "blind_path_m";
  if (!within(c.gate_m, 1e-3f, kMost)) return "gate_m";
  if (!within(c.gate_max_m, c.gate_m, kMost)) return "gate_max_m";
  if (!within(c.echo_tail_m, 0.0f, kMost)) return "echo_tail_m";
  if (!within(c.acceleration_density_m2ps3, 0.0f, kMost)) return "acceleration_density_m2ps3";
  if (!within(c.newborn_position_std_m, 1e-3f, kMost)) return "newborn_position_std_m";
  if (!within(c.newborn_velocity_std_mps, 1e-3f, kMost)) return "newborn_velocity_std_mps";
  if (!within(c.max_speed_mps, 1e-3f, kMost)) return "max_speed_mps";
  return nullptr;
}

}  // namespace

const char* invalid_field(const RangeTrackerConfig& config) {
  const RangeTrackerConfig& c = config;
  constexpr float kMost = 1e3f;
  constexpr int kMostFrames = 10000;
  if (const char* field = invalid_model(c); field != nullptr) return field;
  if (!within(c.birth_step_m, 0.01f, kMost)) return "birth_step_m";
  if (!within(c.birth_score, -kMost, kMost)) return "birth_score";
  if (c.max_births < 0 || c.max_births > static_cast<int>(kMaxTracks)) return "max_births";
  if (!within(c.birth_exclusion_m, 0.0f, kMost)) return "birth_exclusion_m";
  if (!within(c.merge_distance_m, 0.0f, kMost)) return "merge_distance_m";
  if (!within(c.unconfirmed_memory, 0.0f, 1.0f)) return "unconfirmed_memory";
  if (!within(c.confirmed_memory, 0.0f, 1.0f)) return "confirmed_memory";
  if (!within(c.confirm_score, -kMost, kMost)) return "confirm_score";
  if (c.confirm_frames < 1 || c.confirm_frames > kMostFrames) return "confirm_frames";
  if (c.confirm_nodes < 1 || c.confirm_nodes > static_cast<int>(kMaxNodes)) return "confirm_nodes";
  if (!within(c.confirmed_bonus, 0.0f, kMost)) return "confirmed_bonus";
  if (!within(c.shared_score, -kMost, 0.0f)) return "shared_score";
  if (!within(c.max_score, c.confirm_score, kMost)) return "max_score";
  if (!within(c.drop_score, -kMost, kMost)) return "drop_score";
  if (!within(c.end_score, -kMost, c.confirm_score)) return "end_score";
  if (c.silent_nodes < 1 || c.silent_nodes > static_cast<int>(kMaxNodes)) return "silent_nodes";
  return nullptr;
}

Status RangeTracker::configure(const RangeTrackerConfig& config, float body_radius_m,
                               Span<const NodeSite> nodes, const Area& area) {
  if (invalid_field(config) != nullptr || !(body_radius_m >= 0.0f)) return Status::kInvalidConfig;
  if (nodes.size() > kMaxNodes || invalid_site(nodes, area) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  body_radius_m_ = body_radius_m;
  miss_score_ = std::log(1.0f - config.detection_probability);
  n_nodes_ = nodes.size();
  for (std::size_t i = 0; i < n_nodes_; ++i) {
    nodes_[i] = nodes[i];
    const float x = nodes[i].tx.x_m - nodes[i].rx.x_m;
    const float y = nodes[i].tx.y_m - nodes[i].rx.y_m;
    blind_until_m_[i] = std::sqrt(x * x + y * y) + config.blind_path_m;
  }
  area_ = area;
  const float width = area.max_x_m - area.min_x_m;
  const float height = area.max_y_m - area.min_y_m;
  step_m_ = std::max(config.birth_step_m, std::max(width, height) / static_cast<float>(kMaxCells / 4));
  const auto cells = [&](float length) { return std::max(1, static_cast<int>(length / step_m_)); };
  while (cells(width) * cells(height) > static_cast<int>(kMaxCells)) step_m_ *= 1.1f;
  columns_ = cells(width);
  rows_ = cells(height);
  configured_ = true;
  reset();
  return Status::kOk;
}

void RangeTracker::reset() {
  tracks_.clear();
  next_id_ = 1;
  dropped_births_ = 0;
}

Status RangeTracker::process(Span<const FrameDetection> detections, float dt_s, link::Tracks& tracks) {
  tracks.tracks.clear();
  if (!configured_) return Status::kNotConfigured;
  if (!(dt_s > 0.0f) || !std::isfinite(dt_s) || !index_frame(detections)) return Status::kInvalidInput;
  rate_clutter();
  advance(dt_s);
  const bool all_began = begin_tracks();
  report(tracks);
  show_tracks(sink_, tracks);
  return all_began ? Status::kOk : Status::kTruncated;
}

/// Notes where each node's detections begin; false: not in order, not finite, or too many.
bool RangeTracker::index_frame(Span<const FrameDetection> detections) {
  if (detections.size() > kMaxFrameDetections) return false;
  std::array<std::uint16_t, kMaxNodes + 1> first{};
  int previous_node = 0;
  float previous_path = 0.0f;
  for (const FrameDetection& detection : detections) {
    if (detection.node_index < previous_node || detection.node_index >= static_cast<int>(n_nodes_))
      return false;
    if (detection.node_index > previous_node) previous_path = 0.0f;
    if (!(detection.path_m >= previous_path && std::isfinite(detection.path_m))) return false;
    previous_node = detection.node_index;
    previous_path = detection.path_m;
    ++first[static_cast<std::size_t>(previous_node) + 1];
  }
  for (std::size_t node = 0; node < kMaxNodes; ++node)
    first[node + 1] = static_cast<std::uint16_t>(first[node + 1] + first[node]);
  first_ = first;
  detections_ = detections;
  claimed_.fill(false);
  return true;
}

/// A detection behind another one may well be clutter of that one's person, and the nearer the likelier; the
/// first one of a node is hardly anything but a person.
void RangeTracker::rate_clutter() {
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    for (std::size_t i = first_[node]; i < first_[node + 1]; ++i) {
      float density = config_.clutter_ahead_per_m;
      for (std::size_t j = first_[node]; j < i; ++j) {
        const float behind = detections_[i].path_m - detections_[j].path_m;
        if (behind > 0.0f) density = std::max(density, clutter_per_m(behind));
      }
      clutter_score_[i] = std::log(config_.detection_probability / density) - kLogSqrtTwoPi;
    }
  }
}

float RangeTracker::clutter_per_m(float behind_m) const {
  if (behind_m < kBody_m) return config_.clutter_body_per_m;
  if (behind_m < kEcho_m) return config_.clutter_echo_per_m;
  if (behind_m < kFar_m) return config_.clutter_far_per_m;
  return config_.clutter_ahead_per_m;
}

/// The node's detection nearest to a path, within the gate, or -1.
int RangeTracker::nearest(std::size_t node, float path_m, bool free_only, float gate_m) const {
  int best = -1;
  float least = gate_m;
  for (std::size_t i = first_[node]; i < first_[node + 1]; ++i) {
    if (free_only && claimed_[i]) continue;
    const float error = std::fabs(detections_[i].path_m - path_m);
    if (!(error < least)) continue;
    least = error;
    best = static_cast<int>(i);
  }
  return best;
}

/// Logarithm of the likelier of two: the detection is the person's, or the person was missed.
float RangeTracker::hit_score(int detection, float error_m, float std_m) const {
  const float deviations = error_m / std_m;
  const float hit =
      clutter_score_[static_cast<std::size_t>(detection)] - std::log(std_m) - 0.5f * deviations * deviations;
  return std::max(hit, miss_score_);
}

/// Updates the track by each node's nearest detection; its score in this frame.
float RangeTracker::follow(RangeTrack& track, bool may_share) const {
  float score = 0.0f;
  track.n_own = 0;
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    const estimation::Position at = track.filter.position();
    Point gradient;
    const float path =
        path_length({at.x_m, at.y_m}, nodes_[node].tx, nodes_[node].rx, body_radius_m_, &gradient);
    if (path < blind_until_m_[node]) continue;
    const Eigen::Vector2f direction(gradient.x_m, gradient.y_m);
    float variance = track.filter.variance_along(direction) + config_.path_std_m * config_.path_std_m;
    const float std_m = std::sqrt(variance);
    const float gate = std::min(config_.gate_max_m, std::max(config_.gate_m, kGateSigmas * std_m));
    float noise = config_.path_std_m * config_.path_std_m;
    int chosen = nearest(node, path, true, gate);
    if (chosen >= 0) {
      score += hit_score(chosen, detections_[static_cast<std::size_t>(chosen)].path_m - path, std_m);
      ++track.n_own;
    } else {
      chosen = nearest(node, path, false, gate);
      score += chosen >= 0 ? config_.shared_score : miss_score_;
      if (chosen < 0 || !may_share) continue;
      noise += (kSharedVariance - 1.0f) * variance;
    }
    track.filter.update_along(direction, detections_[static_cast<std::size_t>(chosen)].path_m - path, noise);
  }
  return score;
}

/// Its score has not fallen too low, and it is a person's place and speed.
bool RangeTracker::lives(const RangeTrack& track) const {
  const auto& state = track.filter.state();
  if (!within(state(0), area_.min_x_m - kOutside_m, area_.max_x_m + kOutside_m)) return false;
  if (!within(state(2), area_.min_y_m - kOutside_m, area_.max_y_m + kOutside_m)) return false;
  if (track.confirmed) return track.score >= config_.end_score;
  return track.score >= config_.drop_score && speed_mps(state(1), state(3)) <= config_.max_speed_mps;
}

/// Is a better track the same person.
bool RangeTracker::crowded(const RangeTrack& track) const {
  const auto& own = track.filter.state();
  for (const RangeTrack& better : tracks_) {
    if (&better == &track) return false;
    const float distance = distance_m(better.filter.position(), track.filter.position());
    if (!track.confirmed && distance < config_.merge_distance_m) return true;
    const auto& other = better.filter.state();
    if (track.confirmed && better.confirmed && distance < kDouble_m &&
        speed_mps(own(1) - other(1), own(3) - other(3)) < kDouble_mps)
      return true;
  }
  return false;
}

/// What it explains is nobody else's: the detections at its paths, and the tail of its echoes.
void RangeTracker::claim(const RangeTrack& track) {
  const estimation::Position at = track.filter.position();
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    const float path = path_length({at.x_m, at.y_m}, nodes_[node].tx, nodes_[node].rx, body_radius_m_);
    for (std::size_t i = first_[node]; i < first_[node + 1]; ++i) {
      const float behind = detections_[i].path_m - path;
      if (behind > -config_.gate_m && behind < std::max(config_.gate_m, config_.echo_tail_m))
        claimed_[i] = true;
    }
  }
}

/// Every track by its turn: the best see all detections, the others what is left.
void RangeTracker::advance(float dt_s) {
  for (RangeTrack& track : tracks_) track.filter.predict(dt_s, config_.acceleration_density_m2ps3);
  const auto rank = [this](const RangeTrack& t) {
    return t.score + (t.confirmed ? config_.confirmed_bonus : 0.0f);
  };
  for (std::size_t i = 1; i < tracks_.size(); ++i)  // insertion: stable, and they are nearly in order
    for (std::size_t j = i; j > 0 && rank(tracks_[j]) > rank(tracks_[j - 1]); --j)
      std::swap(tracks_[j], tracks_[j - 1]);

  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    RangeTrack track = tracks_[i];
    const float memory = track.confirmed ? config_.confirmed_memory : config_.unconfirmed_memory;
    const float score = follow(track, track.confirmed);
    track.score = std::min(config_.max_score, memory * track.score + score);
    ++track.age;
    track.frames_since_update = track.n_own >= config_.silent_nodes ? 0 : track.frames_since_update + 1;
    if (!lives(track)) continue;
    tracks_[kept] = track;
    if (crowded(tracks_[kept])) continue;
    if (!track.confirmed && track.score >= config_.confirm_score && track.age >= config_.confirm_frames &&
        track.n_own >= config_.confirm_nodes)
      tracks_[kept].confirmed = true;
    if (tracks_[kept].confirmed) claim(tracks_[kept]);
    ++kept;
  }
  (void)tracks_.resize_within(kept);
}

/// At the grid's maxima of what the tracks have left over, best first; false when there was no room for one.
bool RangeTracker::begin_tracks() {
  const auto place = [this](int column, int row) {
    return Point{area_.min_x_m + (static_cast<float>(column) + 0.5f) * step_m_,
                 area_.min_y_m + (static_cast<float>(row) + 0.5f) * step_m_};
  };
  for (int column = 0; column < columns_; ++column)
    for (int row = 0; row < rows_; ++row)
      cells_[static_cast<std::size_t>(column * rows_ + row)] = cell_score(place(column, row));

  const auto is_maximum = [this](int column, int row) {
    const int index = column * rows_ + row;
    const float score = cells_[static_cast<std::size_t>(index)];
    if (score < config_.birth_score) return false;
    for (int c = std::max(0, column - 2); c <= std::min(columns_ - 1, column + 2); ++c) {
      for (int r = std::max(0, row - 2); r <= std::min(rows_ - 1, row + 2); ++r) {
        const int other = c * rows_ + r;
        const float value = cells_[static_cast<std::size_t>(other)];
        if (value > score || (value == score && other < index)) return false;
      }
    }
    return true;
  };
  BoundedVector<Cell, kMaxTracks> best;  // descending score
  for (int column = 0; column < columns_; ++column) {
    for (int row = 0; row < rows_; ++row) {
      if (!is_maximum(column, row)) continue;
      const Cell cell{cells_[static_cast<std::size_t>(column * rows_ + row)], column * rows_ + row};
      if (best.full() && cell.score <= best[best.size() - 1].score) continue;
      if (best.full()) best.pop_back();
      ECHOFUSE_CHECK(best.try_push_back(cell));
      for (std::size_t i = best.size() - 1; i > 0 && best[i].score > best[i - 1].score; --i)
        std::swap(best[i], best[i - 1]);
    }
  }
  const std::size_t before = tracks_.size();
  bool all_began = true;
  for (const Cell& cell : best) {
    if (tracks_.size() - before >= static_cast<std::size_t>(config_.max_births)) break;
    if (!begin_at(place(cell.index / rows_, cell.index % rows_))) all_began = false;
  }
  return all_began;
}

/// Score of a person at a place, by detections that nobody claims.
float RangeTracker::cell_score(const Point& place) const {
  const float std_m = std::sqrt(config_.path_std_m * config_.path_std_m + kGridVariance * step_m_ * step_m_);
  float score = 0.0f;
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    const float path = path_length(place, nodes_[node].tx, nodes_[node].rx, body_radius_m_);
    if (path < blind_until_m_[node]) continue;
    const int own = nearest(node, path, true, 4.0f * std_m);
    const bool near =
        own >= 0 && std::fabs(detections_[static_cast<std::size_t>(own)].path_m - path) <= config_.gate_m;
    if (!near && nearest(node, path, false, config_.gate_m) >= 0) continue;  // another's: says nothing
    score += own < 0 ? miss_score_
                     : hit_score(own, detections_[static_cast<std::size_t>(own)].path_m - path, std_m);
  }
  return score;
}

/// False when there is no room for a track that should begin.
bool RangeTracker::begin_at(const Point& place) {
  for (const RangeTrack& track : tracks_)
    if (distance_m(track.filter.position(), {place.x_m, place.y_m}) < config_.birth_exclusion_m) return true;
  const float position = config_.newborn_position_std_m * config_.newborn_position_std_m;
  const float velocity = config_.newborn_velocity_std_mps * config_.newborn_velocity_std_mps;
  RangeTrack track;
  track.filter = ConstantVelocityFilter(
      ConstantVelocityFilter::State(place.x_m, 0.0f, place.y_m, 0.0f),
      ConstantVelocityFilter::State(position, velocity, position, velocity).asDiagonal());
  const float score = follow(track, false);
  if (!(score >= config_.birth_score) || track.n_own == 0) return true;  // 0: where all nodes are blind
  track.score = kBirthShare * score;
  track.id = next_id_;
  if (!tracks_.try_push_back(track)) {
    ++dropped_births_;
    return false;
  }
  ++next_id_;
  return true;
}

void RangeTracker::report(link::Tracks& tracks) const {
  for (const RangeTrack& track : tracks_) {
    const auto& x = track.filter.state();
    const auto& p = track.filter.covariance();
    link::TrackState state = link::TrackState::kUnconfirmed;
    if (track.confirmed)
      state = track.frames_since_update == 0 ? link::TrackState::kConfirmed : link::TrackState::kSilent;
    ECHOFUSE_CHECK(tracks.tracks.try_push_back(
        {track.id, state, track.frames_since_update, x(0), x(2), x(1), x(3), p(0, 0), p(0, 2), p(2, 2)}));
    for (std::size_t i = tracks.tracks.size() - 1; i > 0 && tracks.tracks[i].id < tracks.tracks[i - 1].id;
         --i)
      std::swap(tracks.tracks[i], tracks.tracks[i - 1]);
  }
}

}  // namespace echofuse::hub
