#include "echofuse/node/pipeline.hpp"

#include <cstddef>

#include "echofuse/core/limits.hpp"

namespace echofuse::node {

void begin_report(std::int32_t node_id, std::uint32_t frame, std::int64_t time_us, link::Detections& report) {
  report.detections.clear();
  report.node_id = node_id;
  report.frame = frame;
  report.time_us = time_us;
}

void tap_report(const TapSink& taps, const link::Detections& report) {
  if (!taps.wants(TapId::kDetections)) return;
  float rows[2 * kMaxDetectionsPerNode];
  std::size_t size = 0;
  for (const link::Detection& detection : report.detections) {
    rows[size++] = detection.delay_s;
    rows[size++] = detection.weight;
  }
  taps(TapId::kDetections, {rows, size});
}

}  // namespace echofuse::node
