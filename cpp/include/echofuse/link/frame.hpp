#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"

/// Cyphal/serial frames: 00 | COBS(header of 24 bytes | payload | CRC-32C of the payload) | 00; one frame a transfer
/// (docs/link_protocol.md). Second implementation: python/echofuse/emulation/codec.py
namespace echofuse::link {

inline constexpr std::uint16_t kBroadcast = 0xFFFF;  ///< as a destination: everybody; as a source: no id yet

enum class TransferKind : std::uint8_t { kMessage, kRequest, kResponse };

struct TransferHeader {
  std::uint8_t priority = 4;  ///< 0 exceptional ... 4 nominal ... 7 optional
  std::uint16_t source = kBroadcast;
  std::uint16_t destination = kBroadcast;
  TransferKind kind = TransferKind::kMessage;
  std::uint16_t port_id = 0;      ///< subject, below 2^13 by convention; or service, below 2^14
  std::uint64_t transfer_id = 0;  ///< counts up per subject, or per session of a service
};

inline constexpr std::size_t kFrameHeaderBytes = 24;
inline constexpr std::size_t kFrameCrcBytes = 4;

/// Longest frame that a payload can make, with its delimiters.
constexpr std::size_t frame_bytes(std::size_t payload_bytes) {
  const std::size_t plain = kFrameHeaderBytes + payload_bytes + kFrameCrcBytes;
  return plain + plain / 254 + 1 + 2;
}

/// The frame's length in `out`, or 0 when it has no room for it.
std::size_t write_frame(const TransferHeader& header, Span<const std::uint8_t> payload,
                        Span<std::uint8_t> out);

/// Every stretch between two delimiters is in exactly one of them; an empty stretch in none.
struct FrameCounters {
  std::uint32_t frames = 0;       ///< valid and new
  std::uint32_t bad_cobs = 0;     ///< ends within a block
  std::uint32_t bad_length = 0;   ///< shorter than header and CRC, or longer than the buffer
  std::uint32_t bad_version = 0;  ///< not version 1
  std::uint32_t bad_header_crc = 0;
  std::uint32_t bad_payload_crc = 0;
  std::uint32_t multi_frame = 0;  ///< part of a transfer of several frames, which nobody here sends
  std::uint32_t repeated = 0;     ///< a transfer id once more within two seconds
};

/// Finds frames in a byte stream, byte by byte, in the caller's buffer. Whatever the bytes are, the next intact frame
/// behind a delimiter is read.
class FrameReader {
 public:
  /// buffer: holds header, payload and CRC of the longest frame that shall be read; outlives the reader.
  explicit FrameReader(Span<std::uint8_t> buffer) : buffer_(buffer) {}
  FrameReader(const FrameReader&) = delete;
  FrameReader& operator=(const FrameReader&) = delete;

  /// True when this byte completed a valid frame: header() and payload() hold until the next call.
  /// now_us: [us] of the reader's clock, for what is a repetition.
  bool push(std::uint8_t byte, std::int64_t now_us);

  const TransferHeader& header() const { return header_; }
  Span<const std::uint8_t> payload() const { return payload_; }
  const FrameCounters& counters() const { return counters_; }

 private:
  struct Session {
    std::uint64_t key = 0;  ///< source, destination and data specifier
    std::uint64_t transfer_id = 0;
    std::int64_t heard_us = 0;
    bool used = false;
  };

  bool complete(std::int64_t now_us);
  bool checked();
  bool is_new(std::uint16_t data_specifier, std::int64_t now_us);

  Span<std::uint8_t> buffer_;
  std::size_t size_ = 0;
  int block_left_ = 0;         ///< bytes of the COBS block still to come
  bool zero_follows_ = false;  ///< a zero stands behind the block, unless the frame ends there
  bool begun_ = false;
  bool overflown_ = false;
  TransferHeader header_;
  Span<const std::uint8_t> payload_;
  FrameCounters counters_;
  std::array<Session, kMaxLinkSessions> sessions_{};
};

}  // namespace echofuse::link
