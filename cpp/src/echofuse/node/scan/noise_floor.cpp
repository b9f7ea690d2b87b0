#include "echofuse/node/scan/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echofuse/core/limits.hpp"

namespace echofuse::node {
namespace {

/// Least mean square of the whole blocks from the first sample on; silent (all 0) blocks say nothing.
float quietest_block(Span<const float> amplitude, std::size_t block) {
  float quietest = std::numeric_limits<float>::infinity();
  for (std::size_t begin = 0; begin + block <= amplitude.size(); begin += block) {
    float power = 0.0f;
    for (std::size_t k = begin; k < begin + block; ++k) power += amplitude[k] * amplitude[k];
    if (power > 0.0f) quietest = std::min(quietest, power);
  }
  return quietest / static_cast<float>(block);
}

}  // namespace

const char* invalid_field(const NoiseFloorConfig& config) {
  if (!(config.factor >= 0.0f && config.factor <= 1e6f)) return "factor";
  if (config.block_samples < 1 || config.block_samples > static_cast<int>(kMaxSamplesPerScan))
    return "block_samples";
  if (!(config.averaging_factor > 0.0f && config.averaging_factor < 1.0f)) return "averaging_factor";
  return nullptr;
}

Status NoiseFloor::configure(const NoiseFloorConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  reset();
  return Status::kOk;
}

void NoiseFloor::reset() {
  n_averaged_ = 0;
  floor_ = 0.0f;
}

Status NoiseFloor::process(Span<const float> amplitude, Span<float> threshold) {
  if (!configured_) return Status::kNotConfigured;
  const auto block = static_cast<std::size_t>(config_.block_samples);
  if (amplitude.size() != threshold.size() || amplitude.size() < block) return Status::kInvalidInput;
  if (config_.factor == 0.0f) return Status::kOk;
  const float quietest = std::sqrt(quietest_block(amplitude, block));
  if (std::isfinite(quietest)) {
    const float weight =
        std::max(1.0f - config_.averaging_factor, 1.0f / static_cast<float>(n_averaged_ + 1));
    floor_ += weight * (quietest - floor_);
    n_averaged_ = std::min(n_averaged_ + 1, 1 << 20);
  }
  const float least = config_.factor * config_.factor * floor_ * floor_;
  for (float& value : threshold) value = std::max(value, least);
  return Status::kOk;
}

}  // namespace echofuse::node
