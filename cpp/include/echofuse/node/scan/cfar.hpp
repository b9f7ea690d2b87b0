#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

inline constexpr std::size_t kMaxTrainingCells = 64;  ///< per side: 1.2 m of path at 16.4 GHz
inline constexpr std::size_t kMaxCfarBuffer = 128;    ///< five times the paper's buffer

enum class CfarMethod : std::uint8_t {
  kDoubleThresholdBuffer,  ///< Algorithm 1 in both directions, decisions joined by OR
  kCellAveraging,          ///< mean of the training cells, equation (14)
  kGlobalAverage,          ///< mean of all cells but the guarded ones
  kOrderedStatistic,       ///< one of the training cells, by rank
};

struct CfarConfig {
  CfarMethod method = CfarMethod::kDoubleThresholdBuffer;
  float false_alarm_probability =
      1e-4f;                         ///< per sample of exponential power, in [1e-9, 0.5]; not for the buffer
  int training_cells_per_side = 32;  ///< [sample] cell averaging, ordered statistic; >= 1
  int guard_cells_per_side = 16;     ///< [sample] skipped next to the tested one (half an echo), >= 0
  float ordered_rank_fraction = 0.75f;  ///< rank over number of training cells, in (0, 1]
  float local_factor = 5.0f;            ///< buffer: weight of the local power, > 0
  float global_factor = 8.0f;           ///< buffer: weight of the global power, >= 0
  int buffer_samples = 25;              ///< [sample] buffer: below-threshold ones that make the local power
  int max_rises = 4;                    ///< buffer: more rises than these freeze the local power
  float rise_threshold_factor = 0.1f;   ///< buffer: a rise, over the global power; > 0
};

const char* invalid_field(const CfarConfig& config);

/// Decides for each sample of a rectified amplitude d (sensor-radar paper, Sec. IV-E): d^2 > threshold.
/// Training windows are cut at the ends and the factor is that of the cells left, so the false-alarm rate
/// holds there too. Factors: N (P_fa^(-1/N) - 1) for means; for the k-th of N the root of
/// P_fa = prod (N - i) / (N - i + alpha), i < k.
/// Reference: python/echofuse/reference/node/scan/cfar.py
class CfarDetector {
 public:
  Status configure(const CfarConfig& config);

  /// amplitude: (n_samples,) [count], magnitudes up to 1e15. threshold: (n_samples,) [count^2]; the lower of
  /// both directions for the buffer. decisions: (n_samples,) 0 or 1. None may overlap.
  /// kInvalidInput: fewer than min_samples(), different lengths, or a value that is not finite.
  Status process(Span<const float> amplitude, Span<float> threshold, Span<std::uint8_t> decisions) const;

  /// The shortest scan that can be judged.
  int min_samples() const;

  /// Threshold over the mean of n_cells exponential cells; over the ranked one for ordered statistic.
  float factor(int n_cells) const;

 private:
  void cell_averaging(Span<const float> amplitude, Span<float> threshold) const;
  void global_average(Span<const float> amplitude, Span<float> threshold) const;
  void ordered_statistic(Span<const float> amplitude, Span<float> threshold) const;
  void double_threshold_buffer(Span<const float> amplitude, Span<float> threshold) const;
  template <int kStep>
  void buffer_pass(const float* amplitude, float* threshold, int n_samples, float global_power) const;
  int rank(int n_cells) const;

  bool configured_ = false;
  CfarConfig config_;
  float log_probability_ = 0.0f;                                ///< -ln P_fa
  std::array<float, 2 * kMaxTrainingCells + 1> rank_factor_{};  ///< ordered statistic: by number of cells
};

}  // namespace echofuse::node
