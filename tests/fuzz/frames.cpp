/// Any bytes into the frame reader, and then frames of them: whatever came before, an intact frame is read, and every
/// stretch between two delimiters is in one counter.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "echofuse/link/frame.hpp"
#include "expect.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::link;

constexpr std::size_t kLongestPayload = 300;  // two COBS blocks
constexpr std::size_t kBufferBytes = kFrameHeaderBytes + kFrameCrcBytes + kLongestPayload;

std::uint32_t counted(const FrameCounters& c) {
  return c.frames + c.bad_cobs + c.bad_length + c.bad_version + c.bad_header_crc + c.bad_payload_crc +
         c.multi_frame + c.repeated;
}

/// A stretch is what stands between two zeros, if anything does.
std::uint32_t stretches(Span<const std::uint8_t> bytes) {
  std::uint32_t count = 0;
  bool within = false;
  for (const std::uint8_t byte : bytes) {
    if (byte == 0 && within) ++count;
    within = byte != 0;
  }
  return count;
}

/// The input's first bytes as a header; what is missing is zero.
TransferHeader header_from(Span<const std::uint8_t> bytes) {
  std::array<std::uint8_t, 16> raw{};
  std::copy_n(bytes.begin(), std::min(raw.size(), bytes.size()), raw.begin());
  TransferHeader header;
  header.priority = raw[0] & 7U;
  header.kind = static_cast<TransferKind>(raw[1] % 3);
  std::memcpy(&header.source, &raw[2], 2);
  std::memcpy(&header.destination, &raw[4], 2);
  std::memcpy(&header.port_id, &raw[6], 2);
  header.port_id &= 0x3FFFU;
  std::memcpy(&header.transfer_id, &raw[8], 8);
  return header;
}

bool same(const TransferHeader& a, const TransferHeader& b) {
  return a.priority == b.priority && a.kind == b.kind && a.source == b.source &&
         a.destination == b.destination && a.port_id == b.port_id && a.transfer_id == b.transfer_id;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Span<const std::uint8_t> bytes{data, size};
  std::array<std::uint8_t, kBufferBytes> buffer;
  FrameReader reader(buffer);
  for (const std::uint8_t byte : bytes) {
    if (reader.push(byte, 0)) EXPECT(reader.payload().size() <= kLongestPayload);
  }
  EXPECT(counted(reader.counters()) == stretches(bytes));

  const TransferHeader header = header_from(bytes);
  const Span<const std::uint8_t> payload{data, std::min(size, kLongestPayload)};
  std::array<std::uint8_t, frame_bytes(kLongestPayload)> frame;
  const std::size_t length = write_frame(header, payload, frame);
  EXPECT(length >= 2 + 1 + kFrameHeaderBytes + kFrameCrcBytes && length <= frame_bytes(payload.size()));
  EXPECT(std::count(frame.begin(), frame.begin() + length, 0) == 2);
  bool read = false;
  constexpr std::int64_t kMuchLater_us = 10000000;  // so that nothing is a repetition
  for (std::size_t i = 0; i < length; ++i) read = reader.push(frame[i], kMuchLater_us);
  EXPECT(read && same(reader.header(), header));
  EXPECT(std::equal(payload.begin(), payload.end(), reader.payload().begin(), reader.payload().end()));
  for (std::size_t i = 0; i < length; ++i) read = reader.push(frame[i], kMuchLater_us + 1);
  EXPECT(read == (header.source == kBroadcast));  // once more: a repetition, unless it is anonymous
  return 0;
}
