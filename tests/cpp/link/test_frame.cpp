#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "echofuse/link/crc.hpp"
#include "echofuse/link/frame.hpp"
#include "link/vectors.hpp"

namespace echofuse::link {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::read_vectors;
using testing::span_of;
using testing::Vector;

constexpr std::size_t kCapacity = 600;

/// A reader with its buffer, and what it has read.
struct Reader {
  std::array<std::uint8_t, kCapacity> buffer{};
  FrameReader reader{buffer};
  std::vector<Bytes> payloads;

  void feed(const Bytes& bytes, std::int64_t now_us = 0) {
    for (const std::uint8_t byte : bytes)
      if (reader.push(byte, now_us)) payloads.emplace_back(reader.payload().begin(), reader.payload().end());
  }
  std::uint32_t rejected() const {
    const FrameCounters& c = reader.counters();
    return c.bad_cobs + c.bad_length + c.bad_version + c.bad_header_crc + c.bad_payload_crc + c.multi_frame +
           c.repeated;
  }
};

Bytes frame_of(const Bytes& payload, const TransferHeader& header = {4, 7, kBroadcast, {}, 6200, 1}) {
  Bytes frame(frame_bytes(payload.size()));
  frame.resize(write_frame(header, span_of(payload), {frame.data(), frame.size()}));
  return frame;
}

/// COBS of less than 254 bytes, with delimiters: before each zero, and at first, how far it is to the next.
Bytes stuffed(const Bytes& plain) {
  Bytes out{0, 1};
  std::size_t code_at = 1;
  for (const std::uint8_t byte : plain) {
    if (byte == 0) code_at = out.size();
    out.push_back(byte == 0 ? 1 : byte);
    if (byte != 0) ++out[code_at];
  }
  out.push_back(0);
  return out;
}

/// A header of zeros but for version and "end of transfer", then with one byte changed; no payload; both CRCs right.
Bytes frame_with(std::size_t at, std::uint8_t value) {
  Bytes plain(kFrameHeaderBytes + kFrameCrcBytes);
  plain[0] = 1;
  plain[19] = 0x80;
  plain[at] = value;
  const unsigned crc = crc16({plain.data(), kFrameHeaderBytes - 2});
  plain[22] = static_cast<std::uint8_t>(crc >> 8);
  plain[23] = static_cast<std::uint8_t>(crc & 0xFFU);
  return stuffed(plain);
}

}  // namespace

TEST_CASE("the check values of both CRCs") {
  std::array<std::uint8_t, 9> digits{};
  std::memcpy(digits.data(), "123456789", digits.size());
  CHECK(crc16(digits) == 0x29B1);
  CHECK(crc32c(digits) == 0xE3069283U);
  CHECK(crc32c({}) == 0);
}

TEST_CASE("every vector is written byte by byte, and read") {
  const auto vectors = read_vectors();
  REQUIRE(vectors.size() >= 6);
  for (const auto& [name, vector] : vectors) {
    CAPTURE(name);
    CHECK(frame_of(vector.payload, {4, vector.source, kBroadcast, {}, vector.subject, vector.transfer_id}) ==
          vector.frame);
    Reader reader;
    reader.feed(vector.frame);
    REQUIRE(reader.payloads.size() == 1);
    CHECK(reader.payloads[0] == vector.payload);
    const TransferHeader& header = reader.reader.header();
    CHECK(header.source == vector.source);
    CHECK(header.destination == kBroadcast);
    CHECK(header.port_id == vector.subject);
    CHECK(header.transfer_id == vector.transfer_id);
    CHECK(header.kind == TransferKind::kMessage);
  }
}

TEST_CASE("every single-bit error in a vector's frame is rejected and counted, and the next frame is read") {
  const Bytes next = frame_of({1, 2, 3});
  for (const auto& [name, vector] : read_vectors()) {
    CAPTURE(name);
    for (std::size_t bit = 0; bit < 8 * (vector.frame.size() - 2); ++bit) {
      Bytes broken = vector.frame;
      std::uint8_t& byte = broken[1 + bit / 8];
      byte = static_cast<std::uint8_t>(byte ^ (1U << (bit % 8)));
      // A byte that becomes a delimiter makes two stretches of one. If the payload begins with four zeros and is cut
      // behind them, they are the right CRC of no payload at all: what no decoder of ours accepts.
      const bool split = byte == 0;
      Reader reader;
      reader.feed(broken);
      REQUIRE(reader.rejected() >= 1);
      REQUIRE(reader.rejected() <= (split ? 2 : 1));
      for (const Bytes& payload : reader.payloads) REQUIRE((split && payload.empty()));
      reader.payloads.clear();
      reader.feed(next);
      REQUIRE(reader.payloads.size() == 1);
    }
  }
}

TEST_CASE("a broken delimiter costs one frame at most") {
  const Bytes one = frame_of({1});
  const Bytes two = frame_of({2}, {4, 7, kBroadcast, {}, 6200, 2});
  for (const std::size_t at : {one.size() - 1, one.size()}) {
    Bytes both = one;
    both.insert(both.end(), two.begin(), two.end());
    both[at] = 4;
    Reader reader;
    reader.feed(both);
    CHECK(reader.payloads.size() == 1);
    CHECK(reader.rejected() == 1);
  }
}

