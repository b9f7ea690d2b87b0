/// Any payload into a message's decoder. What is accepted lies within the message's bounds, and encodes to a payload that
/// decodes to the same again. ECHOFUSE_DECODER names one decoder; without it the first byte of the input does.

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/link/codec.hpp"
#include "expect.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::link;

using Bytes = Span<const std::uint8_t>;
using Room = std::array<std::uint8_t, kMaxPayloadBytes>;

/// decode(payload), encode, decode, encode: both encoded payloads are the same bytes.
template <class Message, class Decode, class Encode>
void round_trip(Bytes payload, Decode&& decoded, Encode&& encode) {
  Message first;
  if (decoded(payload, first) != Status::kOk) return;
  Room once;
  const std::size_t size = encode(first, once);
  EXPECT(size > 0);
  Message second;
  EXPECT(decoded(Bytes{once.data(), size}, second) == Status::kOk);
  Room twice;
  EXPECT(encode(second, twice) == size);
  for (std::size_t i = 0; i < size; ++i) EXPECT(once[i] == twice[i]);
}

template <class Message, class Decode>
void round_trip(Bytes payload, Decode&& decoded) {
  round_trip<Message>(payload, decoded,
                      [](const Message& message, Span<std::uint8_t> out) { return encode(message, out); });
}

void detections(Bytes payload) {
  TransferHeader header;
  header.source = 7;
  header.transfer_id = 9;
  round_trip<Detections>(payload, [&](Bytes bytes, Detections& report) {
    const Status status = decode(header, bytes, report);
    EXPECT(status == Status::kOk || report.detections.empty());
    return status;
  });
}

Status checked(Status status, const Tracks& message) {
  EXPECT(status == Status::kOk || message.tracks.empty());
  for (const Track& track : message.tracks) EXPECT(track.state <= TrackState::kDead);
  return status;
}

void tracks(Bytes payload) {
  round_trip<Tracks>(payload,
                     [](Bytes bytes, Tracks& message) { return checked(decode(bytes, message), message); });
}

void spatial_tracks(Bytes payload) {
  round_trip<Tracks>(
      payload, [](Bytes bytes, Tracks& message) { return checked(decode_spatial(bytes, message), message); },
      encode_spatial);
}

void node_health(Bytes payload) {
  round_trip<NodeHealth>(payload, [](Bytes bytes, NodeHealth& health) {
    const Status status = decode(bytes, health);
    EXPECT(status == Status::kOk || health.values.empty());
    return status;
  });
}

void heartbeat(Bytes payload) {
  round_trip<Heartbeat>(payload, [](Bytes bytes, Heartbeat& beat) {
    const Status status = decode(bytes, beat);
    EXPECT(status != Status::kOk || beat.mode <= Mode::kSoftwareUpdate);
    return status;
  });
}

void synchronization(Bytes payload) {
  std::uint64_t previous_us = 0;
  if (decode_synchronization(payload, previous_us) != Status::kOk) return;
  EXPECT(previous_us < std::uint64_t{1} << 56);
}

void raw_scan(Bytes payload) {
  std::array<float, 32> samples{};
  samples.back() = 1.5f;  // a guard behind what the decoder may write
  std::int64_t time_us = 0;
  std::size_t n_samples = 0;
  const Status status = decode_raw_scan(payload, time_us, {samples.data(), samples.size() - 1}, n_samples);
  EXPECT(samples.back() == 1.5f);
  EXPECT(status == Status::kOk || n_samples == 0);
  EXPECT(9 + 4 * n_samples <= payload.size() || n_samples == 0);
}

[[maybe_unused]] constexpr std::array kDecoders{detections,      tracks,   node_health,   heartbeat,
                                                synchronization, raw_scan, spatial_tracks};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
#ifdef ECHOFUSE_DECODER
  ECHOFUSE_DECODER({data, size});
#else
  if (size > 0) kDecoders[data[0] % kDecoders.size()]({data + 1, size - 1});
#endif
  return 0;
}
