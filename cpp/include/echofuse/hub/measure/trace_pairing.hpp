#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::hub {

enum class PairingRule : std::uint8_t {
  kAssignment,  ///< a trace belongs to one couple, at the least total difference
  kAllPairs,    ///< every combination within the limit: targets and ghosts; completes nothing
};

enum class ClosingRule : std::uint8_t {
  kExact,    ///< the two traces themselves
  kPrinted,  ///< the paper's (3), a sample early, and (11), which takes the widening of (6) for half as wide
};

struct TracePairingConfig {
  PairingRule rule = PairingRule::kAssignment;
  ClosingRule closing = ClosingRule::kExact;
  float separation_m = 0.8f;   ///< [m] between the two receivers, in (0, 10]
  float clock_hz = 4.5e9f;     ///< [Hz] samples of the propagation delay, > 0
  int correction_samples = 1;  ///< [sample] allowed beyond the limit of geometry, in [0, 100]
  int completion_limit = 3;    ///< [1] responses for which a couple is copied, in [0, 1000]
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const TracePairingConfig& config);

struct TraceCouple {
  float delay1_s = 0.0f, delay2_s = 0.0f;  ///< [s]
  float centre = 0.0f;                     ///< [sample] middle of both traces
  std::int32_t completions = 0;            ///< responses for which it was copied; 0: both receivers saw it
};

/// Which traces of two receivers are one target's (through-wall paper, steps 4 to 7). Traces of one target
/// differ by m = round(separation / c clock) + correction samples at most; widened by q = ceil(m / 2) on both
/// sides they meet when they differ by 2 q at most. A trace that is alone is completed by the last response's
/// couple whose centre lies within q of it, unless a couple of this response lies within q of that centre.
/// Reference: python/echofuse/reference/hub/measure/trace_pairing.py
class TracePairing {
 public:
  /// Also resets. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const TracePairingConfig& config);
  void reset() { n_previous_ = 0; }

  /// delay1_s, delay2_s: (n1,), (n2,) [s]. couples: cleared, then filled: pairs by the order of the first receiver's
  /// traces, then completed ones. kTruncated: couples is full. kInvalidInput: more than kMaxDetectionsPerNode traces,
  /// or one that is not finite; nothing changes, no couples.
  Status process(Span<const float> delay1_s, Span<const float> delay2_s, BoundedVector<TraceCouple>& couples);

 private:
  TraceCouple close(float n1, float n2) const;
  bool pair_all(Span<const float> n1, Span<const float> n2, BoundedVector<TraceCouple>& couples) const;
  bool pair_by_assignment(Span<const float> n1, Span<const float> n2, BoundedVector<TraceCouple>& couples);
  bool complete(float trace, BoundedVector<TraceCouple>& couples);

  TracePairingConfig config_;
  float width_ = 0.0f;       ///< [sample] m
  float half_width_ = 0.0f;  ///< [sample] q; 0 until configured
  std::array<TraceCouple, kMaxPointsPerFrame> previous_;
  std::array<float, kMaxDetectionsPerNode * kMaxDetectionsPerNode> cost_{};  ///< [sample]
  std::size_t n_previous_ = 0;
};

}  // namespace echofuse::hub
