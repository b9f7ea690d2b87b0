#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

/// [sample] What the filter remembers: one background, or the scans of a frame difference (lag * n_samples).
inline constexpr std::size_t kMaxClutterMemory = 3 * kMaxSamplesPerScan;

enum class ClutterMethod : std::uint8_t {
  kEmptyRoomEnvelope,   ///< envelope - envelope of the empty room, equation (13)
  kEmptyRoomScan,       ///< scan - scan of the empty room, before the envelope
  kEmptyRoomShadowed,   ///< the same, where the empty room may have been weakened by people's shadows
  kExponentialAverage,  ///< scan - its exponentially weighted mean so far
  kFrameDifference,     ///< scan - an earlier scan
};

struct ClutterConfig {
  ClutterMethod method = ClutterMethod::kEmptyRoomEnvelope;
  float averaging_factor = 0.95f;  ///< weight of the past in the exponential average, in (0, 1)
  int learning_scans = 20;         ///< scans averaged into a background that nobody gave, >= 1
  int difference_lag_scans = 1;    ///< frame difference: how much earlier, >= 1
  int shadow_window_samples = 31;  ///< [sample] kEmptyRoomShadowed: a shadow is alike so long, odd, 3 to 127
};

const char* invalid_field(const ClutterConfig& config);

/// True when the method works on envelopes, false when on scans.
bool uses_envelope(ClutterMethod method);

/// Removes what stands still (sensor-radar paper, Sec. IV-D). The background is the mean of empty-room scans,
/// or, where there are none, of the first learning_scans. The exponential average starts as a plain mean.
/// kEmptyRoomShadowed subtracts what of the background is still there: around each sample, weighted by a
/// triangle, the scan is fitted by the background times a complex gain of at most 1 (of the background and its
/// slope, which is its quadrature, as a band-pass signal's slope is). A person in front of a wall weakens its
/// echo; subtracted whole, the wall's echo would appear as a second person.
/// Reference: python/echofuse/reference/node/scan/clutter.py
class ClutterFilter {
 public:
  /// Forgets the background as well. kInvalidConfig: also when lag * n_samples exceeds the memory.
  Status configure(const ClutterConfig& config, int n_samples);

  void reset();

  /// One aligned empty-room scan (or envelope), (n_samples,) [count]: averaged into the background. The first
  /// takes the place of what was learnt. Frame difference has no use for it.
  Status add_empty_room(Span<const float> samples);

  /// residual = samples - background, signed, (n_samples,) [count]; all 0 while !ready() on entry, when the
  /// samples are learnt instead. samples and residual may be the same.
  Status process(Span<const float> samples, Span<float> residual);

  /// The next process() gives a residual.
  bool ready() const;

 private:
  void learn(Span<const float> samples, float weight);
  void subtract_shadowed(Span<const float> samples, Span<float> residual) const;
  float slope(std::size_t k) const;
  void difference(Span<const float> samples, Span<float> residual, bool subtract);

  ClutterConfig config_;
  std::size_t n_samples_ = 0;  ///< 0 until configured
  int n_averaged_ = 0;         ///< scans in the background; scans in the history of a frame difference
  int n_empty_room_ = 0;       ///< of which empty-room ones
  std::size_t oldest_ = 0;     ///< frame difference: place of the oldest scan, in scans
  std::array<float, kMaxClutterMemory> memory_{};
};

/// Half-wave rectifier (ghost mitigation): a person adds energy, what got weaker is a shadow. (n_samples,)
void rectify(Span<float> samples);

}  // namespace echofuse::node
