#include "hub_pipeline.hpp"
#include "echofuse/hub/hub.hpp"

namespace echofuse::bindings {
namespace {

using hub::SensorRadarHub;
using hub::SensorRadarHubConfig;
using hub::SensorRadarHubCounters;

py::dict counters(const SensorRadarHub& self) {
  const SensorRadarHubCounters c = self.counters();
  py::dict by_name;
  add_report_counters(c.reports, by_name);
  by_name["tuples"] = c.selection.tuples;
  by_name["dropped_tuples"] = c.selection.dropped_tuples;
  by_name["dropped_detections"] = c.selection.dropped_detections;
  by_name["dropped_measurements"] = c.selection.dropped_measurements;
  by_name["dropped_points"] = c.dropped_points;
  by_name["dropped_births"] = c.dropped_births;
  by_name["clock_faults"] = c.clock_faults;
  return by_name;
}

void bind_config(py::module_& m) {
  py::enum_<hub::Tracker>(m, "Tracker")
      .value("phd", hub::Tracker::kPhd)
      .value("kalman", hub::Tracker::kKalman)
      .value("range", hub::Tracker::kRange);
  ConfigBinder<SensorRadarHubConfig> config(m, "SensorRadarHubConfig",
                                            "The hub of the pipeline sensor_radar.");
  config.field("nodes", &SensorRadarHubConfig::nodes, "the first n_nodes")
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
      .field("ranges", &SensorRadarHubConfig::ranges);
  bind_site(config.type());
}

}  // namespace

void bind_hub_pipeline(py::module_& m) {
  bind_config(m);
  bind_hub_pipeline_of<SensorRadarHub>(m, "SensorRadarHub", &counters);
  m.attr("SENSOR_RADAR_HUB_BYTES") = sizeof(SensorRadarHub);
  m.attr("MEASUREMENT_STAGES_BYTES") = sizeof(hub::FrameAssembler) + sizeof(hub::MeasurementSelection) +
                                       sizeof(hub::PointClusters) + sizeof(hub::Frame) +
                                       sizeof(BoundedVector<hub::Measurement, kMaxMeasurementsPerFrame>);
}

}  // namespace echofuse::bindings
