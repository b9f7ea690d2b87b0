#pragma once

#include "echofuse/core/span.hpp"
#include "echofuse/link/register_server.hpp"

namespace echofuse::hub {

/// The members of SensorRadarHubConfig as registers, each under its name in a site file, and of each node.
Span<const link::RegisterField> config_registers();

/// The members of ThroughWallHubConfig, and of ThroughWall3dHubConfig, likewise.
Span<const link::RegisterField> through_wall_registers();
Span<const link::RegisterField> through_wall_3d_registers();

}  // namespace echofuse::hub
