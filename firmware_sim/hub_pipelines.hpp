#pragma once

#include <array>
#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/hub/hub.hpp"
#include "echofuse/hub/registers.hpp"
#include "echofuse/hub/through_wall.hpp"
#include "echofuse/hub/through_wall_3d.hpp"
#include "echofuse/link/messages.hpp"
#include "echofuse/link/register_server.hpp"

/// What the firmware of a hub has to know of its pipeline. An image is of one of them, which CMake names (ECHOFUSE_PIPELINE).
namespace echofuse::firmware::hub_pipelines {

struct SensorRadar {
  using Hub = hub::SensorRadarHub;
  using Config = hub::SensorRadarHubConfig;
  static constexpr link::MachineKind kKind = link::MachineKind::kSensorRadarHub;
  static constexpr bool kSpatial = false;  ///< tells heights too, so SpatialTracks and not Tracks
  static constexpr const char* kName = "echofuse.sensor_radar.hub";

  static Span<const link::RegisterField> registers() { return hub::config_registers(); }

  /// In the order of docs/link_protocol.md. undecodable: of the firmware itself.
  static std::array<std::uint32_t, 19> counted(const hub::SensorRadarHubCounters& c,
                                               std::uint32_t undecodable) {
    return {c.reports.accepted,
            c.reports.late,
            c.reports.early,
            c.reports.doubled,
            c.reports.malformed,
            c.reports.unknown_node,
            c.reports.lost,
            c.reports.resynchronised,
            c.reports.frames,
            c.reports.absent,
            c.reports.slow,
            static_cast<std::uint32_t>(c.selection.tuples),
            static_cast<std::uint32_t>(c.selection.dropped_tuples),
            static_cast<std::uint32_t>(c.selection.dropped_detections),
            static_cast<std::uint32_t>(c.selection.dropped_measurements),
            static_cast<std::uint32_t>(c.dropped_points),
            c.dropped_births,
            c.clock_faults,
            undecodable};
  }
};

struct ThroughWall {
  using Hub = hub::ThroughWallHub;
  using Config = hub::ThroughWallHubConfig;
  static constexpr link::MachineKind kKind = link::MachineKind::kThroughWallHub;
  static constexpr bool kSpatial = false;
  static constexpr const char* kName = "echofuse.through_wall.hub";

  static Span<const link::RegisterField> registers() { return hub::through_wall_registers(); }

  /// In the order of docs/link_protocol.md. undecodable: of the firmware itself.
  static std::array<std::uint32_t, 19> counted(const hub::ThroughWallHubCounters& c,
                                               std::uint32_t undecodable) {
    return {c.reports.accepted, c.reports.late,           c.reports.early,
            c.reports.doubled,  c.reports.malformed,      c.reports.unknown_node,
            c.reports.lost,     c.reports.resynchronised, c.reports.frames,
            c.reports.absent,   c.reports.slow,           c.couples,
            c.unlocated,        c.outside_area,           c.dropped_points,
            c.dropped_births,   c.dropped_combinations,   c.clock_faults,
            undecodable};
  }
};

struct ThroughWall3d {
  using Hub = hub::ThroughWall3dHub;
  using Config = hub::ThroughWall3dHubConfig;
  static constexpr link::MachineKind kKind = link::MachineKind::kThroughWall3dHub;
  static constexpr bool kSpatial = true;
  static constexpr const char* kName = "echofuse.through_wall_3d.hub";

  static Span<const link::RegisterField> registers() { return hub::through_wall_3d_registers(); }

  /// In the order of docs/link_protocol.md. undecodable: of the firmware itself.
  static std::array<std::uint32_t, 21> counted(const hub::ThroughWall3dHubCounters& c,
                                               std::uint32_t undecodable) {
    return {c.reports.accepted,
            c.reports.late,
            c.reports.early,
            c.reports.doubled,
            c.reports.malformed,
            c.reports.unknown_node,
            c.reports.lost,
            c.reports.resynchronised,
            c.reports.frames,
            c.reports.absent,
            c.reports.slow,
            c.couples,
            c.quads,
            c.clipped,
            c.unlocated,
            c.outside_area,
            c.dropped_points,
            c.dropped_births,
            c.dropped_combinations,
            c.clock_faults,
            undecodable};
  }
};

}  // namespace echofuse::firmware::hub_pipelines
