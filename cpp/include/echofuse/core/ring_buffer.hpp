#pragma once

#include <cstddef>
#include <new>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/check.hpp"

namespace echofuse {

template <class T, std::size_t kCapacity = kAnyCapacity>
class RingBuffer;

/// First in, first out, of fixed capacity; index 0 is the oldest. Capacity-erased like BoundedVector.
template <class T>
class RingBuffer<T, kAnyCapacity> {
 public:
  using value_type = T;

  RingBuffer(const RingBuffer&) = delete;
  RingBuffer& operator=(const RingBuffer&) = delete;

  /// False when full, and then nothing changes.
  [[nodiscard]] bool try_push_back(const T& value) {
    if (full()) return false;
    ::new (static_cast<void*>(data_ + slot(size_))) T(value);
    ++size_;
    return true;
  }

  /// Always stores; when full the oldest element makes room. True when one was dropped.
  bool push_back_dropping_oldest(const T& value) {
    const T copy = value;  // `value` may be the very element that is dropped
    const bool dropped = full();
    if (dropped) pop_front();
    ::new (static_cast<void*>(data_ + slot(size_))) T(copy);
    ++size_;
    return dropped;
  }

  void pop_front() {
    ECHOFUSE_CHECK(size_ > 0);
    first_ = slot(1);
    --size_;
  }

  void clear() {
    first_ = 0;
    size_ = 0;
  }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == capacity_; }

  T& operator[](std::size_t index) {
    ECHOFUSE_DEBUG_CHECK(index < size_);
    return data_[slot(index)];
  }
  const T& operator[](std::size_t index) const {
    ECHOFUSE_DEBUG_CHECK(index < size_);
    return data_[slot(index)];
  }
  T& front() {
    ECHOFUSE_CHECK(size_ > 0);
    return data_[first_];
  }
  const T& front() const {
    ECHOFUSE_CHECK(size_ > 0);
    return data_[first_];
  }
  T& back() {
    ECHOFUSE_CHECK(size_ > 0);
    return data_[slot(size_ - 1)];
  }
  const T& back() const {
    ECHOFUSE_CHECK(size_ > 0);
    return data_[slot(size_ - 1)];
  }

 protected:
  RingBuffer(T* data, std::size_t capacity) : data_(data), capacity_(capacity) {}
  ~RingBuffer() = default;

 private:
  /// Where the element `index` places after the oldest lies; index <= capacity.
  std::size_t slot(std::size_t index) const {
    const std::size_t place = first_ + index;
    return place < capacity_ ? place : place - capacity_;
  }

  T* data_;
  std::size_t capacity_;
  std::size_t first_ = 0;  ///< where the oldest element lies
  std::size_t size_ = 0;
};

template <class T, std::size_t kCapacity>
class RingBuffer : private BoundedStorage<T, kCapacity>, public RingBuffer<T> {
 public:
  RingBuffer() : RingBuffer<T>(BoundedStorage<T, kCapacity>::room(), kCapacity) {}
};

}  // namespace echofuse
