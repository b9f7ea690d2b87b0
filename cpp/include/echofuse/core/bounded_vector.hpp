#pragma once

#include <cstddef>
#include <new>
#include <type_traits>

#include "echofuse/core/check.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse {

inline constexpr std::size_t kAnyCapacity = 0;

template <class T, std::size_t kCapacity = kAnyCapacity>
class BoundedVector;

/// Raw room for kCapacity elements; nothing is constructed until it is pushed.
template <class T, std::size_t kCapacity>
class BoundedStorage {
  static_assert(kCapacity > 0, "a capacity is at least one");
  static_assert(std::is_trivially_destructible_v<T>, "elements are dropped without a destructor");

 protected:
  T* room() { return reinterpret_cast<T*>(bytes_); }

 private:
  alignas(T) unsigned char bytes_[kCapacity * sizeof(T)];
};

/// Capacity-erased: stages take `BoundedVector<T>&`, so their code is compiled once for all capacities.
template <class T>
class BoundedVector<T, kAnyCapacity> {
 public:
  using value_type = T;

  BoundedVector(const BoundedVector&) = delete;
  BoundedVector& operator=(const BoundedVector&) = delete;

  /// False when full, and then nothing changes.
  [[nodiscard]] bool try_push_back(const T& value) {
    if (full()) return false;
    ::new (static_cast<void*>(data_ + size_)) T(value);
    ++size_;
    return true;
  }

  /// Exactly n elements: kept ones as they are, new ones value-initialised.
  /// kTruncated: n exceeds the capacity, and the size is the capacity.
  Status resize_within(std::size_t n) {
    const std::size_t target = n < capacity_ ? n : capacity_;
    for (; size_ < target; ++size_) ::new (static_cast<void*>(data_ + size_)) T();
    size_ = target;
    return n > capacity_ ? Status::kTruncated : Status::kOk;
  }

  /// The elements of `values`, which must not overlap this vector. kTruncated: the first capacity() of them.
  Status assign(Span<const T> values) {
    clear();
    for (const T& value : values)
      if (!try_push_back(value)) return Status::kTruncated;
    return Status::kOk;
  }

  void pop_back() {
    ECHOFUSE_CHECK(size_ > 0);
    --size_;
  }

  /// Removes one element and keeps the order of the others.
  void erase_at(std::size_t index) {
    ECHOFUSE_CHECK(index < size_);
    for (std::size_t next = index + 1; next < size_; ++next) data_[next - 1] = data_[next];
    --size_;
  }

  void clear() { size_ = 0; }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == capacity_; }

  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

  T& operator[](std::size_t index) {
    ECHOFUSE_DEBUG_CHECK(index < size_);
    return data_[index];
  }
  const T& operator[](std::size_t index) const {
    ECHOFUSE_DEBUG_CHECK(index < size_);
    return data_[index];
  }
  T& back() {
    ECHOFUSE_CHECK(size_ > 0);
    return data_[size_ - 1];
  }
  const T& back() const {
    ECHOFUSE_CHECK(size_ > 0);
    return data_[size_ - 1];
  }

  Span<T> span() { return {data_, size_}; }
  Span<const T> span() const { return {data_, size_}; }

 protected:
  BoundedVector(T* data, std::size_t capacity) : data_(data), capacity_(capacity) {}
  ~BoundedVector() = default;

 private:
  T* data_;
  std::size_t capacity_;
  std::size_t size_ = 0;
};

/// Storage is the first base, so it exists when the erased base takes its address (GCC warns otherwise).
template <class T, std::size_t kCapacity>
class BoundedVector : private BoundedStorage<T, kCapacity>, public BoundedVector<T> {
 public:
  BoundedVector() : BoundedVector<T>(BoundedStorage<T, kCapacity>::room(), kCapacity) {}
};

}  // namespace echofuse
