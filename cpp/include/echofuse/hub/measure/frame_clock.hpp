#pragma once

#include <cstdint>

#include "echofuse/core/constants.hpp"

namespace echofuse::hub {

/// Time from frame to frame, never 0 and never backwards.
class FrameClock {
 public:
  void reset() { *this = FrameClock{}; }

  /// [s] since the last frame; period_s for the first one, and (counted) for one that is not later than the last.
  float step_s(std::int64_t time_us, float period_s) {
    const std::int64_t step_us = time_us - last_time_us_;
    const bool first = first_;
    last_time_us_ = time_us;
    first_ = false;
    if (!first && step_us > 0) return static_cast<float>(step_us) * kSecondsPerMicrosecond;
    if (!first) ++faults_;
    return period_s;
  }

  std::uint32_t faults() const { return faults_; }

 private:
  std::int64_t last_time_us_ = 0;
  bool first_ = true;
  std::uint32_t faults_ = 0;
};

}  // namespace echofuse::hub
