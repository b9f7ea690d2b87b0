#pragma once

#include <cstdint>

#include "echofuse/core/span.hpp"

namespace echofuse::hub {

struct Point {
  float x_m = 0.0f;  ///< [m]
  float y_m = 0.0f;  ///< [m]
};

/// A rectangle along the axes, edges included.
struct Area {
  float min_x_m = 0.0f;  ///< [m]
  float min_y_m = 0.0f;  ///< [m]
  float max_x_m = 0.0f;  ///< [m] > min_x_m
  float max_y_m = 0.0f;  ///< [m] > min_y_m
};

/// One transmitter and receiver pair: the foci of its ellipses. Monostatic when both are in one place.
struct NodeSite {
  std::int32_t node_id = 0;
  Point tx;
  Point rx;
};

const char* invalid_field(const Point& point);
const char* invalid_field(const Area& area);
const char* invalid_field(const NodeSite& node);

/// Edges included.
bool contains(const Area& area, const Point& position);

/// [m] predicted path tx -> nearest skin of a round person -> rx:
/// |z - tx| + |z - rx| - 2 R cos(beta / 2), beta the bistatic angle.
/// gradient: when not null, its derivative with respect to the position [1].
/// Reference: python/echofuse/reference/hub/locate/site.py
float path_length(const Point& position, const Point& tx, const Point& rx, float body_radius_m,
                  Point* gradient = nullptr);

/// What makes locating impossible, or nullptr: "n_nodes" (under 3), "nodes" (not finite; two with the same
/// foci; two with one id; all antennas on a line that the area does not lie beside, for then a point and its
/// mirror image have the same paths), "area" (empty or not finite).
const char* invalid_site(Span<const NodeSite> nodes, const Area& area);

}  // namespace echofuse::hub
