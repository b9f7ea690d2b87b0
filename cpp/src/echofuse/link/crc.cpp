#include "echofuse/link/crc.hpp"

#include <array>

namespace echofuse::link {
namespace {

constexpr std::size_t kNibbles =
    16;  ///< half a byte at a time: 32 and 64 bytes of tables instead of 512 and 1024

constexpr std::array<std::uint16_t, kNibbles> crc16_table() {
  std::array<std::uint16_t, kNibbles> table{};
  for (std::size_t i = 0; i < kNibbles; ++i) {
    unsigned value = static_cast<unsigned>(i) << 12;
    for (int bit = 0; bit < 4; ++bit) value = (value & 0x8000U) != 0 ? (value << 1) ^ 0x1021U : value << 1;
    table[i] = static_cast<std::uint16_t>(value & 0xFFFFU);
  }
  return table;
}

constexpr std::array<std::uint32_t, kNibbles> crc32c_table() {
  std::array<std::uint32_t, kNibbles> table{};
  for (std::size_t i = 0; i < kNibbles; ++i) {
    auto value = static_cast<std::uint32_t>(i);
    for (int bit = 0; bit < 4; ++bit) value = (value & 1U) != 0 ? (value >> 1) ^ 0x82F63B78U : value >> 1;
    table[i] = value;
  }
  return table;
}

constexpr std::array<std::uint16_t, kNibbles> kCrc16 = crc16_table();
constexpr std::array<std::uint32_t, kNibbles> kCrc32c = crc32c_table();

}  // namespace

std::uint16_t crc16(Span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFFU;
  for (const unsigned byte : bytes) {
    crc = ((crc << 4) & 0xFFFFU) ^ kCrc16[(crc >> 12) ^ (byte >> 4)];
    crc = ((crc << 4) & 0xFFFFU) ^ kCrc16[(crc >> 12) ^ (byte & 0xFU)];
  }
  return static_cast<std::uint16_t>(crc);
}

std::uint32_t crc32c(Span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint32_t byte : bytes) {
    crc ^= byte;
    crc = (crc >> 4) ^ kCrc32c[crc & 0xFU];
    crc = (crc >> 4) ^ kCrc32c[crc & 0xFU];
  }
  return ~crc;
}

}  // namespace echofuse::link
