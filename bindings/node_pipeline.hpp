#pragma once

#include <cstdint>

#include "common.hpp"
#include "echofuse/link/messages.hpp"
#include "taps.hpp"

namespace echofuse::bindings {

/// link::Detection as the rows of a structured array.
struct DetectionRow {
  float delay_s;
  float weight;
};

inline py::array_t<DetectionRow> rows(const link::Detections& report) {
  py::array_t<DetectionRow> array(static_cast<py::ssize_t>(report.detections.size()));
  DetectionRow* row = array.mutable_data();
  for (const link::Detection& detection : report.detections) *row++ = {detection.delay_s, detection.weight};
  return array;
}

/// process and process_with_taps of a node's pipeline.
template <class Node>
void bind_process(py::class_<Node>& node, const char* scan_name) {
  node.def(
          "process",
          [scan_name](Node& self, const FloatArray& scan, std::int64_t time_us) {
            link::Detections report;
            const Status status = self.process(as_span(scan, scan_name), time_us, report);
            return py::make_tuple(status, rows(report));
          },
          py::arg(scan_name).noconvert(), py::arg("time_us"),
          "(status, detections): what comes in (n_samples,) [count]; detections is structured, delay_s and "
          "weight.")
      .def(
          "process_with_taps",
          [scan_name](Node& self, const FloatArray& scan, std::int64_t time_us) {
            link::Detections report;
            py::dict taps;
            const TapGuard guard(self, taps);
            const Status status = self.process(as_span(scan, scan_name), time_us, report);
            return py::make_tuple(status, rows(report), taps);
          },
          py::arg(scan_name).noconvert(), py::arg("time_us"), "(status, detections, taps by name).");
}

}  // namespace echofuse::bindings
