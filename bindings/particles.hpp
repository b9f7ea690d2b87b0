#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "common.hpp"
#include "echofuse/core/eigen.hpp"
#include "echofuse/estimation/particle_set.hpp"

namespace echofuse::bindings {

/// A copy as (n, 5): x, vx, y, vy, weight.
inline py::array_t<float> to_rows(Span<const estimation::Particle> particles) {
  const Span<const float> rows = estimation::as_rows(particles);
  py::array_t<float> array(
      {static_cast<py::ssize_t>(particles.size()), static_cast<py::ssize_t>(estimation::kParticleColumns)});
  if (!rows.empty()) std::memcpy(array.mutable_data(), rows.data(), rows.size() * sizeof(float));
  return array;
}

/// From an array (n, 5).
inline std::vector<estimation::Particle> to_particles(const FloatArray& array) {
  const auto rows = as_span_of_rows(array, estimation::kParticleColumns, "particles");
  std::vector<estimation::Particle> particles;
  for (std::size_t i = 0; i < rows.size(); i += estimation::kParticleColumns)
    particles.push_back({rows[i], rows[i + 1], rows[i + 2], rows[i + 3], rows[i + 4]});
  return particles;
}

/// From an array (m, kDimension).
template <int kDimension>
std::vector<Eigen::Matrix<float, kDimension, 1>> to_positions(const FloatArray& array, const char* name) {
  const auto rows = as_span_of_rows(array, kDimension, name);
  std::vector<Eigen::Matrix<float, kDimension, 1>> positions;
  for (std::size_t i = 0; i < rows.size(); i += kDimension) positions.emplace_back(rows.data() + i);
  return positions;
}

template <class T>
Span<const T> view(const std::vector<T>& values) {
  return {values.data(), values.size()};
}

}  // namespace echofuse::bindings
