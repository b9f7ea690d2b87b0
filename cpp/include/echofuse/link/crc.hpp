#pragma once

#include <cstdint>

#include "echofuse/core/span.hpp"

namespace echofuse::link {

/// CRC-16/CCITT-FALSE (polynomial 0x1021, from 0xFFFF, not reflected), of a Cyphal/serial header.
std::uint16_t crc16(Span<const std::uint8_t> bytes);

/// CRC-32C (Castagnoli, reflected, from 0xFFFFFFFF, inverted at the end), of a Cyphal/serial payload.
std::uint32_t crc32c(Span<const std::uint8_t> bytes);

}  // namespace echofuse::link
