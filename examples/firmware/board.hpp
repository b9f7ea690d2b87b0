#pragma once

#include <cstdint>

#include "echofuse/core/span.hpp"

/// What node.cpp needs of the hardware.
namespace board {

/// Waits for the radar's next scan: all of `samples` [count], and when it was taken [us]; negative for a scan of the empty
/// room. False when there will be none.
bool read_scan(echofuse::Span<float> samples, std::int64_t& time_us);

/// Puts bytes on the link, all of them.
void send(echofuse::Span<const std::uint8_t> bytes);

}  // namespace board
