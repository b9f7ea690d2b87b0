#pragma once

#include <array>
#include <cstddef>

#include "echofuse/core/check.hpp"

namespace echofuse::node {

/// Sum of the last `window` values, by additions alone: a running sum from which old values are subtracted
/// would keep the rounding error of a loud one after it has left. Two additions a value: the values fill one
/// block after the other, and the window is the end of the last block and the begin of this one.
template <std::size_t kMaxWindow>
class SlidingSum {
 public:
  /// As if `window` zeros had been pushed; 1 <= window <= kMaxWindow.
  explicit SlidingSum(std::size_t window) : end_(cells_.data() + window) {
    ECHOFUSE_CHECK(window >= 1 && window <= kMaxWindow);
  }
  SlidingSum(const SlidingSum&) = delete;
  SlidingSum& operator=(const SlidingSum&) = delete;

  void push(float value) {
    *next_ = value;
    block_sum_ += value;
    if (++next_ < end_) return;
    float sum = 0.0f;
    while (next_ > cells_.data()) {
      sum += *--next_;
      *next_ = sum;
    }
    block_sum_ = 0.0f;
  }

  float value() const { return block_sum_ + *next_; }

 private:
  /// Before next_ this block's values; from it on the last block's sums, from each place to its end.
  std::array<float, kMaxWindow> cells_{};
  float* next_ = cells_.data();  ///< place of the next value
  float* end_;                   ///< of the window
  float block_sum_ = 0.0f;       ///< of this block so far
};

}  // namespace echofuse::node
