#include "echofuse/node/scan/range_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echofuse/node/scan/drop_lightest.hpp"

namespace echofuse::node {
namespace {

/// Where the square of the amplitude crosses the threshold before sample `first`, linear between two samples.
float leading_edge(int first, Span<const float> amplitude, Span<const float> threshold) {
  const auto position = static_cast<float>(first);
  if (first == 0) return position;
  const auto k = static_cast<std::size_t>(first);
  const float excess = amplitude[k] * amplitude[k] - threshold[k];
  const float deficit = threshold[k - 1] - amplitude[k - 1] * amplitude[k - 1];
  if (!(excess > 0.0f && deficit > 0.0f && deficit < std::numeric_limits<float>::infinity())) return position;
  return position - excess / (excess + deficit);
}

}  // namespace

const char* invalid_field(const RangeClusterConfig& config) {
  if (!(config.merge_distance_s > 0.0f && config.merge_distance_s < 1.0f)) return "merge_distance_s";
  if (config.min_weight < 1) return "min_weight";
  if (config.representative != ClusterRepresentative::kLeadingEdge &&
      config.representative != ClusterRepresentative::kMedian)
    return "representative";
  return nullptr;
}

Status RangeClusterer::configure(const RangeClusterConfig& config, float sample_rate_hz) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  const float distance = config.merge_distance_s * sample_rate_hz;
  if (!(distance >= 0.5f && distance < 65536.0f)) return Status::kInvalidConfig;
  config_ = config;
  merge_distance_samples_ = static_cast<int>(std::lround(distance));
  return Status::kOk;
}

Status RangeClusterer::process(Span<const std::uint8_t> decisions, Span<const float> amplitude,
                               Span<const float> threshold, BoundedVector<RangeCluster>& clusters) {
  clusters.clear();
  if (merge_distance_samples_ == 0) return Status::kNotConfigured;
  if (decisions.size() > hits_.size() || amplitude.size() != decisions.size() ||
      threshold.size() != decisions.size())
    return Status::kInvalidInput;
  collect(decisions);
  merge();
  Status status = Status::kOk;
  for (std::size_t c = 0; c < n_clusters_; ++c) {
    if (starts_[c + 1] - starts_[c] < config_.min_weight) continue;
    const RangeCluster found = cluster(c, amplitude, threshold);
    if (clusters.try_push_back(found)) continue;
    status = Status::kTruncated;
    const auto lightest = std::min_element(clusters.begin(), clusters.end(),
                                           [](const auto& a, const auto& b) { return a.weight < b.weight; });
    if (lightest == clusters.end() || found.weight <= lightest->weight) continue;
    drop_lightest(clusters);
    (void)clusters.try_push_back(found);
  }
  return status;
}

/// Every hit a cluster of its own.
void RangeClusterer::collect(Span<const std::uint8_t> decisions) {
  n_clusters_ = 0;
  for (std::size_t k = 0; k < decisions.size(); ++k) {
    if (decisions[k] == 0) continue;
    hits_[n_clusters_] = static_cast<std::uint16_t>(k);
    starts_[n_clusters_] = static_cast<std::uint16_t>(n_clusters_);
    ++n_clusters_;
  }
  starts_[n_clusters_] = static_cast<std::uint16_t>(n_clusters_);
}

void RangeClusterer::merge() {
  int distance = 1;
  while (n_clusters_ > 1 && distance < merge_distance_samples_) {
    const std::size_t n_hits = starts_[n_clusters_];
    int next_distance = merge_distance_samples_;
    std::size_t current = 0;  // last cluster written; it spans [starts_[current], begin of c)
    for (std::size_t c = 1; c < n_clusters_; ++c) {
      const std::size_t begin = starts_[c];
      const std::size_t end = starts_[c + 1];
      const int gap = median(begin, end) - median(starts_[current], begin);
      if (gap <= distance) continue;  // merged: current now ends where c ends
      next_distance = std::min(next_distance, gap);
      starts_[++current] = static_cast<std::uint16_t>(begin);
    }
    n_clusters_ = current + 1;
    starts_[n_clusters_] = static_cast<std::uint16_t>(n_hits);
    distance = std::max(distance + 1, next_distance);
  }
}

RangeCluster RangeClusterer::cluster(std::size_t index, Span<const float> amplitude,
                                     Span<const float> threshold) const {
  const std::size_t begin = starts_[index];
  const std::size_t end = starts_[index + 1];
  RangeCluster found;
  found.weight = static_cast<std::int32_t>(end - begin);
  found.first_sample = hits_[begin];
  found.last_sample = hits_[end - 1];
  found.position_samples = config_.representative == ClusterRepresentative::kLeadingEdge
                               ? leading_edge(found.first_sample, amplitude, threshold)
                               : static_cast<float>(median(begin, end));
  return found;
}

}  // namespace echofuse::node
