#include "echofuse/link/codec.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "echofuse/Detections_1_0.h"
#include "echofuse/NodeHealth_1_0.h"
#include "echofuse/SpatialTracks_1_0.h"
#include "echofuse/Tap_1_0.h"
#include "echofuse/Tracks_1_0.h"
#include "uavcan/node/Heartbeat_1_0.h"
#include "uavcan/time/Synchronization_1_0.h"

namespace echofuse::link {
namespace {

constexpr std::size_t kTimeBytes = 7;  ///< a 56-bit number of microseconds
constexpr std::size_t kScanHeaderBytes = kTimeBytes + 2;
constexpr std::uint64_t kTimeMask = (std::uint64_t{1} << 56) - 1;

/// A generated function's answer: the length, or 0 for its errors.
/// The length by reference: the call that sets it is an argument too, and may be evaluated after a copy was made.
std::size_t length_or_nothing(std::int8_t result, const std::size_t& length) {
  return result >= 0 ? length : 0;
}

/// Whether a payload holds `n_items` behind its first bytes. Cyphal takes what is missing for zeros, which no sender of
/// these messages means: a broken bit can cut a frame so that an empty payload remains, whose CRC is zero.
bool holds(Span<const std::uint8_t> payload, std::size_t first_bytes, std::size_t n_items,
           std::size_t item_bytes) {
  return payload.size() >= first_bytes + n_items * item_bytes;
}

std::uint16_t to_uint16(float value) { return static_cast<std::uint16_t>(std::clamp(value, 0.0f, 65535.0f)); }

std::uint64_t to_time(std::int64_t time_us) { return static_cast<std::uint64_t>(time_us) & kTimeMask; }

/// From 56 bits, with their sign: a clock may have begun after zero.
std::int64_t from_time(std::uint64_t time_us) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 55;
  return static_cast<std::int64_t>(((time_us & kTimeMask) ^ kSign) - kSign);
}

static_assert(echofuse_Detections_1_0_detections_ARRAY_CAPACITY_ == kMaxDetectionsPerNode);
static_assert(echofuse_Tracks_1_0_tracks_ARRAY_CAPACITY_ == kMaxTracks);
static_assert(echofuse_SpatialTracks_1_0_tracks_ARRAY_CAPACITY_ == kMaxTracks);
static_assert(echofuse_NodeHealth_1_0_values_ARRAY_CAPACITY_ == kMaxHealthValues);
static_assert(echofuse_Tap_1_0_values_ARRAY_CAPACITY_ == kTapValues);
static_assert(kMaxPayloadBytes >= echofuse_SpatialTracks_1_0_SERIALIZATION_BUFFER_SIZE_BYTES_);

constexpr std::size_t kTrackBytes = 35;
constexpr std::size_t kSpatialTrackBytes = 55;

/// Fills a Track or SpatialTrack: as many numbers as its arrays take. The plane's covariances come first.
template <class WireTrack>
void to_wire(const Track& track, WireTrack& wire) {
  wire.id = static_cast<std::uint32_t>(track.id);
  wire.state = static_cast<std::uint8_t>(track.state);
  wire.frames_since_update =
      static_cast<std::uint16_t>(std::clamp<std::int32_t>(track.frames_since_update, 0, 65535));
  const float position[] = {track.x_m, track.y_m, track.z_m};
  const float velocity[] = {track.vx_mps, track.vy_mps, track.vz_mps};
  const float covariance[] = {track.covariance_xx_m2, track.covariance_xy_m2, track.covariance_yy_m2,
                              track.covariance_xz_m2, track.covariance_yz_m2, track.covariance_zz_m2};
  std::copy_n(position, std::size(wire.position), wire.position);
  std::copy_n(velocity, std::size(wire.velocity), wire.velocity);
  std::copy_n(covariance, std::size(wire.covariance), wire.covariance);
}

template <class WireTrack>
Track from_wire(const WireTrack& wire) {
  float position[3]{}, velocity[3]{}, covariance[6]{};
  std::copy(std::begin(wire.position), std::end(wire.position), position);
  std::copy(std::begin(wire.velocity), std::end(wire.velocity), velocity);
  std::copy(std::begin(wire.covariance), std::end(wire.covariance), covariance);
  return {static_cast<std::int32_t>(wire.id),
          static_cast<TrackState>(wire.state),
          wire.frames_since_update,
          position[0],
          position[1],
          position[2],
          velocity[0],
          velocity[1],
          velocity[2],
          covariance[0],
          covariance[1],
          covariance[2],
          covariance[3],
          covariance[4],
          covariance[5]};
}

/// Fills a Tracks or SpatialTracks.
template <class WireTracks>
void to_wire(const Tracks& tracks, WireTracks& wire) {
  wire.time_us = to_time(tracks.time_us);
  wire.frame = tracks.frame;
  wire.tracks.count = tracks.tracks.size();
  for (std::size_t i = 0; i < tracks.tracks.size(); ++i) to_wire(tracks.tracks[i], wire.tracks.elements[i]);
}

/// A state that does not exist: kInvalidInput, and `tracks` without any.
template <class WireTracks>
Status from_wire(const WireTracks& wire, Tracks& tracks) {
  tracks.time_us = from_time(wire.time_us);
  tracks.frame = wire.frame;
  for (std::size_t i = 0; i < wire.tracks.count; ++i) {
    if (wire.tracks.elements[i].state > static_cast<std::uint8_t>(TrackState::kDead)) {
      tracks.tracks.clear();
      return Status::kInvalidInput;
    }
    (void)tracks.tracks.try_push_back(from_wire(wire.tracks.elements[i]));
  }
  return Status::kOk;
}

}  // namespace

