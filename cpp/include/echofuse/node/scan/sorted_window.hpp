#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "echofuse/core/check.hpp"

namespace echofuse::node {

/// Up to kMaxSize numbers in ascending order, each found by binary search: the rank of an ordered-statistic
/// detector without sorting a window for every cell. No NaN.
template <std::size_t kMaxSize>
class SortedWindow {
 public:
  void insert(float value) {
    ECHOFUSE_CHECK(size_ < kMaxSize);
    const std::size_t place = lower_bound(value);
    std::memmove(&values_[place] + 1, &values_[place], (size_ - place) * sizeof(float));
    values_[place] = value;
    ++size_;
  }

  /// value must be one of the numbers.
  void remove(float value) {
    const std::size_t place = lower_bound(value);
    ECHOFUSE_CHECK(place < size_ && values_[place] == value);
    --size_;
    std::memmove(&values_[place], &values_[place] + 1, (size_ - place) * sizeof(float));
  }

  /// remove(old_value) and insert(new_value), moving only what lies between the two.
  void replace(float old_value, float new_value) {
    std::size_t place = lower_bound(old_value);
    ECHOFUSE_CHECK(place < size_ && values_[place] == old_value);
    for (; place + 1 < size_ && values_[place + 1] < new_value; ++place) values_[place] = values_[place + 1];
    for (; place > 0 && values_[place - 1] > new_value; --place) values_[place] = values_[place - 1];
    values_[place] = new_value;
  }

  /// The rank-th smallest, from 1.
  float ranked(std::size_t rank) const {
    ECHOFUSE_CHECK(rank >= 1 && rank <= size_);
    return values_[rank - 1];
  }

  std::size_t size() const { return size_; }

 private:
  std::size_t lower_bound(float value) const {
    std::size_t low = 0;
    std::size_t high = size_;
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      if (values_[middle] < value)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }

  std::size_t size_ = 0;
  std::array<float, kMaxSize + 1> values_{};  ///< one more, so that the place behind the last can be named
};

}  // namespace echofuse::node
