#include "echofuse/estimation/particle_set.hpp"

#include "echofuse/core/compensated_sum.hpp"

namespace echofuse::estimation {

float total_weight(Span<const Particle> particles) {
  CompensatedSum total;
  for (const Particle& particle : particles) total.add(particle.weight);
  return total.value();
}

Span<const float> as_rows(Span<const Particle> particles) {
  return {reinterpret_cast<const float*>(particles.data()), particles.size() * kParticleColumns};
}

}  // namespace echofuse::estimation