TransferHeader header_of(const Detections& report, std::uint16_t subject) {
  TransferHeader header;
  header.source = static_cast<std::uint16_t>(report.node_id);
  header.port_id = subject;
  header.transfer_id = report.frame;
  return header;
}

std::size_t encode(const Detections& report, Span<std::uint8_t> out) {
  echofuse_Detections_1_0 wire{};
  wire.time_us = to_time(report.time_us);
  wire.detections.count = report.detections.size();
  for (std::size_t i = 0; i < report.detections.size(); ++i)
    wire.detections.elements[i] = {report.detections[i].delay_s, to_uint16(report.detections[i].weight)};
  std::size_t size = out.size();
  return length_or_nothing(echofuse_Detections_1_0_serialize_(&wire, out.data(), &size), size);
}

Status decode(const TransferHeader& header, Span<const std::uint8_t> payload, Detections& report) {
  report.detections.clear();
  echofuse_Detections_1_0 wire{};
  std::size_t size = payload.size();
  if (echofuse_Detections_1_0_deserialize_(&wire, payload.data(), &size) < 0) return Status::kInvalidInput;
  if (!holds(payload, kTimeBytes + 1, wire.detections.count, 6)) return Status::kInvalidInput;
  report.node_id = header.source;
  report.frame = static_cast<std::uint32_t>(header.transfer_id);
  report.time_us = from_time(wire.time_us);
  for (std::size_t i = 0; i < wire.detections.count; ++i) {
    const echofuse_Detection_1_0& echo = wire.detections.elements[i];
    (void)report.detections.try_push_back({echo.delay, static_cast<float>(echo.weight)});
  }
  return Status::kOk;
}

std::size_t encode(const Tracks& tracks, Span<std::uint8_t> out) {
  echofuse_Tracks_1_0 wire{};
  to_wire(tracks, wire);
  std::size_t size = out.size();
  return length_or_nothing(echofuse_Tracks_1_0_serialize_(&wire, out.data(), &size), size);
}

Status decode(Span<const std::uint8_t> payload, Tracks& tracks) {
  tracks.tracks.clear();
  echofuse_Tracks_1_0 wire{};
  std::size_t size = payload.size();
  if (echofuse_Tracks_1_0_deserialize_(&wire, payload.data(), &size) < 0) return Status::kInvalidInput;
  if (!holds(payload, kTimeBytes + 5, wire.tracks.count, kTrackBytes)) return Status::kInvalidInput;
  return from_wire(wire, tracks);
}

std::size_t encode_spatial(const Tracks& tracks, Span<std::uint8_t> out) {
  echofuse_SpatialTracks_1_0 wire{};
  to_wire(tracks, wire);
  std::size_t size = out.size();
  return length_or_nothing(echofuse_SpatialTracks_1_0_serialize_(&wire, out.data(), &size), size);
}

Status decode_spatial(Span<const std::uint8_t> payload, Tracks& tracks) {
  tracks.tracks.clear();
  echofuse_SpatialTracks_1_0 wire{};
  std::size_t size = payload.size();
  if (echofuse_SpatialTracks_1_0_deserialize_(&wire, payload.data(), &size) < 0) return Status::kInvalidInput;
  if (!holds(payload, kTimeBytes + 5, wire.tracks.count, kSpatialTrackBytes)) return Status::kInvalidInput;
  return from_wire(wire, tracks);
}

std::size_t encode(const NodeHealth& health, Span<std::uint8_t> out) {
  echofuse_NodeHealth_1_0 wire{};
  wire.kind = static_cast<std::uint8_t>(health.kind);
  wire.values.count = health.values.size();
  std::copy(health.values.begin(), health.values.end(), wire.values.elements);
  std::size_t size = out.size();
  return length_or_nothing(echofuse_NodeHealth_1_0_serialize_(&wire, out.data(), &size), size);
}

