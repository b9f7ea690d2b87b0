#pragma once

#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"

namespace echofuse::link {

/// One echo that a node believes to be a person's.
struct Detection {
  float delay_s;  ///< [s] propagation delay transmitter -> person -> receiver
  float weight;   ///< [1] number of samples that the detector marked for it
};

/// A node's report on one scan.
struct Detections {
  std::int32_t node_id = 0;
  std::uint32_t frame = 0;                                     ///< counts the node's scans
  std::int64_t time_us = 0;                                    ///< [us] of the scan, the node's clock
  BoundedVector<Detection, kMaxDetectionsPerNode> detections;  ///< heaviest kept, ascending delay
};

enum class TrackState : std::uint8_t {
  kUnconfirmed = 0,  ///< new: dies at its first miss
  kConfirmed = 1,    ///< updated in this frame
  kSilent = 2,       ///< confirmed before, not updated in this frame
  kDead = 3,         ///< not reported any more
};

struct Track {
  std::int32_t id;  ///< unique while the hub runs, ascending by birth
  TrackState state;
  std::int32_t frames_since_update;                            ///< 0 when updated in this frame
  float x_m, y_m, z_m;                                         ///< [m] position; z is 0 of a planar hub
  float vx_mps, vy_mps, vz_mps;                                ///< [m/s] velocity
  float covariance_xx_m2, covariance_xy_m2, covariance_yy_m2;  ///< [m^2] of the position
  float covariance_xz_m2 = 0.0f, covariance_yz_m2 = 0.0f, covariance_zz_m2 = 0.0f;
};

/// What the hub says after a frame.
struct Tracks {
  std::int64_t time_us = 0;                 ///< [us] of the frame, the hub's clock
  std::uint32_t frame = 0;                  ///< counts the hub's frames
  BoundedVector<Track, kMaxTracks> tracks;  ///< ascending id; no dead ones
};

enum class MachineKind : std::uint8_t {
  kSensorRadarNode = 0,
  kSensorRadarHub = 1,
  kThroughWallNode = 2,
  kThroughWallHub = 3,
  kThroughWall3dHub = 4,
};

/// What a machine has counted since its start; the order of a kind's values stands in docs/link_protocol.md.
struct NodeHealth {
  MachineKind kind = MachineKind::kSensorRadarNode;
  BoundedVector<std::uint32_t, kMaxHealthValues> values;
};

/// Values of uavcan.node.Health and uavcan.node.Mode.
enum class Health : std::uint8_t { kNominal = 0, kAdvisory = 1, kCaution = 2, kWarning = 3 };
enum class Mode : std::uint8_t {
  kOperational = 0,
  kInitialization = 1,
  kMaintenance = 2,
  kSoftwareUpdate = 3
};

struct Heartbeat {
  std::uint32_t uptime_s = 0;
  Health health = Health::kNominal;
  Mode mode = Mode::kOperational;
  std::uint8_t vendor_status = 0;
};

}  // namespace echofuse::link
