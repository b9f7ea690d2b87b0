#include "echofuse/node/scan/cfar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echofuse/core/compensated_sum.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/magnitude.hpp"
#include "echofuse/node/scan/sliding_sum.hpp"
#include "echofuse/node/scan/sorted_window.hpp"

namespace echofuse::node {
namespace {

constexpr float kMaxMagnitude = 1e15f;  ///< squares and their sums stay finite
constexpr float kInfinity = std::numeric_limits<float>::infinity();

float power_at(Span<const float> amplitude, int k) {
  const float value = amplitude[static_cast<std::size_t>(k)];
  return value * value;
}

/// Root of sum_{i<rank} ln(1 + alpha / (N - i)) = -ln P_fa by Newton from 0: the left side is concave, so
/// every step stays on its side of the root.
float ordered_factor(int n_cells, int rank, float log_probability) {
  float factor = 0.0f;
  for (int iteration = 0; iteration < 60; ++iteration) {
    CompensatedSum value;
    CompensatedSum slope;
    for (int i = 0; i < rank; ++i) {
      const auto remaining = static_cast<float>(n_cells - i);
      value.add(std::log1p(factor / remaining));
      slope.add(1.0f / (remaining + factor));
    }
    const float step = (log_probability - value.value()) / slope.value();
    factor += step;
    if (std::abs(step) <= 1e-7f * factor) break;
  }
  return factor;
}

/// Cells of the training window left and right of k that lie inside the scan.
int cells_left(int k, int guard, int training) { return std::clamp(k - guard, 0, training); }
int cells_right(int k, int guard, int training, int n_samples) {
  return std::clamp(n_samples - 1 - k - guard, 0, training);
}

}  // namespace

const char* invalid_field(const CfarConfig& config) {
  if (config.method > CfarMethod::kOrderedStatistic) return "method";
  if (!(config.false_alarm_probability >= 1e-9f && config.false_alarm_probability <= 0.5f))
    return "false_alarm_probability";
  if (config.training_cells_per_side < 1 ||
      config.training_cells_per_side > static_cast<int>(kMaxTrainingCells))
    return "training_cells_per_side";
  if (config.guard_cells_per_side < 0 ||
      config.guard_cells_per_side > static_cast<int>(kMaxSamplesPerScan) / 4)
    return "guard_cells_per_side";
  if (!(config.ordered_rank_fraction > 0.0f && config.ordered_rank_fraction <= 1.0f))
    return "ordered_rank_fraction";
  if (!(config.local_factor > 0.0f && config.local_factor <= 1e6f)) return "local_factor";
  if (!(config.global_factor >= 0.0f && config.global_factor <= 1e6f)) return "global_factor";
  if (config.buffer_samples < 1 || config.buffer_samples > static_cast<int>(kMaxCfarBuffer))
    return "buffer_samples";
  if (config.max_rises < 0) return "max_rises";
  if (!(config.rise_threshold_factor > 0.0f && config.rise_threshold_factor <= 1e6f))
    return "rise_threshold_factor";
  return nullptr;
}

Status CfarDetector::configure(const CfarConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  log_probability_ = -std::log(config.false_alarm_probability);
  if (config.method == CfarMethod::kOrderedStatistic)
    for (int n = 1; n <= 2 * config.training_cells_per_side; ++n)
      rank_factor_[static_cast<std::size_t>(n)] = ordered_factor(n, rank(n), log_probability_);
  configured_ = true;
  return Status::kOk;
}

int CfarDetector::min_samples() const {
  if (config_.method == CfarMethod::kDoubleThresholdBuffer) return 2 * config_.buffer_samples;
  return 2 * (config_.guard_cells_per_side + 1);
}

int CfarDetector::rank(int n_cells) const {
  const float exact = config_.ordered_rank_fraction * static_cast<float>(n_cells);
  return std::clamp(static_cast<int>(std::ceil(exact - 1e-4f)), 1, n_cells);
}

float CfarDetector::factor(int n_cells) const {
  if (!configured_ || n_cells < 1) return 0.0f;
  if (config_.method == CfarMethod::kOrderedStatistic)
    return n_cells <= 2 * config_.training_cells_per_side ? rank_factor_[static_cast<std::size_t>(n_cells)]
                                                          : 0.0f;
  const auto n = static_cast<float>(n_cells);
  return n * std::expm1(log_probability_ / n);
}

Status CfarDetector::process(Span<const float> amplitude, Span<float> threshold,
                             Span<std::uint8_t> decisions) const {
  if (!configured_) return Status::kNotConfigured;
  const std::size_t n_samples = amplitude.size();
  if (threshold.size() != n_samples || decisions.size() != n_samples) return Status::kInvalidInput;
  if (n_samples < static_cast<std::size_t>(min_samples()) || !all_within(amplitude, kMaxMagnitude))
    return Status::kInvalidInput;
  switch (config_.method) {
    case CfarMethod::kCellAveraging:
      cell_averaging(amplitude, threshold);
      break;
    case CfarMethod::kGlobalAverage:
      global_average(amplitude, threshold);
      break;
    case CfarMethod::kOrderedStatistic:
      ordered_statistic(amplitude, threshold);
      break;
    case CfarMethod::kDoubleThresholdBuffer:
      double_threshold_buffer(amplitude, threshold);
      break;
  }
#pragma GCC unroll 8
  for (std::size_t k = 0; k < n_samples; ++k)
    decisions[k] = amplitude[k] * amplitude[k] > threshold[k] ? std::uint8_t{1} : std::uint8_t{0};
  return Status::kOk;
}

void CfarDetector::cell_averaging(Span<const float> amplitude, Span<float> threshold) const {
  const int n_samples = static_cast<int>(amplitude.size());
  const int guard = config_.guard_cells_per_side;
  const int training = config_.training_cells_per_side;
  SlidingSum<kMaxTrainingCells> left(static_cast<std::size_t>(training));
  SlidingSum<kMaxTrainingCells> right(static_cast<std::size_t>(training));
  for (int j = guard + 1; j < guard + training; ++j)
    right.push(j < n_samples ? power_at(amplitude, j) : 0.0f);
  int factor_cells = 0;  // that factor_over_cells is for
  float factor_over_cells = 0.0f;
  for (int k = 0; k < n_samples; ++k) {
    const int entering_left = k - guard - 1;
    const int entering_right = k + guard + training;
    if (entering_left >= 0) left.push(power_at(amplitude, entering_left));
    right.push(entering_right < n_samples ? power_at(amplitude, entering_right) : 0.0f);
    const int n_cells = cells_left(k, guard, training) + cells_right(k, guard, training, n_samples);
    if (n_cells != factor_cells) {
      factor_cells = n_cells;
      factor_over_cells = factor(n_cells) / static_cast<float>(n_cells);
    }
    threshold[static_cast<std::size_t>(k)] = factor_over_cells * (left.value() + right.value());
  }
}

/// Sums from both ends instead of the total less the guarded cells: a loud guarded cell leaves no rounding
/// error.
void CfarDetector::global_average(Span<const float> amplitude, Span<float> threshold) const {
  const int n_samples = static_cast<int>(amplitude.size());
  const int guard = config_.guard_cells_per_side;
  CompensatedSum right;
  for (int k = n_samples - 1; k >= 0; --k) {
    if (k + guard + 1 < n_samples) right.add(power_at(amplitude, k + guard + 1));
    threshold[static_cast<std::size_t>(k)] = right.value();
  }
  CompensatedSum left;
  int factor_cells = 0;
  float factor_over_cells = 0.0f;
  for (int k = 0; k < n_samples; ++k) {
    if (k - guard - 1 >= 0) left.add(power_at(amplitude, k - guard - 1));
    const int n_cells = cells_left(k, guard, n_samples) + cells_right(k, guard, n_samples, n_samples);
    if (n_cells != factor_cells) {
      factor_cells = n_cells;
      factor_over_cells = factor(n_cells) / static_cast<float>(n_cells);
    }
    float& value = threshold[static_cast<std::size_t>(k)];
    value = factor_over_cells * (left.value() + value);
  }
}

void CfarDetector::ordered_statistic(Span<const float> amplitude, Span<float> threshold) const {
  const int n_samples = static_cast<int>(amplitude.size());
  const int guard = config_.guard_cells_per_side;
  const int reach = guard + config_.training_cells_per_side;
  SortedWindow<2 * kMaxTrainingCells> window;
  for (int j = guard + 1; j < std::min(n_samples, reach); ++j) window.insert(power_at(amplitude, j));
  const auto move = [&](int leaving, int entering) {
    if (leaving >= 0 && entering < n_samples)
      window.replace(power_at(amplitude, leaving), power_at(amplitude, entering));
    else if (leaving >= 0)
      window.remove(power_at(amplitude, leaving));
    else if (entering < n_samples)
      window.insert(power_at(amplitude, entering));
  };
  for (int k = 0; k < n_samples; ++k) {
    // The right half: k + guard leaves (for k = 0 it was never in), k + reach enters. The left half likewise.
    move(k > 0 && k + guard < n_samples ? k + guard : -1, k + reach);
    move(k - reach - 1, k - guard - 1 >= 0 ? k - guard - 1 : n_samples);
    const int n_cells = static_cast<int>(window.size());
    threshold[static_cast<std::size_t>(k)] =
        rank_factor_[window.size()] * window.ranked(static_cast<std::size_t>(rank(n_cells)));
  }
}

void CfarDetector::double_threshold_buffer(Span<const float> amplitude, Span<float> threshold) const {
  const int n_samples = static_cast<int>(amplitude.size());
  CompensatedSum power;
#pragma GCC unroll 8
  for (int k = 0; k < n_samples; ++k) power.add(power_at(amplitude, k));
  const float global_power = power.value() / static_cast<float>(n_samples);
  std::fill_n(threshold.begin(), config_.buffer_samples, kInfinity);
  buffer_pass<1>(amplitude.data(), threshold.data(), n_samples, global_power);
  buffer_pass<-1>(amplitude.data() + (n_samples - 1), threshold.data() + (n_samples - 1), n_samples,
                  global_power);
}

/// Algorithm 1 in one direction; the first buffer_samples are not tested. threshold: written by the pass forward, then
/// lowered by the one backward.
template <int kStep>
void CfarDetector::buffer_pass(const float* amplitude, float* threshold, int n_samples,
                               float global_power) const {
  // Copies, which no store through `threshold` can change: they stay in registers.
  const float local_factor = config_.local_factor;
  const float global_level = config_.global_factor * global_power;
  const float rise = config_.rise_threshold_factor * global_power;
  const float fall = 0.5f * rise;
  const float per_cell = 1.0f / static_cast<float>(config_.buffer_samples);
  const int max_rises = config_.max_rises;
  SlidingSum<kMaxCfarBuffer> buffer(static_cast<std::size_t>(config_.buffer_samples));
  float previous = 0.0f;
  int k = 0;
  for (; k < config_.buffer_samples; ++k, amplitude += kStep, threshold += kStep) {
    previous = *amplitude * *amplitude;
    buffer.push(previous);
  }
  bool frozen = false;
  float frozen_power = 0.0f;
  float level =
      local_factor * (buffer.value() * per_cell) + global_level;  // of the local or the frozen power
  int rises = 0;
  for (; k < n_samples; ++k, amplitude += kStep, threshold += kStep) {
    const float power = *amplitude * *amplitude;
    if (kStep > 0 || level < *threshold) *threshold = level;
    if (!(power > level)) {
      buffer.push(power);
      const float local_power = buffer.value() * per_cell;
      if (power > previous + rise)
        ++rises;
      else if (power < previous - fall)
        rises = 0;
      if (!frozen) {
        level = local_factor * local_power + global_level;
        if (rises > max_rises) {
          frozen = true;
          frozen_power = local_power;
        }
      } else if (local_power < frozen_power) {
        level = local_factor * local_power + global_level;
        frozen = false;
        rises = 0;
      }
    }
    previous = power;
  }
}

}  // namespace echofuse::node
