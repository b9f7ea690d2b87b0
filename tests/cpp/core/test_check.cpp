#include <doctest/doctest.h>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/check.hpp"
#include "echofuse/core/ring_buffer.hpp"
#include "echofuse/core/span.hpp"

// check_failed is replaced in main.cpp by one that throws, as a board replaces it by its fault handler.
namespace echofuse {

TEST_CASE("a kept promise costs nothing, a broken one reaches the handler with its text") {
  int evaluations = 0;
  ECHOFUSE_CHECK(++evaluations == 1);
  CHECK(evaluations == 1);
  CHECK_THROWS_WITH(ECHOFUSE_CHECK(evaluations == 2), doctest::Contains("evaluations == 2"));
}

TEST_CASE("parts beyond the end of a span are caught in every build") {
  const int values[3] = {1, 2, 3};
  const Span<const int> span(values);
  CHECK_THROWS(span.first(4));
  CHECK_THROWS(span.last(4));
  CHECK_THROWS(span.subspan(4));
  CHECK_THROWS(span.subspan(2, 2));
  CHECK_THROWS(span.subspan(1, static_cast<std::size_t>(-1)));
}

TEST_CASE("taking from what is empty is caught in every build") {
  BoundedVector<int, 2> vector;
  RingBuffer<int, 2> ring;
  CHECK_THROWS(vector.pop_back());
  CHECK_THROWS(vector.back());
  CHECK_THROWS(vector.erase_at(0));
  CHECK_THROWS(ring.pop_front());
  CHECK_THROWS(ring.front());
  CHECK_THROWS(ring.back());
}

#if ECHOFUSE_DEBUG_CHECKS
TEST_CASE("with debug checks every index is caught") {
  BoundedVector<int, 2> vector;
  RingBuffer<int, 2> ring;
  CHECK(vector.try_push_back(1));
  CHECK(ring.try_push_back(1));
  CHECK_THROWS(vector[1]);
  CHECK_THROWS(ring[1]);
  CHECK_THROWS(vector.span()[1]);
}
#endif

}  // namespace echofuse
