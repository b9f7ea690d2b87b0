#include <doctest/doctest.h>

#include <array>
#include <type_traits>

#include "echofuse/core/span.hpp"

namespace echofuse {
namespace {

float sum(Span<const float> values) {
  float total = 0.0f;
  for (const float value : values) total += value;
  return total;
}

}  // namespace

TEST_CASE("a span is made from whatever holds elements in a row") {
  float in_c[3] = {1.0f, 2.0f, 3.0f};
  const float constant_c[2] = {4.0f, 5.0f};
  std::array<float, 3> in_array = {6.0f, 7.0f, 8.0f};
  const std::array<float, 1> constant_array = {9.0f};
  const Span<float> writable(in_c, 2);

  CHECK(sum(in_c) == 6.0f);
  CHECK(sum(constant_c) == 9.0f);
  CHECK(sum(in_array) == 21.0f);
  CHECK(sum(constant_array) == 9.0f);
  CHECK(sum(writable) == 3.0f);
  CHECK(sum({in_c, 1}) == 1.0f);
  CHECK(Span<const float>().empty());
}

TEST_CASE("const is never lost") {
  CHECK_FALSE(std::is_convertible_v<Span<const float>, Span<float>>);
  CHECK_FALSE(std::is_convertible_v<const std::array<float, 2>&, Span<float>>);
  CHECK(std::is_convertible_v<Span<float>, Span<const float>>);
}

TEST_CASE("parts share the elements of the whole") {
  std::array<int, 5> values = {0, 1, 2, 3, 4};
  const Span<int> whole = values;
  whole.subspan(1, 3)[0] = 10;
  CHECK(values[1] == 10);
  CHECK(whole.first(2).size() == 2);
  CHECK(whole.first(2)[1] == 10);
  CHECK(whole.last(2)[0] == 3);
  CHECK(whole.subspan(4)[0] == 4);
  CHECK(whole.subspan(5).empty());
  CHECK(whole.first(0).empty());
}

}  // namespace echofuse
