#include "echofuse/node/scan/target_traces.hpp"

#include <algorithm>
#include <cstddef>

namespace echofuse::node {
namespace {

constexpr float kThinnest = 3.0f;  ///< fewer hits than one in three say nothing about their density

}  // namespace

const char* invalid_field(const TargetTraceConfig& config) {
  if (config.window_samples < 1) return "window_samples";
  if (config.least_hits < 1 || config.least_hits > config.window_samples) return "least_hits";
  return nullptr;
}

Status TargetTracer::configure(const TargetTraceConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  return Status::kOk;
}

Status TargetTracer::process(Span<const std::uint8_t> decisions, BoundedVector<TargetTrace>& traces) const {
  traces.clear();
  if (!configured_) return Status::kNotConfigured;
  const auto window = static_cast<std::size_t>(config_.window_samples);
  int sum = 0;
  int begin = -1;  // of the interval, -1: outside
  int weight = 0;
  for (std::size_t k = 0; k <= decisions.size(); ++k) {
    if (k < decisions.size()) sum += decisions[k];
    if (k >= window) sum -= decisions[k - window];
    if (k < decisions.size() && sum >= config_.least_hits) {
      if (begin < 0) begin = static_cast<int>(k);
      weight = std::max(weight, sum);
      continue;
    }
    const bool alone = begin == static_cast<int>(k) - 1;  // an interval of one sample is no target
    if (begin >= 0 && !alone && !traces.try_push_back({beginning(begin, weight), weight}))
      return Status::kTruncated;
    begin = -1;
    weight = 0;
  }
  return Status::kOk;
}

float TargetTracer::beginning(int sample, int weight) const {
  const auto before = static_cast<float>(config_.least_hits - 1);
  float toa = static_cast<float>(sample) - before;
  if (config_.density_correction)
    toa -=
        before *
        (std::min(static_cast<float>(config_.window_samples) / static_cast<float>(weight), kThinnest) - 1.0f);
  return std::max(toa, 0.0f);
}

}  // namespace echofuse::node
