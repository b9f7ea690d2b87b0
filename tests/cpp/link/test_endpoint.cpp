#include "echofuse/link/endpoint.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdint>

#include "echofuse/link/codec.hpp"

namespace echofuse::link {
namespace {

std::size_t bytes_sent = 0;

TEST_CASE("what an encoder had no room for is counted and not sent") {
  std::array<std::uint8_t, 64> frame;
  Endpoint endpoint(
      frame, [](Span<const std::uint8_t> bytes) { bytes_sent += bytes.size(); }, "test");
  endpoint.start(7, 0);
  bytes_sent = 0;
  endpoint.publish(6200, 0, 0);
  CHECK(endpoint.unsent() == 1);
  CHECK(bytes_sent == 0);
  endpoint.publish(6200, 0, 8);
  CHECK(endpoint.unsent() == 1);
  CHECK(bytes_sent ==
        1 + 1 + kFrameHeaderBytes + 8 + kFrameCrcBytes + 1);  // delimiters and the code of the stuffing
}

}  // namespace
}  // namespace echofuse::link
