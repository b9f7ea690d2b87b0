#include "common.hpp"
#include "echofuse/node/through_wall.hpp"
#include "node_pipeline.hpp"

namespace echofuse::bindings {
namespace {

using namespace echofuse::node;

py::dict counters(const ThroughWallNode& node) {
  const ThroughWallNodeCounters& counted = node.counters();
  py::dict result;
  result["responses"] = counted.responses;
  result["dead_responses"] = counted.dead_responses;
  result["saturated_responses"] = counted.saturated_responses;
  result["cross_talk_missing"] = counted.cross_talk_missing;
  result["settling_responses"] = counted.settling_responses;
  result["rejected_responses"] = counted.rejected_responses;
  result["time_zero_moved"] = counted.time_zero_moved;
  result["truncated_detections"] = counted.truncated_detections;
  return result;
}

}  // namespace

void bind_node_through_wall_pipeline(py::module_& m) {
  using Config = ThroughWallNodeConfig;
  ConfigBinder<Config>(m, "ThroughWallNodeConfig", "A receiver of the pipeline through_wall_2d.")
      .field("node_id", &Config::node_id, ">= 0")
      .field("n_samples", &Config::n_samples, "[sample] of a response")
      .field("kept_samples", &Config::kept_samples,
             "[sample] of it once turned, past blind_zone_s and noise_samples, at most 1920; 0: all")
      .field("sample_rate_hz", &Config::sample_rate_hz, "[Hz] the sequence's clock")
      .field("baseline_m", &Config::baseline_m, "[m] transmitter to receiver")
      .field("delay_offset_s", &Config::delay_offset_s, "[s] calibration, added to every delay")
      .field("blind_zone_s", &Config::blind_zone_s, "[s] after the cross-talk's delay: not reported, >= 0")
      .field("max_delay_s", &Config::max_delay_s, "[s] what begins later is not reported; 0: all is")
      .field("full_scale_count", &Config::full_scale_count, "[count] of a saturated sample; 0: not known")
      .field("saturated_samples", &Config::saturated_samples, "[sample] of a trusted response, >= 0")
      .field("time_zero", &Config::time_zero)
      .field("clutter", &Config::clutter)
      .field("envelope", &Config::envelope)
      .field("weak_signal", &Config::weak_signal)
      .field("gaussian_cfar", &Config::gaussian_cfar)
      .field("target_traces", &Config::target_traces)
      .field("leading_edge", &Config::leading_edge);
  py::class_<ThroughWallNode> node(m, "ThroughWallNode",
                                   "One receiver's responses in, delays of echoes from people out.");
  node.def(py::init<>())
      .def("configure", &ThroughWallNode::configure, py::arg("config"))
      .def("reset", &ThroughWallNode::reset)
      .def("report_ready", &ThroughWallNode::report_ready, "the last process() gave a report")
      .def("ready", &ThroughWallNode::ready, "time zero and background are known")
      .def("counters", &counters, "What happened since configure(), by name.");
  bind_process(node, "response");
  m.attr("THROUGH_WALL_NODE_BYTES") = sizeof(ThroughWallNode);
}

}  // namespace echofuse::bindings
