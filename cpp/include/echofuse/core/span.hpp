#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "echofuse/core/check.hpp"

namespace echofuse {

/// A view of n elements in a row that somebody else owns (std::span is C++20).
template <class T>
class Span {
 public:
  using value_type = std::remove_cv_t<T>;

  constexpr Span() = default;
  constexpr Span(T* data, std::size_t size) : data_(data), size_(size) {}

  template <std::size_t kSize>
  constexpr Span(T (&array)[kSize]) : data_(array), size_(kSize) {}

  template <std::size_t kSize>
  constexpr Span(std::array<value_type, kSize>& array) : data_(array.data()), size_(kSize) {}

  template <std::size_t kSize, class U = T, class = std::enable_if_t<std::is_const_v<U>>>
  constexpr Span(const std::array<value_type, kSize>& array) : data_(array.data()), size_(kSize) {}

  /// Span<T> -> Span<const T>.
  template <class U, class = std::enable_if_t<std::is_same_v<const U, T>>>
  constexpr Span(Span<U> other) : data_(other.data()), size_(other.size()) {}

  constexpr T* data() const { return data_; }
  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr T* begin() const { return data_; }
  constexpr T* end() const { return data_ + size_; }

  constexpr T& operator[](std::size_t index) const {
    ECHOFUSE_DEBUG_CHECK(index < size_);
    return data_[index];
  }

  constexpr Span first(std::size_t count) const { return subspan(0, count); }
  constexpr Span last(std::size_t count) const {
    ECHOFUSE_CHECK(count <= size_);
    return Span(data_ + (size_ - count), count);
  }
  constexpr Span subspan(std::size_t offset, std::size_t count) const {
    ECHOFUSE_CHECK(offset <= size_ && count <= size_ - offset);
    return Span(data_ + offset, count);
  }
  constexpr Span subspan(std::size_t offset) const {
    ECHOFUSE_CHECK(offset <= size_);
    return Span(data_ + offset, size_ - offset);
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace echofuse
