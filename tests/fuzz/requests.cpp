/// Any payload as a request to a machine with all registers of node and hub. Every request for a service that it has is
/// answered with one frame, or not at all where the payload is no request; and the machine still lists its registers.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/hub/hub.hpp"
#include "echofuse/hub/registers.hpp"
#include "echofuse/link/endpoint.hpp"
#include "echofuse/node/node.hpp"
#include "echofuse/node/registers.hpp"
#include "expect.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::link;

constexpr std::uint16_t kId = 5;
constexpr std::array<std::uint16_t, 4> kServices{kRegisterAccessService, kRegisterListService,
                                                 kGetInfoService, 77};

std::size_t frames_sent = 0;
std::size_t payload_bytes_sent = 0;

/// What was sent is a frame that our own reader accepts.
void take(Span<const std::uint8_t> bytes) {
  static std::array<std::uint8_t, frame_bytes(kMaxPayloadBytes)> buffer;
  FrameReader reader(buffer);
  bool valid = false;
  for (const std::uint8_t byte : bytes) valid = reader.push(byte, 0);
  EXPECT(valid && reader.header().kind == TransferKind::kResponse && reader.header().source == kId);
  ++frames_sent;
  payload_bytes_sent = reader.payload().size();
}

bool ask(Endpoint& endpoint, std::uint16_t service, Span<const std::uint8_t> request, std::uint64_t number) {
  static std::array<std::uint8_t, frame_bytes(kMaxPayloadBytes)> frame;
  TransferHeader header;
  header.kind = TransferKind::kRequest;
  header.source = 9;
  header.destination = kId;
  header.port_id = service;
  header.transfer_id = number;
  const std::size_t length = write_frame(header, request, frame);
  const std::size_t sent_before = frames_sent;
  for (std::size_t i = 0; i < length; ++i) EXPECT(!endpoint.push(frame[i], 0));
  EXPECT(frames_sent - sent_before <= 1);
  return frames_sent > sent_before;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || size > kMaxPayloadBytes) return 0;
  std::array<std::uint8_t, kFrameHeaderBytes + kFrameCrcBytes + kMaxPayloadBytes> buffer;
  Endpoint endpoint(buffer, &take, "fuzz");
  static node::SensorRadarNodeConfig node_config;
  static hub::SensorRadarHubConfig hub_config;
  node_config = {};
  hub_config = {};
  EXPECT(endpoint.registers().add({node::config_registers(), &node_config}));
  EXPECT(endpoint.registers().add({hub::config_registers(), &hub_config}));
  endpoint.start(kId, 0);

  const std::uint16_t service = kServices[data[0] % kServices.size()];
  const bool answered = ask(endpoint, service, {data + 1, size - 1}, 0);
  EXPECT(!answered || service != kServices.back());
  EXPECT(endpoint.unsent() == 0);
  EXPECT(endpoint.registers().writes() + endpoint.registers().refused_writes() <= 1);

  const std::array<std::uint8_t, 2> first{0, 0};
  EXPECT(ask(endpoint, kRegisterListService, first, 1) && payload_bytes_sent > 1);
  return 0;
}
