#include <doctest/doctest.h>

#include <cstring>

#include "echofuse/core/status.hpp"

namespace echofuse {

TEST_CASE("every status has a name of its own") {
  constexpr int kCodes = 5;
  for (int i = 0; i < kCodes; ++i) {
    CHECK(std::strcmp(name(static_cast<Status>(i)), "unknown") != 0);
    for (int j = 0; j < i; ++j)
      CHECK(std::strcmp(name(static_cast<Status>(i)), name(static_cast<Status>(j))) != 0);
  }
  CHECK(std::strcmp(name(static_cast<Status>(kCodes)), "unknown") == 0);
}

}  // namespace echofuse
