#include "echofuse/hub/hub.hpp"
#include "hub.hpp"
#include "taps.hpp"
#include "tracks.hpp"

namespace echofuse::bindings {
namespace {

using hub::SensorRadarHub;
using hub::SensorRadarHubConfig;
using hub::SensorRadarHubCounters;

py::tuple poll(SensorRadarHub& self, std::int64_t now_us) {
  link::Tracks tracks;
  bool closed = false;
  const Status status = self.poll(now_us, tracks, closed);
  if (!closed) return py::make_tuple(status, py::none());
  return py::make_tuple(status, py::make_tuple(tracks.time_us, tracks.frame, to_array(tracks)));
}

py::dict counters(const SensorRadarHub& self) {
  const SensorRadarHubCounters c = self.counters();
  py::dict by_name;
  by_name["accepted"] = c.reports.accepted;
  by_name["late"] = c.reports.late;
  by_name["early"] = c.reports.early;
  by_name["doubled"] = c.reports.doubled;
  by_name["malformed"] = c.reports.malformed;
  by_name["unknown_node"] = c.reports.unknown_node;
  by_name["lost"] = c.reports.lost;
  by_name["resynchronised"] = c.reports.resynchronised;
  by_name["frames"] = c.reports.frames;
  by_name["absent"] = c.reports.absent;
  by_name["slow"] = c.reports.slow;
  by_name["tuples"] = c.selection.tuples;
  by_name["dropped_tuples"] = c.selection.dropped_tuples;
  by_name["dropped_detections"] = c.selection.dropped_detections;
  by_name["dropped_measurements"] = c.selection.dropped_measurements;
  by_name["dropped_points"] = c.dropped_points;
  by_name["dropped_births"] = c.dropped_births;
  by_name["clock_faults"] = c.clock_faults;
  return by_name;
}

void set_nodes(SensorRadarHubConfig& config, const std::vector<std::int32_t>& ids, const FloatArray& tx,
               const FloatArray& rx) {
  const auto tx_rows = as_span_of_rows(tx, 2, "tx_m");
  const auto rx_rows = as_span_of_rows(rx, 2, "rx_m");
  if (tx_rows.size() != 2 * ids.size() || rx_rows.size() != 2 * ids.size())
    throw py::value_error("node_ids, tx_m and rx_m must have one row a node");
  if (ids.size() > kMaxNodes) throw py::value_error("at most " + std::to_string(kMaxNodes) + " nodes");
  config.nodes = {};
  config.n_nodes = static_cast<int>(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i)
    config.nodes[i] = {ids[i], {tx_rows[2 * i], tx_rows[2 * i + 1]}, {rx_rows[2 * i], rx_rows[2 * i + 1]}};
}

void bind_config(py::module_& m) {
  py::enum_<hub::Tracker>(m, "Tracker")
      .value("phd", hub::Tracker::kPhd)
      .value("kalman", hub::Tracker::kKalman)
      .value("range", hub::Tracker::kRange);
  ConfigBinder<SensorRadarHubConfig>(m, "SensorRadarHubConfig", "The hub of the pipeline sensor_radar.")
      .field("nodes", &SensorRadarHubConfig::nodes, "the first n_nodes")
      .field("n_nodes", &SensorRadarHubConfig::n_nodes, "at least 3")
      .field("area", &SensorRadarHubConfig::area, "where people are looked for")
      .field("frame_period_s", &SensorRadarHubConfig::frame_period_s, "[s] taken for the first frame, > 0")
      .field("aid_missed_frames", &SensorRadarHubConfig::aid_missed_frames,
             "tracks silent for more frames do not help the selection, >= 0")
      .field("tracker", &SensorRadarHubConfig::tracker, "what follows the points")
      .field("frame_assembler", &SensorRadarHubConfig::frame_assembler)
      .field("ellipse", &SensorRadarHubConfig::ellipse)
      .field("selection", &SensorRadarHubConfig::selection)
      .field("point_clusters", &SensorRadarHubConfig::point_clusters)
      .field("phd", &SensorRadarHubConfig::phd)
      .field("em", &SensorRadarHubConfig::em)
      .field("tracks", &SensorRadarHubConfig::tracks)
      .field("ranges", &SensorRadarHubConfig::ranges)
      .type()
      .def("set_nodes", &set_nodes, py::arg("node_ids"), py::arg("tx_m").noconvert(),
           py::arg("rx_m").noconvert(), "Sets nodes and n_nodes from positions (n, 2) [m].")
      .def(
          "set_area",
          [](SensorRadarHubConfig& config, float min_x_m, float min_y_m, float max_x_m, float max_y_m) {
            config.area = {min_x_m, min_y_m, max_x_m, max_y_m};
          },
          py::arg("min_x_m"), py::arg("min_y_m"), py::arg("max_x_m"), py::arg("max_y_m"));
}

}  // namespace

void bind_hub_pipeline(py::module_& m) {
  bind_config(m);
  py::class_<SensorRadarHub>(m, "SensorRadarHub", "The nodes' reports in, tracks out.")
      .def(py::init<>())
      .def("configure", &SensorRadarHub::configure, py::arg("config"))
      .def("reset", &SensorRadarHub::reset)
      .def("receive", &receive_report<SensorRadarHub>, py::arg("node_id"), py::arg("frame"),
           py::arg("delay_s").noconvert(), py::arg("weight").noconvert(), py::arg("now_us"),
           py::arg("time_us") = 0,
           "One node's report; frame counts the node's scans, time_us is the scan's by the node's clock (0: "
           "not known).")
      .def("poll", &poll, py::arg("now_us"),
           "(status, None or (time_us, frame, tracks)); call until None. tracks is a structured array of "
           "Track.")
      .def(
          "poll_with_taps",
          [](SensorRadarHub& self, std::int64_t now_us) {
            py::dict taps;
            const TapGuard guard(self, taps);
            const py::tuple result = poll(self, now_us);
            return py::make_tuple(result[0], result[1], taps);
          },
          py::arg("now_us"), "(status, None or (time_us, frame, tracks), taps by name, each (n, columns)).")
      .def("counters", &counters, "What happened since configure(), by name.");
  m.attr("SENSOR_RADAR_HUB_BYTES") = sizeof(SensorRadarHub);
  m.attr("MEASUREMENT_STAGES_BYTES") = sizeof(hub::FrameAssembler) + sizeof(hub::MeasurementSelection) +
                                       sizeof(hub::PointClusters) + sizeof(hub::Frame) +
                                       sizeof(BoundedVector<hub::Measurement, kMaxMeasurementsPerFrame>);
}

}  // namespace echofuse::bindings
