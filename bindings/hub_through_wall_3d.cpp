#include "echofuse/hub/through_wall_3d.hpp"

#include "hub_pipeline.hpp"

namespace echofuse::bindings {
namespace {

using hub::Box;
using hub::NodeSite3d;
using hub::Point3;
using hub::ThroughWall3dHub;

py::dict counters(const ThroughWall3dHub& self) {
  const hub::ThroughWall3dHubCounters c = self.counters();
  py::dict by_name = path_hub_counters(c);
  by_name["quads"] = c.quads;
  by_name["clipped"] = c.clipped;
  return by_name;
}

void bind_site_3d(py::module_& m) {
  ConfigBinder<Point3>(m, "Point3", "A position in space.")
      .field("x_m", &Point3::x_m, "[m]")
      .field("y_m", &Point3::y_m, "[m]")
      .field("z_m", &Point3::z_m, "[m]");
  ConfigBinder<Box>(m, "Box", "A room along the axes, edges included.")
      .field("min_x_m", &Box::min_x_m, "[m]")
      .field("min_y_m", &Box::min_y_m, "[m]")
      .field("min_z_m", &Box::min_z_m, "[m]")
      .field("max_x_m", &Box::max_x_m, "[m]")
      .field("max_y_m", &Box::max_y_m, "[m]")
      .field("max_z_m", &Box::max_z_m, "[m]");
  ConfigBinder<NodeSite3d>(m, "NodeSite3d", "Transmitter and receiver of one node.")
      .field("node_id", &NodeSite3d::node_id)
      .field("tx", &NodeSite3d::tx, "[m]")
      .field("rx", &NodeSite3d::rx, "[m]");
}

}  // namespace

void bind_hub_through_wall_3d(py::module_& m) {
  bind_site_3d(m);
  using Config = hub::ThroughWall3dHubConfig;
  ConfigBinder<Config> config(m, "ThroughWall3dHubConfig", "The hub of the pipeline through_wall_3d.");
  config.field("nodes", &Config::nodes, "receivers at -d and d along x, then at -d and d up")
      .field("n_nodes", &Config::n_nodes, "4, a cross with their one transmitter midway")
      .field("area", &Config::area, "the room behind the wall")
      .field("frame_period_s", &Config::frame_period_s, "[s] taken for the first frame, > 0")
      .field("body_radius_m", &Config::body_radius_m,
             "[m] from an echo's beginning to a person's middle, >= 0")
      .field("track_aided", &Config::track_aided, "tracks take part in the pairing")
      .field("frame_assembler", &Config::frame_assembler)
      .field("trace_pairing", &Config::trace_pairing)
      .field("range_difference_m", &Config::range_difference_m, "[m] at most, of both axes' distances, > 0")
      .field("taylor_3d", &Config::taylor_3d)
      .field("path_std_m", &Config::path_std_m, "[m] of the paths that locate a target")
      .field("path_tracker", &Config::path_tracker)
      .field("tracks", &Config::tracks);
  bind_nodes<3>(config.type(), [](const float* at) { return Point3{at[0], at[1], at[2]}; });
  config.type().def(
      "set_area",
      [](Config& self, float min_x_m, float min_y_m, float min_z_m, float max_x_m, float max_y_m,
         float max_z_m) { self.area = {min_x_m, min_y_m, min_z_m, max_x_m, max_y_m, max_z_m}; },
      py::arg("min_x_m"), py::arg("min_y_m"), py::arg("min_z_m"), py::arg("max_x_m"), py::arg("max_y_m"),
      py::arg("max_z_m"));
  bind_hub_pipeline_of<ThroughWall3dHub>(m, "ThroughWall3dHub", &counters);
  m.attr("THROUGH_WALL_3D_HUB_BYTES") = sizeof(ThroughWall3dHub);
}

}  // namespace echofuse::bindings
