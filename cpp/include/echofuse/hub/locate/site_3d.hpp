#pragma once

#include <cstdint>

#include "echofuse/hub/locate/planar_3d.hpp"

namespace echofuse::hub {

/// A room along the axes, edges included.
struct Box {
  float min_x_m = 0.0f;  ///< [m]
  float min_y_m = 0.0f;  ///< [m]
  float min_z_m = 0.0f;  ///< [m]
  float max_x_m = 0.0f;  ///< [m] > min_x_m
  float max_y_m = 0.0f;  ///< [m] > min_y_m
  float max_z_m = 0.0f;  ///< [m] > min_z_m
};

/// One transmitter and receiver pair in space.
struct NodeSite3d {
  std::int32_t node_id = 0;
  Point3 tx;
  Point3 rx;
};

const char* invalid_field(const Point3& point);
const char* invalid_field(const Box& box);
const char* invalid_field(const NodeSite3d& node);

}  // namespace echofuse::hub