Status decode(Span<const std::uint8_t> payload, NodeHealth& health) {
  health.values.clear();
  echofuse_NodeHealth_1_0 wire{};
  std::size_t size = payload.size();
  if (echofuse_NodeHealth_1_0_deserialize_(&wire, payload.data(), &size) < 0) return Status::kInvalidInput;
  if (!holds(payload, 2, wire.values.count, 4)) return Status::kInvalidInput;
  if (wire.kind > static_cast<std::uint8_t>(MachineKind::kThroughWall3dHub)) return Status::kInvalidInput;
  health.kind = static_cast<MachineKind>(wire.kind);
  for (std::size_t i = 0; i < wire.values.count; ++i)
    (void)health.values.try_push_back(wire.values.elements[i]);
  return Status::kOk;
}

std::size_t encode(const Heartbeat& heartbeat, Span<std::uint8_t> out) {
  uavcan_node_Heartbeat_1_0 wire{};
  wire.uptime = heartbeat.uptime_s;
  wire.health.value = static_cast<std::uint8_t>(heartbeat.health);
  wire.mode.value = static_cast<std::uint8_t>(heartbeat.mode);
  wire.vendor_specific_status_code = heartbeat.vendor_status;
  std::size_t size = out.size();
  return length_or_nothing(uavcan_node_Heartbeat_1_0_serialize_(&wire, out.data(), &size), size);
}

Status decode(Span<const std::uint8_t> payload, Heartbeat& heartbeat) {
  uavcan_node_Heartbeat_1_0 wire{};
  std::size_t size = payload.size();
  if (uavcan_node_Heartbeat_1_0_deserialize_(&wire, payload.data(), &size) < 0) return Status::kInvalidInput;
  if (wire.mode.value > static_cast<std::uint8_t>(Mode::kSoftwareUpdate)) return Status::kInvalidInput;
  heartbeat.uptime_s = wire.uptime;
  heartbeat.health = static_cast<Health>(wire.health.value);
  heartbeat.mode = static_cast<Mode>(wire.mode.value);
  heartbeat.vendor_status = wire.vendor_specific_status_code;
  return Status::kOk;
}

std::size_t encode_synchronization(std::uint64_t previous_us, Span<std::uint8_t> out) {
  const uavcan_time_Synchronization_1_0 wire{previous_us & kTimeMask};
  std::size_t size = out.size();
  return length_or_nothing(uavcan_time_Synchronization_1_0_serialize_(&wire, out.data(), &size), size);
}

Status decode_synchronization(Span<const std::uint8_t> payload, std::uint64_t& previous_us) {
  uavcan_time_Synchronization_1_0 wire{};
  std::size_t size = payload.size();
  if (uavcan_time_Synchronization_1_0_deserialize_(&wire, payload.data(), &size) < 0)
    return Status::kInvalidInput;
  previous_us = wire.previous_transmission_timestamp_microsecond;
  return Status::kOk;
}

std::size_t encode_raw_scan(std::int64_t time_us, Span<const float> samples, Span<std::uint8_t> out) {
  const std::size_t size = kScanHeaderBytes + sizeof(float) * samples.size();
  if (out.size() < size || samples.size() > 4096) return 0;
  nunavutSetUxx(out.data(), out.size(), 0, to_time(time_us), 56);
  nunavutSetUxx(out.data(), out.size(), 8 * kTimeBytes, samples.size(), 16);
  std::memcpy(out.data() + kScanHeaderBytes, samples.data(), sizeof(float) * samples.size());
  return size;
}

Status decode_raw_scan(Span<const std::uint8_t> payload, std::int64_t& time_us, Span<float> samples,
                       std::size_t& n_samples) {
  n_samples = 0;
  if (payload.size() < kScanHeaderBytes) return Status::kInvalidInput;
  const std::size_t count = nunavutGetU16(payload.data(), payload.size(), 8 * kTimeBytes, 16);
  if (payload.size() < kScanHeaderBytes + sizeof(float) * count) return Status::kInvalidInput;
  time_us = from_time(nunavutGetU64(payload.data(), payload.size(), 0, 56));
  n_samples = count;
  std::memcpy(samples.data(), payload.data() + kScanHeaderBytes,
              sizeof(float) * std::min(count, samples.size()));
  return Status::kOk;
}

std::size_t encode_tap(TapId tap, std::uint32_t scan, Span<const float> values, std::size_t offset,
                       Span<std::uint8_t> out) {
  echofuse_Tap_1_0 wire{};
  wire.tap = static_cast<std::uint8_t>(tap);
  wire.scan = scan;
  wire.offset = static_cast<std::uint16_t>(offset);
  wire.size = static_cast<std::uint16_t>(values.size());
  wire.values.count = std::min(kTapValues, values.size() - std::min(offset, values.size()));
  std::copy_n(values.begin() + offset, wire.values.count, wire.values.elements);
  std::size_t size = out.size();
  return length_or_nothing(echofuse_Tap_1_0_serialize_(&wire, out.data(), &size), size);
}

}  // namespace echofuse::link
