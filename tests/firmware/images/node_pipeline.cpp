#include <cstring>

#include "board.hpp"
#include "echofuse/node/node.hpp"
#include "lockstep.hpp"
#include "profile.hpp"

/// A node without its link. The front-end brings first its settings (baseline_m, delay_offset_s), then scans: of the empty
/// room while their time is negative. Steps that want taps get the stages' marks, the others the total alone.

using namespace echofuse;

namespace {

node::SensorRadarNode pipeline;
Profile profile;
link::Detections report;
float samples[kMaxSamplesPerScan];

void configure() {
  node::SensorRadarNodeConfig config;
  config.node_id = board::node_id();
  config.baseline_m = samples[0];
  config.delay_offset_s = samples[1];
  config.clutter.method = node::ClutterMethod::kEmptyRoomScan;
  if (pipeline.configure(config) != Status::kOk)
    board::fault(invalid_field(config), "node_pipeline.cpp", __LINE__);
}

void process(Span<const float> scan, std::int64_t time_us) {
  pipeline.set_tap_sink(board::taps_wanted() ? profile.sink() : TapSink());
  profile.begin();
  const Status status = pipeline.process(scan, time_us, report);
  profile.end();
  if (status != Status::kOk) board::fault("process", "node_pipeline.cpp", __LINE__);
  profile.send();
  std::uint8_t rows[kMaxDetectionsPerNode * sizeof(link::Detection)];
  std::size_t size = 0;
  for (const link::Detection& detection : report.detections) {
    std::memcpy(rows + size, &detection, sizeof detection);
    size += sizeof detection;
  }
  (void)board::trace(board::kTraceTap, static_cast<std::uint8_t>(TapId::kDetections), {rows, size});
}

}  // namespace

int main(int argc, char** argv) {
  board::start(argc, argv);
  bool configured = false;
  for (;;) {
    board::wait();
    std::int64_t time_us = 0;
    const std::size_t count = board::read_scan(samples, time_us);
    if (count == 0) continue;
    if (!configured) {
      configure();
      configured = true;
    } else if (time_us < 0) {
      if (pipeline.set_empty_room({samples, count}) != Status::kOk)
        board::fault("empty room", "node_pipeline.cpp", __LINE__);
    } else {
      process({samples, count}, time_us);
    }
  }
}
