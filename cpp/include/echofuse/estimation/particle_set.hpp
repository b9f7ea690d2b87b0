#pragma once

#include <cstddef>

#include "echofuse/core/span.hpp"

namespace echofuse::estimation {

/// One hypothesis of a moving point, five floats in a row, so that a particle set is its own tap.
struct Particle {
  float x_m;
  float vx_mps;
  float y_m;
  float vy_mps;
  float weight;  ///< [1] expected targets, or probability, that it stands for
};
inline constexpr std::size_t kParticleColumns = 5;
static_assert(sizeof(Particle) == kParticleColumns * sizeof(float), "particles are shown as rows of floats");

/// Sum of the weights, compensated.
float total_weight(Span<const Particle> particles);

/// The same memory as (n, 5) values, row by row: x, vx, y, vy, weight.
Span<const float> as_rows(Span<const Particle> particles);

}  // namespace echofuse::estimation
