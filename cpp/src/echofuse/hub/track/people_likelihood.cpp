#include "echofuse/hub/track/people_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echofuse/core/check.hpp"

namespace echofuse::hub {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kSqrtTwoPi = 2.5066283f;
constexpr float kScaleVariance = 0.5f;  ///< [1] a Laplace density of mean deviation b has the variance 2 b^2
constexpr float kTooNear = -1.0f;

/// [m] from a point to the straight line between two others.
float leg_distance(const Point& start, const Point& end, const Point& point) {
  const float x = end.x_m - start.x_m;
  const float y = end.y_m - start.y_m;
  const float length2 = x * x + y * y;
  const float along = (point.x_m - start.x_m) * x + (point.y_m - start.y_m) * y;
  const float part = length2 > 0.0f ? std::clamp(along / length2, 0.0f, 1.0f) : 0.0f;
  const float off_x = start.x_m + part * x - point.x_m;
  const float off_y = start.y_m + part * y - point.y_m;
  return std::sqrt(off_x * off_x + off_y * off_y);
}

}  // namespace

void PeopleLikelihood::configure(const RangeTrackerConfig& config, float body_radius_m,
                                 Span<const NodeSite> nodes) {
  config_ = config;
  body_radius_m_ = body_radius_m;
  n_nodes_ = nodes.size();
  for (std::size_t i = 0; i < n_nodes_; ++i) {
    nodes_[i] = nodes[i];
    const float x = nodes[i].tx.x_m - nodes[i].rx.x_m;
    const float y = nodes[i].tx.y_m - nodes[i].rx.y_m;
    baseline_m_[i] = std::sqrt(x * x + y * y);
  }
  const float clear[] = {config.detection_probability, config.far_detection_probability};
  const float shadowed[] = {config.shadowed_detection_probability, config.far_shadowed_detection_probability};
  for (std::size_t far = 0; far < 2; ++far) {
    const float by_shadow[] = {clear[far], 0.5f * (clear[far] + shadowed[far]), shadowed[far]};
    for (std::size_t shadow = 0; shadow < 3; ++shadow) {
      probability_[3 * far + shadow] = by_shadow[shadow];
      log_hit_[3 * far + shadow] = std::log(by_shadow[shadow]);
      log_miss_[3 * far + shadow] = std::log(1.0f - by_shadow[shadow]);
    }
  }
  log_ahead_ = std::log(config.clutter_ahead_per_m);
  log_near_ = std::log(config.clutter_near_per_m);
  log_far_ = std::log(config.clutter_far_per_m);
  reset();
}

void PeopleLikelihood::reset() {
  n_frames_ = 0;
  newest_ = 0;
}

void PeopleLikelihood::add_frame(Span<const FrameDetection> detections, float dt_s) {
  const auto window = static_cast<std::size_t>(config_.window_frames);
  if (n_frames_ > 0) newest_ = (newest_ + 1) % window;
  n_frames_ = std::min(n_frames_ + 1, window);
  Frame& frame = frames_[newest_];
  frame.dt_s = dt_s;
  frame.first.fill(0);
  for (std::size_t i = 0; i < detections.size(); ++i) {
    frame.path_m[i] = detections[i].path_m;
    ++frame.first[static_cast<std::size_t>(detections[i].node_index) + 1];
  }
  for (std::size_t node = 0; node < kMaxNodes; ++node)
    frame.first[node + 1] = static_cast<std::uint16_t>(frame.first[node + 1] + frame.first[node]);
}

Span<const float> PeopleLikelihood::paths(std::size_t slot, std::size_t node) const {
  const Frame& frame = frames_[slot];
  return {frame.path_m.data() + frame.first[node],
          static_cast<std::size_t>(frame.first[node + 1] - frame.first[node])};
}

float PeopleLikelihood::visible_path(const Point& place, std::size_t node, Point* gradient) const {
  const float path = path_length(place, nodes_[node].tx, nodes_[node].rx, body_radius_m_, gradient);
  if (path < baseline_m_[node] + config_.visible_path_m) return kTooNear;
  return std::max(path, baseline_m_[node] + config_.nearest_path_m);
}

void PeopleLikelihood::lay(const estimation::ConstantVelocityFilter<2>& filter, int age, Trail& trail) const {
  const auto& x = filter.state();
  const auto& p = filter.covariance();
  std::size_t slot = newest_;
  float back_s = 0.0f;
  for (std::size_t lag = 0; lag < n_frames_; ++lag) {
    if (lag == 0 || lag >= static_cast<std::size_t>(age)) {
      const Point place{x(0) - back_s * x(1), x(2) - back_s * x(3)};
      float variance = 0.0f;
      if (lag > 0)
        variance = p(0, 0) + p(2, 2) + back_s * back_s * (p(1, 1) + p(3, 3)) -
                   2.0f * back_s * (p(0, 1) + p(2, 3)) +
                   config_.acceleration_density_m2ps3 * back_s * back_s * back_s;
      const float scale =
          std::sqrt(config_.path_scale_m * config_.path_scale_m + kScaleVariance * std::max(variance, 0.0f));
      trail.position[slot] = place;
      trail.scale_m[slot] = scale;
      trail.log_two_scale[slot] = std::log(2.0f * scale);
      for (std::size_t node = 0; node < n_nodes_; ++node)
        trail.path_m[slot][node] = visible_path(place, node);
    }
    back_s += frames_[slot].dt_s;
    slot = slot == 0 ? static_cast<std::size_t>(config_.window_frames) - 1 : slot - 1;
  }
}