TEST_CASE("blocks of 254 bytes end where the specification says") {
  for (const std::size_t size :
       {0U, 225U, 226U, 227U, 228U, 229U, 253U, 254U, 255U, 480U, 481U, 508U, 509U}) {
    for (const int fill : {0, 1, 255}) {
      CAPTURE(size);
      CAPTURE(fill);
      const Bytes payload(size, static_cast<std::uint8_t>(fill));
      const Bytes frame = frame_of(payload);
      CHECK(std::count(frame.begin(), frame.end(), 0) == 2);
      Reader reader;
      reader.feed(frame);
      REQUIRE(reader.payloads.size() == 1);
      CHECK(reader.payloads[0] == payload);
    }
  }
}

TEST_CASE("no room for a frame: nothing is written") {
  const Bytes payload(10);
  Bytes out(frame_bytes(payload.size()) - 1, 7);
  CHECK(write_frame({}, span_of(payload), {out.data(), out.size()}) == 0);
  CHECK(std::count(out.begin(), out.end(), 7) == static_cast<std::ptrdiff_t>(out.size()));
}

TEST_CASE("each reason to reject has its counter") {
  Reader reader;
  const FrameCounters& counters = reader.reader.counters();
  reader.feed({0, 9, 1, 2, 0});
  CHECK(counters.bad_cobs == 1);
  reader.feed({0, 3, 1, 2, 0});
  CHECK(counters.bad_length == 1);
  reader.feed(frame_of(Bytes(kCapacity - kFrameHeaderBytes - kFrameCrcBytes + 1, 5)));
  CHECK(counters.bad_length == 2);
  Bytes payload_error = frame_of({1, 2, 3});
  payload_error[payload_error.size() - 7] ^= 4;
  reader.feed(payload_error);
  CHECK(counters.bad_payload_crc == 1);
  Bytes header_error = frame_of({});
  header_error[2] ^= 4;
  reader.feed(header_error);
  CHECK(counters.bad_header_crc == 1);
  CHECK(reader.rejected() == 5);
  CHECK(counters.frames == 0);
  reader.feed(Bytes(100));
  CHECK(reader.rejected() == 5);  // empty stretches are none
}

TEST_CASE("another version, and parts of longer transfers, are counted though their CRCs are right") {
  Reader reader;
  const FrameCounters& counters = reader.reader.counters();
  reader.feed(frame_with(1, 0));
  CHECK(reader.payloads.size() == 1);
  reader.feed(frame_with(0, 2));
  CHECK(counters.bad_version == 1);
  reader.feed(frame_with(16, 1));  // the second frame, and last
  CHECK(counters.multi_frame == 1);
  reader.feed(frame_with(19, 0));  // the first one of several
  CHECK(counters.multi_frame == 2);
  CHECK(reader.rejected() == 3);
}

TEST_CASE("requests and responses are told from messages") {
  for (const TransferKind kind : {TransferKind::kMessage, TransferKind::kRequest, TransferKind::kResponse}) {
    Reader reader;
    reader.feed(frame_of({}, {0, 1, 2, kind, 384, 5}));
    CHECK(reader.reader.header().kind == kind);
    CHECK(reader.reader.header().port_id == 384);
    CHECK(reader.reader.header().destination == 2);
    CHECK(reader.reader.header().priority == 0);
  }
  Reader reader;
  reader.feed(frame_of({}, {4, 9, 5, TransferKind::kRequest, 430, 0}));
  // data specifier, little-endian: 0xC000 | 430, as the specification draws it
  CHECK(std::memcmp(reader.buffer.data() + 6, "\xAE\xC1", 2) == 0);
}

TEST_CASE("the longest payload that the buffer holds is read") {
  Reader reader;
  const Bytes payload(kCapacity - kFrameHeaderBytes - kFrameCrcBytes, 5);
  reader.feed(frame_of(payload));
  REQUIRE(reader.payloads.size() == 1);
  CHECK(reader.payloads[0] == payload);
}

TEST_CASE("a transfer id once more within two seconds is a repetition, of its sender and subject alone") {
  Reader reader;
  const TransferHeader header{4, 7, kBroadcast, {}, 6200, 1};
  reader.feed(frame_of({}, header), 0);
  reader.feed(frame_of({}, header), 1999999);
  CHECK(reader.reader.counters().repeated == 1);
  TransferHeader other = header;
  other.source = 8;
  reader.feed(frame_of({}, other), 1999999);
  other = header;
  other.port_id = 6201;
  reader.feed(frame_of({}, other), 1999999);
  CHECK(reader.reader.counters().frames == 3);
  reader.feed(frame_of({}, header), 4000000);
  CHECK(reader.reader.counters().frames == 4);
  other.source = kBroadcast;  // anonymous: no session, no repetition
  reader.feed(frame_of({}, other), 4000000);
  reader.feed(frame_of({}, other), 4000000);
  CHECK(reader.reader.counters().frames == 6);
  CHECK(reader.reader.counters().repeated == 1);
}

TEST_CASE("more sessions than there is room for: the one that was silent for longest is forgotten") {
  Reader reader;
  const auto hear = [&](std::size_t source, std::int64_t now_us) {
    reader.feed(frame_of({}, {4, static_cast<std::uint16_t>(source), kBroadcast, {}, 6200, 1}), now_us);
  };
  for (std::size_t source = 0; source <= kMaxLinkSessions; ++source)
    hear(source, static_cast<std::int64_t>(source));
  CHECK(reader.reader.counters().repeated == 0);
  hear(kMaxLinkSessions, 1000);
  CHECK(reader.reader.counters().repeated == 1);
  hear(0, 1001);  // forgotten, so taken for new
  CHECK(reader.reader.counters().repeated == 1);
}

}  // namespace echofuse::link
