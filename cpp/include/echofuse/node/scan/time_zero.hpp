#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

struct TimeZeroConfig {
  int learning_responses = 5;  ///< whose mean shows the cross-talk, >= 1
  float strong_fraction =
      0.5f;  ///< of the largest magnitude: a maximum that may be the cross-talk, in (0, 1]
  float least_peak_factor = 10.0f;  ///< largest over mean magnitude, below which there is no cross-talk, > 1
  int moved_samples = 2;            ///< [sample] farther away, the cross-talk has moved, >= 0
  int moved_responses = 3;  ///< in a row with the cross-talk elsewhere: the radar was switched on anew, >= 1
};

const char* invalid_field(const TimeZeroConfig& config);

struct TimeZeroResult {
  bool found = false;             ///< the response is rotated
  bool moved = false;             ///< what was learnt of the responses so far is void
  int rotation_samples = 0;       ///< [sample] to the left
  float fraction_samples = 0.0f;  ///< [sample] of the cross-talk behind its own, in [-0.5, 0.5]
};

/// Time zero of an M-sequence radar (through-wall paper, Sec. 2): its response begins with a random chip at each
/// power-up, and repeats itself after n_samples. The first strong maximum is the cross-talk between the antennas, the
/// one with the longest rest before it; responses are turned until it stands where its way takes it.
/// Reference: python/echofuse/reference/node/scan/time_zero.py
class TimeZeroFinder {
 public:
  /// n_samples: 3 to kMaxResponseSamples. expected_samples: of the cross-talk behind transmission, >= 0.
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const TimeZeroConfig& config, int n_samples, float expected_samples);

  void reset();

  /// response: (n_samples,) [count]. rotated: its first 1 to n_samples once turned, not in the same place; all 0 where
  /// nothing was found.
  Status process(Span<const float> response, Span<float> rotated, TimeZeroResult& result);

  /// [sample] the cross-talk's place in what is rotated, its fraction apart
  int expected_samples() const { return expected_; }

 private:
  struct CrossTalk {
    bool found = false;
    int sample = 0;
    float fraction_samples = 0.0f;
  };

  CrossTalk cross_talk(Span<const float> response) const;
  void learn(Span<const float> response);

  TimeZeroConfig config_;
  int n_samples_ = 0;  ///< 0 until configured
  int expected_ = 0;   ///< [sample]
  int n_learnt_ = 0;
  int elsewhere_ = 0;  ///< responses in a row
  CrossTalk place_;
  std::array<float, kMaxResponseSamples> mean_{};  ///< of the responses learnt
};

}  // namespace echofuse::node
