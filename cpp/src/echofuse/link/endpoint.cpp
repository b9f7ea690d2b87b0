#include "echofuse/link/endpoint.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "echofuse/core/check.hpp"
#include "echofuse/link/codec.hpp"
#include "uavcan/node/GetInfo_1_0.h"

namespace echofuse::link {
namespace {

constexpr std::int64_t kHeartbeatPeriod_us = 1000000;
constexpr std::uint64_t kMicrosecondsPerSecond = 1000000;

}  // namespace

const std::array<RegisterField, 11> Endpoint::kRegisters = [] {
  std::array<RegisterField, 11> fields{{
      ECHOFUSE_REGISTER_AS(Identity, node_id, "uavcan.node.id"),
      ECHOFUSE_REGISTER_AS(Identity, name, "uavcan.node.description"),
      ECHOFUSE_REGISTER_AS(Identity, ports.detections, "uavcan.pub.detections.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.tracks, "uavcan.pub.tracks.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.breathing_observations, "uavcan.pub.breathing_observations.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.motion_report, "uavcan.pub.motion_report.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.persons, "uavcan.pub.persons.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.node_health, "uavcan.pub.node_health.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.tap, "uavcan.pub.tap.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.raw_scan, "uavcan.sub.raw_scan.id"),
      ECHOFUSE_REGISTER_AS(Identity, ports.spatial_tracks, "uavcan.pub.spatial_tracks.id"),
  }};
  fields[0].writable = false;  // the board knows it
  fields[1].writable = false;
  return fields;
}();

Endpoint::Endpoint(Span<std::uint8_t> frame_buffer, SendFunction send_bytes, const char* name)
    : reader_(frame_buffer), send_(send_bytes) {
  identity_.name = name;
  ECHOFUSE_CHECK(registers_.add({kRegisters, &identity_}));
}

void Endpoint::start(std::uint16_t node_id, std::int64_t now_us) {
  identity_.node_id = node_id;
  started_us_ = now_us;
  next_heartbeat_us_ = now_us;
}

bool Endpoint::push(std::uint8_t byte, std::int64_t now_us) {
  if (!reader_.push(byte, now_us)) return false;
  if (header().kind == TransferKind::kMessage) return true;
  if (header().kind == TransferKind::kRequest && header().destination == node_id()) serve(now_us);
  return false;
}

/// Answers a request to this node; a service that it does not have is left unanswered, as the specification wants.
void Endpoint::serve(std::int64_t now_us) {
  std::size_t size = 0;
  if (header().port_id == kGetInfoService) size = get_info();
  if (header().port_id == kRegisterListService) size = registers_.list(payload(), payload_);
  if (header().port_id == kRegisterAccessService) size = registers_.access(payload(), now_us, payload_);
  if (size == 0) return;
  TransferHeader answer = header();
  answer.kind = TransferKind::kResponse;
  answer.source = node_id();
  answer.destination = header().source;
  send(answer, size);
}

std::size_t Endpoint::get_info() {
  uavcan_node_GetInfo_Response_1_0 info{};
  info.protocol_version = {1, 0};
  info.hardware_version = {1, 0};
  info.software_version = {0, 1};
  info.name.count = std::min<std::size_t>(std::strlen(identity_.name), 50);
  std::copy_n(identity_.name, info.name.count, info.name.elements);
  std::size_t size = payload_.size();
  return uavcan_node_GetInfo_Response_1_0_serialize_(&info, payload_.data(), &size) >= 0 ? size : 0;
}

void Endpoint::publish(std::uint16_t subject, std::uint64_t transfer_id, std::size_t size) {
  TransferHeader header;
  header.source = node_id();
  header.port_id = subject;
  header.transfer_id = transfer_id;
  send(header, size);
}

void Endpoint::send(const TransferHeader& header, std::size_t size) {
  const std::size_t length = size == 0 ? 0 : write_frame(header, {payload_.data(), size}, frame_);
  if (length == 0)
    ++unsent_;
  else
    send_({frame_.data(), length});
}

bool Endpoint::heartbeat(std::int64_t now_us, Health health, Mode mode) {
  if (now_us < next_heartbeat_us_ && mode == last_mode_) return false;
  if (now_us >= next_heartbeat_us_) {  // in step with the seconds, but never two at once to catch up
    next_heartbeat_us_ += kHeartbeatPeriod_us;
    if (next_heartbeat_us_ <= now_us) next_heartbeat_us_ = now_us + kHeartbeatPeriod_us;
  }
  last_mode_ = mode;
  Heartbeat beat;
  beat.uptime_s =
      static_cast<std::uint32_t>(static_cast<std::uint64_t>(now_us - started_us_) / kMicrosecondsPerSecond);
  beat.health = health;
  beat.mode = mode;
  publish(kHeartbeatSubject, heartbeats_++, encode(beat, payload_));
  return true;
}

}  // namespace echofuse::link
