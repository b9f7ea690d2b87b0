#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common.hpp"
#include "config_binder.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame_assembler.hpp"
#include "echofuse/hub/path_hub.hpp"
#include "hub.hpp"
#include "taps.hpp"
#include "tracks.hpp"

namespace echofuse::bindings {

inline void add_report_counters(const hub::FrameAssemblerCounters& reports, py::dict& by_name) {
  by_name["accepted"] = reports.accepted;
  by_name["late"] = reports.late;
  by_name["early"] = reports.early;
  by_name["doubled"] = reports.doubled;
  by_name["malformed"] = reports.malformed;
  by_name["unknown_node"] = reports.unknown_node;
  by_name["lost"] = reports.lost;
  by_name["resynchronised"] = reports.resynchronised;
  by_name["frames"] = reports.frames;
  by_name["absent"] = reports.absent;
  by_name["slow"] = reports.slow;
}

/// What all hubs behind a wall count, by name.
inline py::dict path_hub_counters(const hub::PathHubCounters& c) {
  py::dict by_name;
  add_report_counters(c.reports, by_name);
  by_name["couples"] = c.couples;
  by_name["unlocated"] = c.unlocated;
  by_name["outside_area"] = c.outside_area;
  by_name["dropped_points"] = c.dropped_points;
  by_name["dropped_births"] = c.dropped_births;
  by_name["dropped_combinations"] = c.dropped_combinations;
  by_name["clock_faults"] = c.clock_faults;
  return by_name;
}

/// set_nodes of a hub's configuration. point_of: makes a position of its coordinates.
template <std::size_t kDimension, class Config, class PointOf>
void bind_nodes(py::class_<Config>& config, PointOf point_of) {
  config.def(
      "set_nodes",
      [point_of](Config& self, const std::vector<std::int32_t>& ids, const FloatArray& tx,
                 const FloatArray& rx) {
        const auto tx_rows = as_span_of_rows(tx, kDimension, "tx_m");
        const auto rx_rows = as_span_of_rows(rx, kDimension, "rx_m");
        if (tx_rows.size() != kDimension * ids.size() || rx_rows.size() != kDimension * ids.size())
          throw py::value_error("node_ids, tx_m and rx_m must have one row a node");
        const std::size_t most = self.nodes.size();
        if (ids.size() > most) throw py::value_error("at most " + std::to_string(most) + " nodes");
        self.nodes = {};
        self.n_nodes = static_cast<int>(ids.size());
        for (std::size_t i = 0; i < ids.size(); ++i)
          self.nodes[i] = {ids[i], point_of(tx_rows.data() + kDimension * i),
                           point_of(rx_rows.data() + kDimension * i)};
      },
      py::arg("node_ids"), py::arg("tx_m").noconvert(), py::arg("rx_m").noconvert(),
      kDimension == 2 ? "Sets nodes and n_nodes from positions (n, 2) [m]."
                      : "Sets nodes and n_nodes from positions (n, 3) [m].");
}

/// set_nodes and set_area of a hub in the plane.
template <class Config>
void bind_site(py::class_<Config>& config) {
  bind_nodes<2>(config, [](const float* at) { return hub::Point{at[0], at[1]}; });
  config.def(
      "set_area",
      [](Config& self, float min_x_m, float min_y_m, float max_x_m, float max_y_m) {
        self.area = {min_x_m, min_y_m, max_x_m, max_y_m};
      },
      py::arg("min_x_m"), py::arg("min_y_m"), py::arg("max_x_m"), py::arg("max_y_m"));
}

template <class Hub>
py::tuple poll_hub(Hub& self, std::int64_t now_us) {
  link::Tracks tracks;
  bool closed = false;
  const Status status = self.poll(now_us, tracks, closed);
  if (!closed) return py::make_tuple(status, py::none());
  return py::make_tuple(status, py::make_tuple(tracks.time_us, tracks.frame, to_array(tracks)));
}

/// What every hub does, under the same names. counters: a function of the hub that returns a dict.
template <class Hub, class Counters>
void bind_hub_pipeline_of(py::module_& m, const char* name, Counters counters) {
  py::class_<Hub>(m, name, "The nodes' reports in, tracks out.")
      .def(py::init<>())
      .def("configure", &Hub::configure, py::arg("config"))
      .def("reset", &Hub::reset)
      .def("receive", &receive_report<Hub>, py::arg("node_id"), py::arg("frame"),
           py::arg("delay_s").noconvert(), py::arg("weight").noconvert(), py::arg("now_us"),
           py::arg("time_us") = 0,
           "One node's report; frame counts the node's scans, time_us is the scan's by the node's clock (0: "
           "not known).")
      .def("poll", &poll_hub<Hub>, py::arg("now_us"),
           "(status, None or (time_us, frame, tracks)); call until None. tracks is a structured array of "
           "Track.")
      .def(
          "poll_with_taps",
          [](Hub& self, std::int64_t now_us) {
            py::dict taps;
            const TapGuard guard(self, taps);
            const py::tuple result = poll_hub(self, now_us);
            return py::make_tuple(result[0], result[1], taps);
          },
          py::arg("now_us"), "(status, None or (time_us, frame, tracks), taps by name, each (n, columns)).")
      .def("counters", counters, "What happened since configure(), by name.");
}

}  // namespace echofuse::bindings
