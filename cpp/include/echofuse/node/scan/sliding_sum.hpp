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
  explicit SlidingSum(std::size_t window) : window_(window) {
    ECHOFUSE_CHECK(window >= 1 && window <= kMaxWindow);
  }

  void push(float value) {
    values_[next_] = value;
    block_sum_ += value;
    if (++next_ < window_) return;
    float sum = 0.0f;
    for (std::size_t i = window_; i > 0; --i) {
      sum += values_[i - 1];
      sums_to_end_[i - 1] = sum;
    }
    block_sum_ = 0.0f;
    next_ = 0;
  }

  float value() const { return block_sum_ + sums_to_end_[next_]; }

 private:
  std::size_t window_;
  std::size_t next_ = 0;                         ///< place of the next value in this block
  float block_sum_ = 0.0f;                       ///< of this block so far
  std::array<float, kMaxWindow> values_{};       ///< this block
  std::array<float, kMaxWindow> sums_to_end_{};  ///< of the last block, from each place to its end
};

}  // namespace echofuse::node
