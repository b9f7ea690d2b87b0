#include <doctest/doctest.h>

#include "echofuse/core/ring_buffer.hpp"

namespace echofuse {

TEST_CASE("a full ring refuses, or drops its oldest when asked") {
  RingBuffer<int, 3> ring;
  for (int i = 0; i < 3; ++i) CHECK(ring.try_push_back(i));
  CHECK_FALSE(ring.try_push_back(3));
  CHECK(ring.back() == 2);
  CHECK(ring.push_back_dropping_oldest(3));
  CHECK(ring.size() == 3);
  CHECK(ring.front() == 1);
  CHECK(ring.back() == 3);
}

TEST_CASE("a ring keeps the order over many turns") {
  RingBuffer<int, 4> ring;
  int next_in = 0;
  int next_out = 0;
  for (int turn = 0; turn < 50; ++turn) {
    const int pushes = 1 + turn % 4;
    for (int i = 0; i < pushes && !ring.full(); ++i) CHECK_FALSE(ring.push_back_dropping_oldest(next_in++));
    for (std::size_t i = 0; i < ring.size(); ++i) REQUIRE(ring[i] == next_out + static_cast<int>(i));
    const int pops = 1 + turn % 3;
    for (int i = 0; i < pops && !ring.empty(); ++i) {
      REQUIRE(ring.front() == next_out++);
      ring.pop_front();
    }
  }
  CHECK(next_out > 50);
}

TEST_CASE("the element that is dropped may itself be pushed again") {
  RingBuffer<int, 2> ring;
  CHECK(ring.try_push_back(1));
  CHECK(ring.try_push_back(2));
  RingBuffer<int>& erased = ring;
  CHECK(erased.push_back_dropping_oldest(erased.front()));
  CHECK(ring[0] == 2);
  CHECK(ring[1] == 1);
  ring.clear();
  CHECK(ring.empty());
}

}  // namespace echofuse
