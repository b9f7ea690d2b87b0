#include "echofuse/hub/measure/point_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace echofuse::hub {
namespace {

constexpr std::uint16_t kNone = 0xFFFF;
static_assert(kMaxMeasurementsPerFrame < kNone, "members are numbered in 16 bits");

}  // namespace

const char* invalid_field(const PointClusterConfig& config) {
  if (config.distance > ClusterDistance::kMaximum) return "distance";
  if (!(config.threshold_m > 0.0f && std::isfinite(config.threshold_m))) return "threshold_m";
  return nullptr;
}

Status PointClusters::configure(const PointClusterConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  reset();
  return Status::kOk;
}

Status PointClusters::process(Span<const Measurement> measurements, BoundedVector<PointCluster>& clusters) {
  clusters.clear();
  if (!configured_) return Status::kNotConfigured;
  if (measurements.size() > kMaxMeasurementsPerFrame) return Status::kInvalidInput;
  for (const Measurement& m : measurements)
    if (!std::isfinite(m.x_m) || !std::isfinite(m.y_m) || !std::isfinite(m.weight))
      return Status::kInvalidInput;

  points_ = measurements;
  clusters_.clear();
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const Measurement& m = measurements[i];
    const auto index = static_cast<std::uint16_t>(i);
    next_[i] = kNone;
    if (!clusters_.try_push_back({m.x_m, m.y_m, m.x_m, m.y_m, m.weight, 1, index, index, kNone, 0.0f}))
      return Status::kInvalidInput;
  }
  for (std::size_t i = 0; i < clusters_.size(); ++i) find_nearest(i);
  while (clusters_.size() > 1) {
    std::size_t first = 0;
    for (std::size_t i = 1; i < clusters_.size(); ++i)
      if (clusters_[i].distance_m < clusters_[first].distance_m) first = i;
    if (!(clusters_[first].distance_m < config_.threshold_m)) break;
    merge(first, clusters_[first].nearest);
  }

  const bool cut = clusters_.size() > clusters.capacity();
  while (clusters_.size() > clusters.capacity()) {
    std::size_t lightest = 0;
    for (std::size_t i = 1; i < clusters_.size(); ++i)
      if (clusters_[i].weight < clusters_[lightest].weight) lightest = i;
    clusters_.erase_at(lightest);
    ++dropped_;
  }
  for (const Cluster& c : clusters_)
    if (!clusters.try_push_back({c.x_m, c.y_m, c.members, c.weight})) return Status::kTruncated;
  return cut ? Status::kTruncated : Status::kOk;
}

float PointClusters::distance(const Cluster& a, const Cluster& b) const {
  const auto between = [](float ax, float ay, float bx, float by) {
    return std::sqrt((ax - bx) * (ax - bx) + (ay - by) * (ay - by));
  };
  if (config_.distance == ClusterDistance::kCentroid) return between(a.x_m, a.y_m, b.x_m, b.y_m);
  const bool farthest = config_.distance == ClusterDistance::kMaximum;
  float found = farthest ? 0.0f : std::numeric_limits<float>::infinity();
  for (std::uint16_t i = a.first; i != kNone; i = next_[i]) {
    for (std::uint16_t j = b.first; j != kNone; j = next_[j]) {
      const float d = between(points_[i].x_m, points_[i].y_m, points_[j].x_m, points_[j].y_m);
      found = farthest ? std::max(found, d) : std::min(found, d);
    }
  }
  return found;
}

void PointClusters::find_nearest(std::size_t index) {
  Cluster& cluster = clusters_[index];
  cluster.nearest = kNone;
  cluster.distance_m = std::numeric_limits<float>::infinity();
  for (std::size_t j = index + 1; j < clusters_.size(); ++j) {
    const float d = distance(cluster, clusters_[j]);
    if (!(d < cluster.distance_m)) continue;
    cluster.distance_m = d;
    cluster.nearest = static_cast<std::uint16_t>(j);
  }
}

/// Joins two clusters, into < from, and renews what they were nearest to.
void PointClusters::merge(std::size_t into, std::size_t from) {
  Cluster& kept = clusters_[into];
  const Cluster gone = clusters_[from];
  next_[kept.last] = gone.first;
  kept.last = gone.last;
  kept.members = static_cast<std::uint16_t>(kept.members + gone.members);
  kept.sum_x_m += gone.sum_x_m;
  kept.sum_y_m += gone.sum_y_m;
  kept.weight += gone.weight;
  kept.x_m = kept.sum_x_m / static_cast<float>(kept.members);
  kept.y_m = kept.sum_y_m / static_cast<float>(kept.members);
  clusters_.erase_at(from);

  for (std::size_t i = 0; i < clusters_.size(); ++i) {
    Cluster& cluster = clusters_[i];
    const bool stale = i == into || cluster.nearest == into || cluster.nearest == from;
    if (stale) {
      find_nearest(i);
      continue;
    }
    if (cluster.nearest != kNone && cluster.nearest > from) --cluster.nearest;
    if (i >= into) continue;
    const float d = distance(cluster, clusters_[into]);
    if (d < cluster.distance_m || (d == cluster.distance_m && into < cluster.nearest)) {
      cluster.distance_m = d;
      cluster.nearest = static_cast<std::uint16_t>(into);
    }
  }
}

}  // namespace echofuse::hub
