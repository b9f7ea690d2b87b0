#include "echofuse/signal/alignment.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/core/constants.hpp"

namespace echofuse::signal {
namespace {

constexpr int kTile =
    8;  ///< neighbouring sums made at once: as many accumulators and samples fit into 32 registers
constexpr int kProductsPerBlock = 64;  ///< partial sums keep the rounding error of a float sum small

constexpr float kLeastFraction = 1e-7f;  ///< [sample] less than float32 can tell from 0 beside 1

/// Sum of products of one range of the reference with the envelope at one shift.
float sum_of_products(const float* envelope, const float* reference, int count) {
  float sum = 0.0f;
  for (int begin = 0; begin < count; begin += kProductsPerBlock) {
    const int end = std::min(count, begin + kProductsPerBlock);
    float block = 0.0f;
    for (int k = begin; k < end; ++k) block += reference[k] * envelope[k];
    sum += block;
  }
  return sum;
}

/// sums[j] = sum_i taps[i] input[i + j] for kTile neighbours j: every tap and every sample is loaded once for all of
/// them. The window goes round instead of being moved; the pragmas turn its places and the sums into registers.
inline void filter_tile(const float* input, const float* taps, int n_taps, float* sums) {
  float sum[kTile];
  float window[kTile];  // input[i + j] at place (i + j) % kTile
#pragma GCC unroll 8
  for (int j = 0; j < kTile; ++j) {
    sum[j] = 0.0f;
    window[j] = input[j];
  }
  int i = 0;
  for (; i + kTile <= n_taps; i += kTile) {
#pragma GCC unroll 8
    for (int t = 0; t < kTile; ++t) {
      window[(t + kTile - 1) % kTile] = input[i + t + kTile - 1];
      const float tap = taps[i + t];
#pragma GCC unroll 8
      for (int j = 0; j < kTile; ++j) sum[j] += tap * window[(t + j) % kTile];
    }
  }
  for (; i < n_taps; ++i) {
    const float tap = taps[i];
#pragma GCC unroll 8
    for (int j = 0; j < kTile; ++j) sum[j] += tap * input[i + j];
  }
#pragma GCC unroll 8
  for (int j = 0; j < kTile; ++j) sums[j] = sum[j];
}

/// The sum of products at kTile neighbouring shifts, added to sums.
void add_products_at_shifts(const float* envelope, const float* reference, int count, float* sums) {
  for (int begin = 0; begin < count; begin += kProductsPerBlock) {
    float block[kTile];
    filter_tile(envelope + begin, reference + begin, std::min(count - begin, kProductsPerBlock), block);
    for (int j = 0; j < kTile; ++j) sums[j] += block[j];
  }
}

/// One output of a filter whose taps may lie outside of the input, from input[source] on.
float at_end(Span<const float> input, Span<const float> taps, int n_taps, int source) {
  const int end = std::min(n_taps, static_cast<int>(input.size()) - source);
  float sum = 0.0f;
  for (int i = std::max(0, -source); i < end; ++i)
    sum += taps[static_cast<std::size_t>(i)] * input[static_cast<std::size_t>(source + i)];
  return sum;
}

/// The reference's samples [first, last) whose partner at `shift` lies inside the envelope.
struct Range {
  int first;
  int last;
};
Range inside(Range range, int shift, int n_samples) {
  return {std::max(range.first, -shift), std::min(range.last, n_samples - shift)};
}

/// The products of the reference's samples [range) with the envelope `shift` later, added to sum.
void add_range(Span<const float> envelope, Span<const float> reference, Range range, int shift, float* sum) {
  if (range.first >= range.last) return;
  *sum += sum_of_products(envelope.data() + (range.first + shift), reference.data() + range.first,
                          range.last - range.first);
}

float energy(Span<const float> values, Range range) {
  float sum = 0.0f;
  add_range(values, values, range, 0, &sum);
  return sum;
}

/// products[i] = correlation sum at shift lowest + i.
void correlate(Span<const float> envelope, Span<const float> reference, Range range, int lowest, int n_shifts,
               float* products) {
  const int n_samples = static_cast<int>(envelope.size());
  std::fill(products, products + n_shifts, 0.0f);
  int i = 0;
  for (; i + kTile <= n_shifts; i += kTile) {
    const int shift = lowest + i;
    // Where all shifts have partners at once; then, for each, the few products at the ends.
    const Range common{inside(range, shift, n_samples).first,
                       inside(range, shift + kTile - 1, n_samples).last};
    if (common.first >= common.last) break;
    add_products_at_shifts(envelope.data() + (common.first + shift), reference.data() + common.first,
                           common.last - common.first, products + i);
    for (int j = 0; j < kTile; ++j) {
      const Range own = inside(range, shift + j, n_samples);
      add_range(envelope, reference, {own.first, common.first}, shift + j, products + i + j);
      add_range(envelope, reference, {common.last, own.last}, shift + j, products + i + j);
    }
  }
  for (; i < n_shifts; ++i)
    add_range(envelope, reference, inside(range, lowest + i, n_samples), lowest + i, products + i);
}

/// Vertex of the parabola through the products at shift - 1, shift and shift + 1, relative to shift. Sums of
/// differences instead of differences of sums, which would leave 1e-5 samples of rounding error.
float parabola_vertex(Span<const float> envelope, Span<const float> reference, Range range, int shift) {
  const int n_samples = static_cast<int>(envelope.size());
  const auto at = [&](int k) {
    return k >= 0 && k < n_samples ? envelope[static_cast<std::size_t>(k)] : 0.0f;
  };
  float slope = 0.0f;
  float curvature = 0.0f;
  for (int begin = range.first; begin < range.last; begin += kProductsPerBlock) {
    const int end = std::min(range.last, begin + kProductsPerBlock);
    float block_slope = 0.0f;
    float block_curvature = 0.0f;
    float before = at(begin + shift - 1);
    float here = at(begin + shift);
    for (int k = begin; k < end; ++k) {
      const float after = at(k + shift + 1);
      const float value = reference[static_cast<std::size_t>(k)];
      block_slope += value * (before - after);
      block_curvature += value * ((before - here) - (here - after));
      before = here;
      here = after;
    }
    slope += block_slope;
    curvature += block_curvature;
  }
  return curvature < 0.0f ? 0.5f * slope / curvature : 0.0f;
}

}  // namespace

const char* invalid_field(const AlignmentConfig& config) {
  if (config.method != AlignmentMethod::kSubSample && config.method != AlignmentMethod::kInteger &&
      config.method != AlignmentMethod::kNone)
    return "method";
  if (config.max_shift_samples < 1 || config.max_shift_samples > static_cast<int>(kMaxAlignmentShift))
    return "max_shift_samples";
  if (config.window_samples < 8) return "window_samples";
  if (config.interpolator_half_length_samples < 2 ||
      config.interpolator_half_length_samples > static_cast<int>(kMaxInterpolatorHalfLength))
    return "interpolator_half_length_samples";
  return nullptr;
}

Status Aligner::configure(const AlignmentConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  const int half_length = config.interpolator_half_length_samples;
  for (int j = -half_length + 1; j <= half_length; ++j) {
    const float angle = kPi * static_cast<float>(j) / static_cast<float>(half_length);
    window_cosine_[static_cast<std::size_t>(j + half_length - 1)] = std::cos(angle);
    window_sine_[static_cast<std::size_t>(j + half_length - 1)] = std::sin(angle);
  }
  configured_ = true;
  return Status::kOk;
}

Status Aligner::estimate(Span<const float> envelope, Span<const float> reference, int coarse_shift, int first,
                         int last, Alignment& alignment) const {
  alignment = Alignment{};
  if (!configured_) return Status::kNotConfigured;
  const int n_samples = static_cast<int>(envelope.size());
  if (envelope.size() != reference.size() || first < 0 || last > n_samples || first >= last)
    return Status::kInvalidInput;
  if (coarse_shift < -n_samples || coarse_shift > n_samples) return Status::kInvalidInput;
  const bool searches = config_.method != AlignmentMethod::kNone;
  const int reach = searches ? config_.max_shift_samples : 0;
  const int lowest = (searches ? coarse_shift : 0) - reach;
  const int n_shifts = 2 * reach + 1;

  float products[2 * kMaxAlignmentShift + 1];
  correlate(envelope, reference, {first, last}, lowest, n_shifts, products);
  const int best = static_cast<int>(std::max_element(products, products + n_shifts) - products);
  const int shift = lowest + best;
  const Range matched = inside({first, last}, shift, n_samples);
  const float norm = std::sqrt(energy(reference, {first, last})) *
                     std::sqrt(energy(envelope, {matched.first + shift, matched.last + shift}));
  if (norm > 0.0f) alignment.correlation = products[best] / norm;

  alignment.shift_samples = static_cast<float>(shift);
  if (config_.method == AlignmentMethod::kSubSample && best > 0 && best < n_shifts - 1)
    alignment.shift_samples += parabola_vertex(envelope, reference, {first, last}, shift);
  return Status::kOk;
}

/// sinc(j - fraction) is proportional to (-1)^j / (fraction - j), and the sum of the taps is made 1.
void Aligner::interpolator(float fraction, Taps& taps) const {
  const int half_length = config_.interpolator_half_length_samples;
  const float angle = kPi * fraction / static_cast<float>(half_length);
  const float cosine = std::cos(angle);
  const float sine = std::sin(angle);
  float sum = 0.0f;
  for (int j = -half_length + 1; j <= half_length; ++j) {
    const auto i = static_cast<std::size_t>(j + half_length - 1);
    const float c = window_cosine_[i] * cosine + window_sine_[i] * sine;
    const float window = 0.42f + 0.5f * c + 0.08f * (2.0f * c * c - 1.0f);
    const float sign = j % 2 == 0 ? 1.0f : -1.0f;
    taps[i] = sign * window / (fraction - static_cast<float>(j));
    sum += taps[i];
  }
  const float scale = 1.0f / sum;
  for (int i = 0; i < 2 * half_length; ++i) taps[static_cast<std::size_t>(i)] *= scale;
}

Status Aligner::shift(Span<const float> input, float shift_samples, Span<float> output) const {
  if (!configured_) return Status::kNotConfigured;
  const int n_samples = static_cast<int>(input.size());
  if (input.size() != output.size() || !(std::abs(shift_samples) <= static_cast<float>(n_samples)))
    return Status::kInvalidInput;
  const float floor = std::floor(shift_samples);
  const float fraction = shift_samples - floor;
  const int whole = static_cast<int>(floor) + (fraction < 1.0f ? 0 : 1);  // 1 - 1e-9 is 1 in float32
  Taps taps{};
  int n_taps = 1;
  int offset = whole;  // of the first tap's source from the output's sample
  taps[0] = 1.0f;
  if (fraction > kLeastFraction && fraction < 1.0f) {
    interpolator(fraction, taps);
    n_taps = 2 * config_.interpolator_half_length_samples;
    offset = whole - config_.interpolator_half_length_samples + 1;
  }
  const Range inner = inside({0, n_samples}, offset, n_samples - n_taps + 1);  // all taps inside the input
  int k = 0;
  for (; k < std::min(inner.first, n_samples); ++k)
    output[static_cast<std::size_t>(k)] = at_end(input, taps, n_taps, k + offset);
  for (; k + kTile <= inner.last; k += kTile)
    filter_tile(input.data() + (k + offset), taps.data(), n_taps, output.data() + k);
  for (; k < n_samples; ++k) output[static_cast<std::size_t>(k)] = at_end(input, taps, n_taps, k + offset);
  return Status::kOk;
}

}  // namespace echofuse::signal
