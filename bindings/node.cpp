#include "echofuse/node/node.hpp"

#include <string>

#include "common.hpp"
#include "node_pipeline.hpp"

namespace echofuse::bindings {
namespace {

using namespace echofuse::node;

void bind_pulse_integrator(py::module_& m) {
  ConfigBinder<PulseIntegratorConfig>(m, "PulseIntegratorConfig", "Coherent integration of pulses.")
      .field("pulses_per_scan", &PulseIntegratorConfig::pulses_per_scan,
             "pulse responses averaged into one scan, >= 1");
  py::class_<PulseIntegrator>(m, "PulseIntegrator", "Mean of every N_s pulse responses.")
      .def(py::init<>())
      .def("configure", &PulseIntegrator::configure, py::arg("config"))
      .def("reset", &PulseIntegrator::reset)
      .def(
          "process",
          [](PulseIntegrator& self, const FloatArray& pulse) {
            bool complete = false;
            const Status status = self.process(as_span(pulse, "pulse"), complete);
            return py::make_tuple(status, complete ? py::object(to_array(self.scan())) : py::none());
          },
          py::arg("pulse").noconvert(), "(status, scan (n_samples,) or None while incomplete).");
}

void bind_direct_path(py::module_& m) {
  py::enum_<DirectPathSearch>(m, "DirectPathSearch", "How the direct path's leading edge is searched.")
      .value("serial_backward", DirectPathSearch::kSerialBackward)
      .value("threshold_crossing", DirectPathSearch::kThresholdCrossing)
      .value("jump_back_search_forward", DirectPathSearch::kJumpBackSearchForward);
  ConfigBinder<DirectPathConfig>(m, "DirectPathConfig", "Time of arrival of the direct path.")
      .field("search", &DirectPathConfig::search, "from where to where")
      .field("noise_samples", &DirectPathConfig::noise_samples, "[sample] that give the noise, >= 8")
      .field("early_detection_probability", &DirectPathConfig::early_detection_probability,
             "that noise crosses within noise_samples, in (1e-6, 1)")
      .field("window_samples", &DirectPathConfig::window_samples, "[sample] searched before the peak");
  py::class_<DirectPath>(m, "DirectPath", "Where the direct path arrives.")
      .def_readonly("found", &DirectPath::found)
      .def_readonly("toa_samples", &DirectPath::toa_samples, "[sample]; 0 unless found")
      .def_readonly("threshold", &DirectPath::threshold, "[count]")
      .def_readonly("peak_sample", &DirectPath::peak_sample, "[sample]");
  py::class_<DirectPathSearcher>(m, "DirectPathSearcher", "Time of arrival of the direct path.")
      .def(py::init<>())
      .def("configure", &DirectPathSearcher::configure, py::arg("config"))
      .def(
          "process",
          [](const DirectPathSearcher& self, const FloatArray& envelope) {
            DirectPath direct_path;
            const Status status = self.process(as_span(envelope, "envelope"), direct_path);
            return py::make_tuple(status, direct_path);
          },
          py::arg("envelope").noconvert(), "(status, direct path): envelope (n_samples,) [count].")
      .def("threshold_factor", &DirectPathSearcher::threshold_factor, "threshold over sigma [1]");
}

void bind_clutter(py::module_& m) {
  py::enum_<ClutterMethod>(m, "ClutterMethod", "What is taken as background.")
      .value("empty_room_envelope", ClutterMethod::kEmptyRoomEnvelope, "envelope less the empty room's")
      .value("empty_room_scan", ClutterMethod::kEmptyRoomScan, "scan less the empty room's")
      .value("empty_room_shadowed", ClutterMethod::kEmptyRoomShadowed,
             "scan less what people's shadows leave of the empty room's")
      .value("exponential_average", ClutterMethod::kExponentialAverage, "scan less its mean so far")
      .value("frame_difference", ClutterMethod::kFrameDifference, "scan less an earlier scan");
  ConfigBinder<ClutterConfig>(m, "ClutterConfig", "Removal of what stands still.")
      .field("method", &ClutterConfig::method, "what is taken as background")
      .field("averaging_factor", &ClutterConfig::averaging_factor, "weight of the past, in (0, 1)")
      .field("learning_scans", &ClutterConfig::learning_scans, "scans that make a background, >= 1")
      .field("difference_lag_scans", &ClutterConfig::difference_lag_scans,
             "frame difference: how much earlier")
      .field("shadow_window_samples", &ClutterConfig::shadow_window_samples, "odd, 3 to 127");
  py::class_<ClutterFilter>(m, "ClutterFilter", "Difference from a background.")
      .def(py::init<>())
      .def("configure", &ClutterFilter::configure, py::arg("config"), py::arg("n_samples"))
      .def("reset", &ClutterFilter::reset)
      .def("ready", &ClutterFilter::ready)
      .def(
          "add_empty_room",
          [](ClutterFilter& self, const FloatArray& samples) {
            return self.add_empty_room(as_span(samples, "samples"));
          },
          py::arg("samples").noconvert(), "samples (n_samples,) [count]")
      .def(
          "process",
          [](ClutterFilter& self, const FloatArray& samples) {
            const Span<const float> input = as_span(samples, "samples");
            FloatArray residual(samples.size());
            const Status status = self.process(input, {residual.mutable_data(), input.size()});
            return py::make_tuple(status, status == Status::kOk ? residual : FloatArray(0));
          },
          py::arg("samples").noconvert(), "(status, residual): both (n_samples,) [count], signed.");
  m.def(
      "rectify",
      [](const FloatArray& samples) {
        FloatArray rectified = to_array(as_span(samples, "samples"));
        rectify({rectified.mutable_data(), static_cast<std::size_t>(rectified.size())});
        return rectified;
      },
      py::arg("samples").noconvert(), "Half-wave rectifier: a new array, negative values 0.");
}

void bind_cfar(py::module_& m) {
  py::enum_<CfarMethod>(m, "CfarMethod", "Where the threshold comes from.")
      .value("double_threshold_buffer", CfarMethod::kDoubleThresholdBuffer, "Algorithm 1, both directions")
      .value("cell_averaging", CfarMethod::kCellAveraging)
      .value("global_average", CfarMethod::kGlobalAverage)
      .value("ordered_statistic", CfarMethod::kOrderedStatistic);
  ConfigBinder<CfarConfig>(m, "CfarConfig", "Detector with a constant false-alarm rate.")
      .field("method", &CfarConfig::method, "where the threshold comes from")
      .field("false_alarm_probability", &CfarConfig::false_alarm_probability, "per sample, in [1e-9, 0.5]")
      .field("training_cells_per_side", &CfarConfig::training_cells_per_side, "[sample] 1 .. 64")
      .field("guard_cells_per_side", &CfarConfig::guard_cells_per_side, "[sample] >= 0")
      .field("ordered_rank_fraction", &CfarConfig::ordered_rank_fraction, "rank over cells, in (0, 1]")
      .field("local_factor", &CfarConfig::local_factor, "buffer: weight of the local power, > 0")
      .field("global_factor", &CfarConfig::global_factor, "buffer: weight of the global power, >= 0")
      .field("buffer_samples", &CfarConfig::buffer_samples, "[sample] buffer: 1 .. 128")
      .field("max_rises", &CfarConfig::max_rises, "buffer: more rises freeze the local power")
      .field("rise_threshold_factor", &CfarConfig::rise_threshold_factor,
             "buffer: a rise over the global power");
  py::class_<CfarDetector>(m, "CfarDetector", "Decides sample by sample.")
      .def(py::init<>())
      .def("configure", &CfarDetector::configure, py::arg("config"))
      .def(
          "process",
          [](const CfarDetector& self, const FloatArray& amplitude) -> py::tuple {
            const Span<const float> samples = as_span(amplitude, "amplitude");
            FloatArray threshold(amplitude.size());
            ArrayOf<std::uint8_t> decisions(amplitude.size());
            const Status status = self.process(samples, {threshold.mutable_data(), samples.size()},
                                               {decisions.mutable_data(), samples.size()});
            if (status != Status::kOk) return py::make_tuple(status, FloatArray(0), ArrayOf<std::uint8_t>(0));
            return py::make_tuple(status, threshold, decisions);
          },
          py::arg("amplitude").noconvert(),
          "(status, threshold [count^2], decisions uint8): all (n_samples,); amplitude in [count].")
      .def("min_samples", &CfarDetector::min_samples, "[sample] the shortest scan")
      .def("factor", &CfarDetector::factor, py::arg("n_cells"),
           "threshold over the cells' mean or ranked one");
}

void bind_noise_floor(py::module_& m) {
  ConfigBinder<NoiseFloorConfig>(m, "NoiseFloorConfig",
                                 "Least threshold, from the quietest part of the scans.")
      .field("factor", &NoiseFloorConfig::factor, "least amplitude over the floor, >= 0; 0: none")
      .field("block_samples", &NoiseFloorConfig::block_samples, "[sample] length of a block")
      .field("averaging_factor", &NoiseFloorConfig::averaging_factor, "weight of the past, in (0, 1)");
  py::class_<NoiseFloor>(m, "NoiseFloor", "Least threshold, from the quietest part of the scans.")
      .def(py::init<>())
      .def("configure", &NoiseFloor::configure, py::arg("config"))
      .def("reset", &NoiseFloor::reset)
      .def(
          "process",
          [](NoiseFloor& self, const FloatArray& amplitude, const FloatArray& threshold) {
            FloatArray raised = to_array(as_span(threshold, "threshold"));
            const Status status =
                self.process(as_span(amplitude, "amplitude"),
                             {raised.mutable_data(), static_cast<std::size_t>(raised.size())});
            return py::make_tuple(status, status == Status::kOk ? raised : FloatArray(0));
          },
          py::arg("amplitude").noconvert(), py::arg("threshold").noconvert(),
          "(status, threshold): all (n_samples,); amplitude [count], thresholds [count^2].")
      .def("floor", &NoiseFloor::floor, "[count] rms");
}

void bind_range_clusters(py::module_& m) {
  py::enum_<ClusterRepresentative>(m, "ClusterRepresentative", "What a cluster stands for.")
      .value("leading_edge", ClusterRepresentative::kLeadingEdge)
      .value("median", ClusterRepresentative::kMedian);
  ConfigBinder<RangeClusterConfig>(m, "RangeClusterConfig", "One-dimensional clustering of decisions.")
      .field("merge_distance_s", &RangeClusterConfig::merge_distance_s, "[s] closer medians merge")
      .field("min_weight", &RangeClusterConfig::min_weight, "lighter clusters are dropped, >= 1")
      .field("representative", &RangeClusterConfig::representative, "what a cluster stands for");
  PYBIND11_NUMPY_DTYPE(RangeCluster, position_samples, weight, first_sample, last_sample);
  py::class_<RangeClusterer>(m, "RangeClusterer", "One-dimensional clustering of decisions.")
      .def(py::init<>())
      .def("configure", &RangeClusterer::configure, py::arg("config"), py::arg("sample_rate_hz"))
      .def(
          "process",
          [](RangeClusterer& self, const ArrayOf<std::uint8_t>& decisions, const FloatArray& amplitude,
             const FloatArray& threshold) {
            BoundedVector<RangeCluster, kMaxClustersPerScan> clusters;  // the node's own capacity
            const Status status =
                self.process(as_span(decisions, "decisions"), as_span(amplitude, "amplitude"),
                             as_span(threshold, "threshold"), clusters);
            return py::make_tuple(status, to_array(clusters));
          },
          py::arg("decisions").noconvert(), py::arg("amplitude").noconvert(),
          py::arg("threshold").noconvert(),
          "(status, clusters): inputs (n_samples,); clusters is a structured array.");
}

py::dict counters(const SensorRadarNode& node) {
  const SensorRadarNodeCounters& counted = node.counters();
  py::dict result;
  result["scans"] = counted.scans;
  result["rejected_scans"] = counted.rejected_scans;
  result["learning_scans"] = counted.learning_scans;
  result["direct_path_missing"] = counted.direct_path_missing;
  result["alignment_doubts"] = counted.alignment_doubts;
  result["undetectable_scans"] = counted.undetectable_scans;
  result["truncated_detections"] = counted.truncated_detections;
  return result;
}

void bind_node_config(py::module_& m) {
  py::enum_<TimeZero>(m, "TimeZero", "Where delays are counted from.")
      .value("direct_path", TimeZero::kDirectPath, "the background's direct path")
      .value("recorded", TimeZero::kRecorded, "first_sample_s is known");
  ConfigBinder<SensorRadarNodeConfig>(m, "SensorRadarNodeConfig", "A node of the pipeline sensor_radar.")
      .field("node_id", &SensorRadarNodeConfig::node_id, ">= 0")
      .field("n_samples", &SensorRadarNodeConfig::n_samples, "[sample] of a scan")
      .field("sample_rate_hz", &SensorRadarNodeConfig::sample_rate_hz, "[Hz]")
      .field("first_sample_s", &SensorRadarNodeConfig::first_sample_s, "[s] delay of sample 0, if recorded")
      .field("baseline_m", &SensorRadarNodeConfig::baseline_m, "[m] transmitter to receiver, 0 if monostatic")
      .field("time_zero", &SensorRadarNodeConfig::time_zero, "where delays are counted from")
      .field("delay_offset_s", &SensorRadarNodeConfig::delay_offset_s,
             "[s] calibration, added to every delay")
      .field("blind_zone_s", &SensorRadarNodeConfig::blind_zone_s,
             "[s] after the direct path: not judged, >= 0")
      .field("pulse_integrator", &SensorRadarNodeConfig::pulse_integrator)
      .field("envelope", &SensorRadarNodeConfig::envelope)
      .field("direct_path", &SensorRadarNodeConfig::direct_path)
      .field("alignment", &SensorRadarNodeConfig::alignment)
      .field("clutter", &SensorRadarNodeConfig::clutter)
      .field("cfar", &SensorRadarNodeConfig::cfar)
      .field("noise_floor", &SensorRadarNodeConfig::noise_floor)
      .field("range_clusters", &SensorRadarNodeConfig::range_clusters);
}

void bind_sensor_radar_node(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(DetectionRow, delay_s, weight);
  py::class_<SensorRadarNode> node(m, "SensorRadarNode", "Raw scans in, delays of echoes from people out.");
  node.def(py::init<>())
      .def("configure", &SensorRadarNode::configure, py::arg("config"))
      .def("reset", &SensorRadarNode::reset)
      .def(
          "set_empty_room",
          [](SensorRadarNode& self, const FloatArray& scan) {
            return self.set_empty_room(as_span(scan, "scan"));
          },
          py::arg("scan").noconvert(),
          "scan (n_samples,) [count] of the empty room, averaged into the background")
      .def("report_ready", &SensorRadarNode::report_ready, "the last process() completed a scan")
      .def("ready", &SensorRadarNode::ready, "the background is known")
      .def("counters", &counters, "What happened since configure(), by name.");
  bind_process(node, "scan");
  m.attr("SENSOR_RADAR_NODE_BYTES") = sizeof(SensorRadarNode);
}

}  // namespace

void bind_node(py::module_& m) {
  bind_pulse_integrator(m);
  bind_direct_path(m);
  bind_clutter(m);
  bind_cfar(m);
  bind_noise_floor(m);
  bind_range_clusters(m);
  bind_node_config(m);
  bind_sensor_radar_node(m);
}

}  // namespace echofuse::bindings