/// Who can be seen, by ascending path.
void PeopleLikelihood::gather(People people, std::size_t slot, std::size_t node, Scene& scene) const {
  scene.members.clear();
  scene.explained.fill(false);
  scene.first_m = kInfinity;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const float path = people[i]->path_m[slot][node];
    if (path < 0.0f) {
      scene.first_m = std::min(scene.first_m, baseline_m_[node] + config_.visible_path_m);
      continue;
    }
    scene.first_m = std::min(scene.first_m, path);
    Member member;
    member.trail = people[i];
    member.index = i;
    member.path_m = path;
    ECHOFUSE_CHECK(scene.members.try_push_back(member));
    for (std::size_t k = scene.members.size() - 1;
         k > 0 && scene.members[k].path_m < scene.members[k - 1].path_m; --k)
      std::swap(scene.members[k], scene.members[k - 1]);
  }
  for (Member& member : scene.members)
    member.visibility = visibility(people, member, slot, node, scene.first_m);
}

int PeopleLikelihood::visibility(People people, const Member& member, std::size_t slot, std::size_t node,
                                 float first_m) const {
  const Point& place = member.trail->position[slot];
  float clearance = kInfinity;
  for (const Trail* other : people) {
    if (other == member.trail) continue;
    const Point& at = other->position[slot];
    clearance = std::min(clearance, leg_distance(nodes_[node].tx, place, at));
    clearance = std::min(clearance, leg_distance(nodes_[node].rx, place, at));
  }
  const int shadow = clearance < config_.shadow_radius_m ? 2 : clearance < config_.penumbra_m ? 1 : 0;
  return (member.path_m - first_m > config_.far_m ? 3 : 0) + shadow;
}

/// Pairs of person and detection, the nearest first.
void PeopleLikelihood::associate(Span<const float> paths_m, Scene& scene) const {
  for (;;) {
    float least = config_.gate_m;
    Member* nearest = nullptr;
    std::size_t its = 0;
    for (Member& member : scene.members) {
      if (member.detection >= 0) continue;
      for (std::size_t i = 0; i < paths_m.size(); ++i) {
        const float error = std::fabs(paths_m[i] - member.path_m);
        if (scene.explained[i] || !(error < least)) continue;
        least = error;
        nearest = &member;
        its = i;
      }
    }
    if (nearest == nullptr) return;
    nearest->detection = static_cast<int>(its);
    scene.explained[its] = true;
  }
}

/// Whether somebody with a detection is so near in path that it may be both's.
bool PeopleLikelihood::shares(const Scene& scene, const Member& member) const {
  for (const Member& other : scene.members)
    if (&other != &member && other.detection >= 0 &&
        std::fabs(other.path_m - member.path_m) < config_.shared_path_m)
      return true;
  return false;
}

float PeopleLikelihood::log_clutter(float path_m, const Scene& scene) const {
  float behind = path_m - scene.first_m + config_.ahead_m;
  if (!(behind > 0.0f)) return log_ahead_;
  for (const Member& member : scene.members) {
    const float own = path_m - member.path_m + config_.ahead_m;
    if (own > 0.0f) behind = std::min(behind, own);
  }
  return behind < config_.far_m ? log_near_ : log_far_;
}

float PeopleLikelihood::scene_score(People people, std::size_t slot, std::size_t node) const {
  const Span<const float> paths_m = paths(slot, node);
  Scene scene;
  gather(people, slot, node, scene);
  associate(paths_m, scene);
  float score = 0.0f;
  for (const Member& member : scene.members) {
    const auto kind = static_cast<std::size_t>(member.visibility);
    const float missed = shares(scene, member) ? config_.shared_score : log_miss_[kind];
    if (member.detection < 0) {
      score += missed;
      continue;
    }
    const float path = paths_m[static_cast<std::size_t>(member.detection)];
    const float hit = log_hit_[kind] - member.trail->log_two_scale[slot] -
                      std::fabs(path - member.path_m) / member.trail->scale_m[slot];
    score += std::max(hit, missed + log_clutter(path, scene));
  }
  for (std::size_t i = 0; i < paths_m.size(); ++i)
    if (!scene.explained[i]) score += log_clutter(paths_m[i], scene);
  return score;
}

float PeopleLikelihood::score(People people) const {
  float score = 0.0f;
  for (std::size_t slot = 0; slot < n_frames_; ++slot) {
    float of_frame = 0.0f;
    for (std::size_t node = 0; node < n_nodes_; ++node) of_frame += scene_score(people, slot, node);
    score += of_frame;
  }
  return score;
}

void PeopleLikelihood::claim(People people, Span<const float> stds_m, std::size_t node,
                             Span<Claim> claims) const {
  for (Claim& claim : claims) claim = Claim{};
  Scene scene;
  gather(people, newest_, node, scene);
  associate(paths(node), scene);
  for (const Member& member : scene.members) {
    if (member.detection < 0) continue;
    const float probability = probability_[static_cast<std::size_t>(member.visibility)];
    const float std_m = stds_m[member.index];
    const float deviations =
        (paths(node)[static_cast<std::size_t>(member.detection)] - member.path_m) / std_m;
    const float own = probability * std::exp(-0.5f * deviations * deviations) / (kSqrtTwoPi * std_m);
    const float other = (1.0f - probability) * config_.clutter_near_per_m;
    claims[member.index] = {member.detection, own / (own + other)};
  }
}

}  // namespace echofuse::hub
