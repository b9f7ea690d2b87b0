#include "echofuse/node/scan/leading_edge.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace echofuse::node {
namespace {

constexpr int kLongestSide = 1000;  ///< [sample] of a window

bool is_side(int samples) { return samples >= 0 && samples <= kLongestSide; }

}  // namespace

const char* invalid_field(const LeadingEdgeConfig& config) {
  if (config.rule > EdgeRule::kContrast) return "rule";
  if (!(config.fraction > 0.0f && config.fraction < 1.0f)) return "fraction";
  if (config.mean_samples < 1 || config.mean_samples > kLongestSide) return "mean_samples";
  if (!is_side(config.before_samples)) return "before_samples";
  if (!is_side(config.after_samples)) return "after_samples";
  return nullptr;
}

Status LeadingEdge::configure(const LeadingEdgeConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  return Status::kOk;
}

Status LeadingEdge::process(Span<const float> envelope, BoundedVector<TargetTrace>& traces) const {
  if (!configured_) return Status::kNotConfigured;
  for (TargetTrace& trace : traces) trace.toa_samples = edge(envelope, trace.toa_samples);
  return Status::kOk;
}

float LeadingEdge::edge(Span<const float> envelope, float toa_samples) const {
  const int n_samples = static_cast<int>(envelope.size());
  if (!(toa_samples >= 0.0f && toa_samples < static_cast<float>(n_samples))) return toa_samples;
  const int nearest = static_cast<int>(std::floor(toa_samples + 0.5f));
  const int first = std::max(nearest - config_.before_samples, 0);
  const int last = std::min(nearest + config_.after_samples, n_samples - 1);
  float largest = 0.0f;
  for (int k = first; k <= last; ++k) largest = std::max(largest, envelope[static_cast<std::size_t>(k)]);
  if (!(largest > 0.0f)) return toa_samples;
  return config_.rule == EdgeRule::kContrast ? largest_step(envelope, first, last)
                                             : first_above(envelope, first, config_.fraction * largest);
}

/// There is such a sample at or behind the first.
float LeadingEdge::first_above(Span<const float> envelope, int first, float level) const {
  int crossed = first;
  while (!(envelope[static_cast<std::size_t>(crossed)] > level)) ++crossed;
  if (crossed == first) return static_cast<float>(first);
  const float low = envelope[static_cast<std::size_t>(crossed - 1)];
  const float high = envelope[static_cast<std::size_t>(crossed)];
  return static_cast<float>(crossed - 1) + (level - low) / (high - low);
}

float LeadingEdge::largest_step(Span<const float> envelope, int first, int last) const {
  int best = first;
  float largest = step(envelope, first);
  for (int k = first + 1; k <= last; ++k) {
    const float here = step(envelope, k);
    if (!(here > largest)) continue;
    largest = here;
    best = k;
  }
  if (best == first || best == last) return static_cast<float>(best);
  const float before = step(envelope, best - 1);
  const float behind = step(envelope, best + 1);
  const float curvature = before - 2.0f * largest + behind;
  return static_cast<float>(best) + (curvature < 0.0f ? 0.5f * (before - behind) / curvature : 0.0f);
}

/// Sum of the samples from here on less that of those before; outside the envelope is 0.
float LeadingEdge::step(Span<const float> envelope, int at) const {
  const int n_samples = static_cast<int>(envelope.size());
  float sum = 0.0f;
  for (int k = at; k < std::min(at + config_.mean_samples, n_samples); ++k)
    sum += envelope[static_cast<std::size_t>(k)];
  for (int k = std::max(at - config_.mean_samples, 0); k < at; ++k)
    sum -= envelope[static_cast<std::size_t>(k)];
  return sum;
}

}  // namespace echofuse::node
