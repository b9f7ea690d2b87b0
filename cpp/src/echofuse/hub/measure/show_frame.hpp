#pragma once

#include "echofuse/core/tap.hpp"
#include "echofuse/hub/measure/frame.hpp"

namespace echofuse::hub {

/// The tap kFrame. room: at least three values a detection.
inline void show_frame(const TapSink& sink, const Frame& frame, Span<float> room) {
  if (!sink.wants(TapId::kFrame)) return;
  std::size_t n = 0;
  for (const FrameDetection& d : frame.detections)
    for (const float value : {static_cast<float>(d.node_index), d.path_m, d.weight}) room[n++] = value;
  sink(TapId::kFrame, room.first(n));
}

}  // namespace echofuse::hub
