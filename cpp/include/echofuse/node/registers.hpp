#pragma once

#include "echofuse/core/span.hpp"
#include "echofuse/link/register_server.hpp"

namespace echofuse::node {

/// The members of SensorRadarNodeConfig as registers, each under its name in a site file, but for node_id, which is the board's.
Span<const link::RegisterField> config_registers();

/// The members of ThroughWallNodeConfig, likewise.
Span<const link::RegisterField> through_wall_registers();

}  // namespace echofuse::node
