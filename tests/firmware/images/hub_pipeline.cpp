#include <cstring>

#include "board.hpp"
#include "echofuse/hub/hub.hpp"
#include "lockstep.hpp"
#include "profile.hpp"

/// A hub without its link. The front-end brings, as floats, first its site (area, tracker, body radius, then id, tx and rx of each
/// node) and then each frame's reports (node id, number of the frame, number of detections, delay and weight of each).
/// Steps that want taps get the stages' marks, the others the total alone.

using namespace echofuse;

namespace {

constexpr std::size_t kMaxValues = kMaxNodes * (3 + 2 * kMaxDetectionsPerNode);

hub::SensorRadarHub pipeline;
hub::SensorRadarHubConfig config;
Profile profile;
link::Detections report;
link::Tracks tracks;
float values[kMaxValues];

void configure(std::size_t count) {
  const float* value = values;
  config.area = {value[0], value[1], value[2], value[3]};
  config.phd.area_m2 = (value[2] - value[0]) * (value[3] - value[1]);
  config.tracker = static_cast<hub::Tracker>(static_cast<int>(value[4]));
  config.ellipse.body_radius_m = value[5];
  for (value += 6; value < values + count; value += 5) {
    hub::NodeSite& node = config.nodes[static_cast<std::size_t>(config.n_nodes++)];
    node = {static_cast<std::int32_t>(value[0]), {value[1], value[2]}, {value[3], value[4]}};
  }
  if (pipeline.configure(config) != Status::kOk)
    board::fault(invalid_field(config), "hub_pipeline.cpp", __LINE__);
}

void receive(std::size_t count, std::int64_t time_us) {
  for (const float* value = values; value < values + count;) {
    report.node_id = static_cast<std::int32_t>(*value++);
    report.frame = static_cast<std::uint32_t>(*value++);
    report.time_us = time_us;
    report.detections.clear();
    for (auto left = static_cast<int>(*value++); left > 0; --left, value += 2)
      (void)report.detections.try_push_back({value[0], value[1]});
    if (pipeline.receive(report, time_us) != Status::kOk)
      board::fault("receive", "hub_pipeline.cpp", __LINE__);
  }
}

void process(std::int64_t time_us) {
  pipeline.set_tap_sink(board::taps_wanted() ? profile.sink() : TapSink());
  bool closed = false;
  profile.begin();
  (void)pipeline.poll(time_us, tracks, closed);  // kTruncated is what the worst case is about
  profile.end();
  if (!closed) board::fault("frame still open", "hub_pipeline.cpp", __LINE__);
  profile.send();
  (void)board::trace(board::kTraceTap, static_cast<std::uint8_t>(TapId::kTracks),
                     {reinterpret_cast<const std::uint8_t*>(tracks.tracks.begin()),
                      tracks.tracks.size() * sizeof(link::Track)});
}

}  // namespace

int main(int argc, char** argv) {
  board::start(argc, argv);
  bool configured = false;
  for (;;) {
    board::wait();
    std::int64_t time_us = 0;
    const std::size_t count = board::read_scan(values, time_us);
    if (count == 0) continue;
    if (!configured) {
      configure(count);
      configured = true;
    } else {
      receive(count, time_us);
      process(time_us);
    }
  }
}
