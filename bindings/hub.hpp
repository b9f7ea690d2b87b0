#pragma once

#include "common.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::bindings {

void bind_hub_array(py::module_& m);
void bind_hub_line(py::module_& m);
void bind_hub_pipeline(py::module_& m);
void bind_hub_through_wall(py::module_& m);
void bind_hub_through_wall_3d(py::module_& m);

/// ValueError when the arrays differ or hold more than one report can.
inline void fill_detections(link::Detections& report, const FloatArray& delay, const FloatArray& weight) {
  const auto delays = as_span(delay, "delay_s");
  const auto weights = as_span(weight, "weight");
  if (delays.size() != weights.size()) throw py::value_error("delay_s and weight must have the same length");
  for (std::size_t i = 0; i < delays.size(); ++i)
    if (!report.detections.try_push_back({delays[i], weights[i]}))
      throw py::value_error("a report carries at most " + std::to_string(kMaxDetectionsPerNode) +
                            " detections");
}

/// One node's report, as it comes over the link, to whatever receives reports. time_us: 0 when it is not known.
template <class Receiver>
Status receive_report(Receiver& self, std::int32_t node_id, std::uint32_t frame, const FloatArray& delay,
                      const FloatArray& weight, std::int64_t now_us, std::int64_t time_us) {
  link::Detections report;
  report.node_id = node_id;
  report.frame = frame;
  report.time_us = time_us;
  fill_detections(report, delay, weight);
  return self.receive(report, now_us);
}

}  // namespace echofuse::bindings
