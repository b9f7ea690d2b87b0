#include "echofuse/link/frame.hpp"

#include "echofuse/link/crc.hpp"

namespace echofuse::link {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::uint32_t kSingleFrame = 0x80000000U;  ///< frame index 0, end of transfer
constexpr std::uint16_t kService = 0x8000;
constexpr std::uint16_t kRequest = 0x4000;
constexpr std::int64_t kTransferIdTimeout_us = 2000000;

using Header = std::array<std::uint8_t, kFrameHeaderBytes>;

void put(Header& bytes, std::size_t at, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint64_t get(const std::uint8_t* bytes, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i > 0; --i) value = (value << 8) | bytes[i - 1];
  return value;
}

std::uint16_t data_specifier(const TransferHeader& header) {
  unsigned specifier = header.port_id;
  if (header.kind != TransferKind::kMessage) specifier |= kService;
  if (header.kind == TransferKind::kRequest) specifier |= kRequest;
  return static_cast<std::uint16_t>(specifier);
}

Header pack(const TransferHeader& header) {
  Header bytes{};
  bytes[0] = kVersion;
  bytes[1] = header.priority;
  put(bytes, 2, header.source, 2);
  put(bytes, 4, header.destination, 2);
  put(bytes, 6, data_specifier(header), 2);
  put(bytes, 8, header.transfer_id, 8);
  put(bytes, 16, kSingleFrame, 4);
  const unsigned crc = crc16({bytes.data(), kFrameHeaderBytes - 2});
  bytes[22] = static_cast<std::uint8_t>(crc >> 8);
  bytes[23] = static_cast<std::uint8_t>(crc & 0xFFU);
  return bytes;
}

/// Consistent-overhead byte stuffing into a buffer that is known to be long enough.
class CobsWriter {
 public:
  explicit CobsWriter(Span<std::uint8_t> out) : out_(out) {
    out_[0] = 0;
    size_ = 2;  // the delimiter, and the first block's code
  }
  void put(Span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) put(byte);
  }
  std::size_t finish() {
    out_[code_at_] = static_cast<std::uint8_t>(size_ - code_at_);
    out_[size_++] = 0;
    return size_;
  }

 private:
  void put(std::uint8_t byte) {
    if (size_ - code_at_ == 255) next_block();
    if (byte == 0)
      next_block();
    else
      out_[size_++] = byte;
  }
  void next_block() {
    out_[code_at_] = static_cast<std::uint8_t>(size_ - code_at_);
    code_at_ = size_++;
  }

  Span<std::uint8_t> out_;
  std::size_t code_at_ = 1;
  std::size_t size_;
};

}  // namespace

std::size_t write_frame(const TransferHeader& header, Span<const std::uint8_t> payload,
                        Span<std::uint8_t> out) {
  if (out.size() < frame_bytes(payload.size())) return 0;
  const Header bytes = pack(header);
  const std::uint32_t crc = crc32c(payload);
  std::array<std::uint8_t, kFrameCrcBytes> crc_bytes;
  for (std::size_t i = 0; i < crc_bytes.size(); ++i) crc_bytes[i] = static_cast<std::uint8_t>(crc >> (8 * i));
  CobsWriter cobs(out);
  cobs.put(bytes);
  cobs.put(payload);
  cobs.put(crc_bytes);
  return cobs.finish();
}

bool FrameReader::push(std::uint8_t byte, std::int64_t now_us) {
  if (byte == 0) {
    const bool valid = begun_ && complete(now_us);
    size_ = 0;
    block_left_ = 0;
    zero_follows_ = begun_ = overflown_ = false;
    return valid;
  }
  const bool is_code = block_left_ == 0;
  const bool stores = !is_code || zero_follows_;
  if (stores && size_ < buffer_.size())
    buffer_[size_++] = is_code ? std::uint8_t{0} : byte;
  else if (stores)
    overflown_ = true;
  if (is_code) {
    begun_ = true;
    block_left_ = byte - 1;
    zero_follows_ = byte != 0xFF;
  } else {
    --block_left_;
  }
  return false;
}

bool FrameReader::complete(std::int64_t now_us) {
  if (block_left_ != 0) {
    ++counters_.bad_cobs;
    return false;
  }
  if (overflown_ || size_ < kFrameHeaderBytes + kFrameCrcBytes) {
    ++counters_.bad_length;
    return false;
  }
  if (!checked()) return false;
  const std::uint8_t* bytes = buffer_.data();
  const auto specifier = static_cast<std::uint16_t>(get(bytes + 6, 2));
  header_.priority = bytes[1];
  header_.source = static_cast<std::uint16_t>(get(bytes + 2, 2));
  header_.destination = static_cast<std::uint16_t>(get(bytes + 4, 2));
  header_.transfer_id = get(bytes + 8, 8);
  header_.kind = TransferKind::kMessage;
  header_.port_id = specifier & 0x7FFFU;
  if ((specifier & kService) != 0) {
    header_.kind = (specifier & kRequest) != 0 ? TransferKind::kRequest : TransferKind::kResponse;
    header_.port_id = specifier & 0x3FFFU;
  }
  payload_ = {bytes + kFrameHeaderBytes, size_ - kFrameHeaderBytes - kFrameCrcBytes};
  if (!is_new(specifier, now_us)) {
    ++counters_.repeated;
    return false;
  }
  ++counters_.frames;
  return true;
}

/// Both CRCs, the version, and that the frame is a whole transfer.
bool FrameReader::checked() {
  const std::uint8_t* bytes = buffer_.data();
  const std::size_t payload = size_ - kFrameHeaderBytes - kFrameCrcBytes;
  if (crc16({bytes, kFrameHeaderBytes}) != 0) {
    ++counters_.bad_header_crc;
    return false;
  }
  if (bytes[0] != kVersion) {
    ++counters_.bad_version;
    return false;
  }
  if (crc32c({bytes + kFrameHeaderBytes, payload}) != get(bytes + kFrameHeaderBytes + payload, 4)) {
    ++counters_.bad_payload_crc;
    return false;
  }
  if (get(bytes + 16, 4) != kSingleFrame) {
    ++counters_.multi_frame;
    return false;
  }
  return true;
}

/// Remembers the session's transfer id, in place of the session that was silent for longest if there is no room.
bool FrameReader::is_new(std::uint16_t data_specifier, std::int64_t now_us) {
  if (header_.source == kBroadcast) return true;  // without an id there is no session
  const std::uint64_t key =
      (std::uint64_t{header_.source} << 32) | (std::uint64_t{header_.destination} << 16) | data_specifier;
  Session* place = &sessions_[0];
  for (Session& session : sessions_) {
    if (session.used && session.key == key) {
      place = &session;
      break;
    }
    const bool older = !session.used || session.heard_us < place->heard_us;
    if (place->used && older) place = &session;
  }
  const bool again = place->used && place->key == key && place->transfer_id == header_.transfer_id &&
                     now_us - place->heard_us < kTransferIdTimeout_us;
  *place = {key, header_.transfer_id, now_us, true};
  return !again;
}

}  // namespace echofuse::link
