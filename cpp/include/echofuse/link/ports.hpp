#pragma once

#include <cstdint>

/// Where messages are published and services served. The subjects of our own messages are defaults, which the registers
/// uavcan.pub.NAME.id and uavcan.sub.NAME.id change.
namespace echofuse::link {

inline constexpr std::uint16_t kHeartbeatSubject = 7509;
inline constexpr std::uint16_t kTimeSubject = 7168;
inline constexpr std::uint16_t kRegisterAccessService = 384;
inline constexpr std::uint16_t kRegisterListService = 385;
inline constexpr std::uint16_t kGetInfoService = 430;

struct Ports {
  std::uint16_t detections = 6200;
  std::uint16_t tracks = 6201;
  std::uint16_t breathing_observations = 6202;
  std::uint16_t motion_report = 6203;
  std::uint16_t persons = 6204;
  std::uint16_t node_health = 6205;
  std::uint16_t tap = 6206;
  std::uint16_t raw_scan = 6207;
  std::uint16_t spatial_tracks = 6208;
};

}  // namespace echofuse::link
