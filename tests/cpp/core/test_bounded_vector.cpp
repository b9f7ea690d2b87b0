#include <doctest/doctest.h>

#include <cstdint>
#include <type_traits>

#include "echofuse/core/bounded_vector.hpp"

namespace echofuse {
namespace {

struct Point {
  float x_m = 1.5f;
  int weight = 2;
};

/// As a stage sees it: without the capacity.
bool push_twice(BoundedVector<int>& values, int value) {
  return values.try_push_back(value) && values.try_push_back(value);
}

}  // namespace

TEST_CASE("a full vector refuses and stays as it is") {
  BoundedVector<int, 3> values;
  CHECK(values.empty());
  CHECK(push_twice(values, 7));
  CHECK_FALSE(push_twice(values, 8));
  CHECK(values.full());
  CHECK(values.size() == 3);
  CHECK(values.capacity() == 3);
  CHECK(values[0] == 7);
  CHECK(values[2] == 8);
  values.clear();
  CHECK(values.empty());
  CHECK(values.try_push_back(9));
  CHECK(values.back() == 9);
}

TEST_CASE("erase_at keeps the order, pop_back takes the last") {
  BoundedVector<int, 4> values;
  for (int i = 0; i < 4; ++i) CHECK(values.try_push_back(i));
  values.erase_at(1);
  REQUIRE(values.size() == 3);
  CHECK(values[0] == 0);
  CHECK(values[1] == 2);
  CHECK(values[2] == 3);
  values.erase_at(2);
  CHECK(values.back() == 2);
  values.pop_back();
  CHECK(values.size() == 1);
}

TEST_CASE("resize_within value-initialises what is new and stops at the capacity") {
  BoundedVector<Point, 3> points;
  CHECK(points.try_push_back({9.0f, 9}));
  CHECK(points.resize_within(2) == Status::kOk);
  CHECK(points[0].weight == 9);
  CHECK(points[1].x_m == 1.5f);
  CHECK(points.resize_within(4) == Status::kTruncated);
  CHECK(points.size() == 3);
  CHECK(points.resize_within(0) == Status::kOk);
  CHECK(points.empty());

  BoundedVector<int, 2> numbers;
  CHECK(numbers.try_push_back(5));
  numbers.clear();
  CHECK(numbers.resize_within(1) == Status::kOk);
  CHECK(numbers[0] == 0);
}

TEST_CASE("assign copies as many as fit") {
  const int source[3] = {1, 2, 3};
  BoundedVector<int, 2> few;
  BoundedVector<int, 3> enough;
  CHECK(few.assign(source) == Status::kTruncated);
  CHECK(few.size() == 2);
  CHECK(enough.assign(source) == Status::kOk);
  CHECK(enough.span().last(1)[0] == 3);
}

TEST_CASE("nothing copies a vector by accident, and it costs its elements and three words") {
  CHECK_FALSE(std::is_copy_constructible_v<BoundedVector<int, 4>>);
  CHECK_FALSE(std::is_copy_assignable_v<BoundedVector<int, 4>>);
  CHECK_FALSE(std::is_default_constructible_v<BoundedVector<int>>);
  CHECK(sizeof(BoundedVector<std::int64_t, 4>) == 4 * sizeof(std::int64_t) + 3 * sizeof(void*));
}

}  // namespace echofuse
