#include "echofuse/estimation/resampling.hpp"

#include "echofuse/core/compensated_sum.hpp"

namespace echofuse::estimation {

Status systematic_resample(Span<const float> weights, float uniform, Span<std::uint16_t> indices) {
  CompensatedSum total;
  std::size_t last = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    total.add(weights[i]);
    if (weights[i] > 0.0f) last = i;
  }
  if (!(total.value() > 0.0f) || weights.size() > 65535u) return Status::kInvalidInput;

  const float step = total.value() / static_cast<float>(indices.size());
  CompensatedSum cumulative;
  cumulative.add(weights[0]);
  std::size_t index = 0;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const float pointer = (static_cast<float>(k) + uniform) * step;
    while (index < last && !(cumulative.value() > pointer)) cumulative.add(weights[++index]);
    indices[k] = static_cast<std::uint16_t>(index);
  }
  return Status::kOk;
}

}  // namespace echofuse::estimation
