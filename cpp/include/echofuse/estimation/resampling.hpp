#pragma once

#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::estimation {

/// Systematic resampling (Kitagawa, J. Computational and Graphical Statistics 5, 1996).
/// weights: (n,) >= 0, n <= 65535. uniform in [0, 1). indices: (n_out,) filled, ascending; the k-th pointer
/// (k + uniform) * total / n_out falls on the first index whose cumulative weight exceeds it.
/// kInvalidInput: no weight at all; indices untouched.
/// Reference: python/echofuse/reference/estimation/resampling.py
Status systematic_resample(Span<const float> weights, float uniform, Span<std::uint16_t> indices);

}  // namespace echofuse::estimation
