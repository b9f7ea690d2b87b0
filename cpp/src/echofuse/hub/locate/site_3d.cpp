#include "echofuse/hub/locate/site_3d.hpp"

#include <cmath>

namespace echofuse::hub {

const char* invalid_field(const Point3& point) {
  if (!std::isfinite(point.x_m)) return "x_m";
  if (!std::isfinite(point.y_m)) return "y_m";
  if (!std::isfinite(point.z_m)) return "z_m";
  return nullptr;
}

const char* invalid_field(const Box& box) {
  if (!std::isfinite(box.min_x_m)) return "min_x_m";
  if (!std::isfinite(box.min_y_m)) return "min_y_m";
  if (!std::isfinite(box.min_z_m)) return "min_z_m";
  if (!(box.max_x_m > box.min_x_m && std::isfinite(box.max_x_m))) return "max_x_m";
  if (!(box.max_y_m > box.min_y_m && std::isfinite(box.max_y_m))) return "max_y_m";
  if (!(box.max_z_m > box.min_z_m && std::isfinite(box.max_z_m))) return "max_z_m";
  return nullptr;
}

const char* invalid_field(const NodeSite3d& node) {
  if (invalid_field(node.tx) != nullptr) return "tx";
  if (invalid_field(node.rx) != nullptr) return "rx";
  return nullptr;
}

}  // namespace echofuse::hub
