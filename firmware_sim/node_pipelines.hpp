#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/link/messages.hpp"
#include "echofuse/link/register_server.hpp"
#include "echofuse/node/node.hpp"
#include "echofuse/node/registers.hpp"
#include "echofuse/node/through_wall.hpp"

/// What the firmware of a node has to know of its pipeline. An image is of one of them, which CMake names (ECHOFUSE_PIPELINE).
namespace echofuse::firmware::node_pipelines {

struct SensorRadar {
  using Node = node::SensorRadarNode;
  using Config = node::SensorRadarNodeConfig;
  static constexpr link::MachineKind kKind = link::MachineKind::kSensorRadarNode;
  static constexpr const char* kName = "echofuse.sensor_radar.node";
  static constexpr std::size_t kScanSamples = kMaxSamplesPerScan;  ///< that the radar gives at once
  static constexpr bool kTakesEmptyRoom = true;

  static Span<const link::RegisterField> registers() { return node::config_registers(); }

  static bool healthy(const Node& node) { return node.counters().rejected_scans == 0; }

  /// In the order of docs/link_protocol.md.
  static std::array<std::uint32_t, 7> counted(const Node& node) {
    const node::SensorRadarNodeCounters& c = node.counters();
    return {c.scans,
            c.rejected_scans,
            c.learning_scans,
            c.direct_path_missing,
            c.alignment_doubts,
            c.undetectable_scans,
            c.truncated_detections};
  }
};

struct ThroughWall {
  using Node = node::ThroughWallNode;
  using Config = node::ThroughWallNodeConfig;
  static constexpr link::MachineKind kKind = link::MachineKind::kThroughWallNode;
  static constexpr const char* kName = "echofuse.through_wall.node";
  static constexpr std::size_t kScanSamples = kMaxResponseSamples;
  static constexpr bool kTakesEmptyRoom = false;

  static Span<const link::RegisterField> registers() { return node::through_wall_registers(); }

  static bool healthy(const Node& node) {
    const node::ThroughWallNodeCounters& c = node.counters();
    return c.rejected_responses + c.dead_responses + c.saturated_responses + c.cross_talk_missing == 0;
  }

  /// In the order of docs/link_protocol.md.
  static std::array<std::uint32_t, 8> counted(const Node& node) {
    const node::ThroughWallNodeCounters& c = node.counters();
    return {c.responses,          c.rejected_responses, c.dead_responses,  c.saturated_responses,
            c.cross_talk_missing, c.settling_responses, c.time_zero_moved, c.truncated_detections};
  }
};

}  // namespace echofuse::firmware::node_pipelines
