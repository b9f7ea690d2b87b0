/// A node: raw scans in, Cyphal/serial frames out. Heartbeat and services are the endpoint's, the site is the one that
/// `echofuse export-config` wrote. posix.cpp and cortex_m7.cpp bring it to a machine.

#include <array>
#include <cstdint>

#include "board.hpp"
#include "echofuse/core/check.hpp"
#include "echofuse/link/codec.hpp"
#include "echofuse/link/endpoint.hpp"
#include "echofuse/node/node.hpp"
#include "site_config.hpp"

using namespace echofuse;

namespace {

// Static: they are too large for most stacks, and the linker tells what they take.
std::array<std::uint8_t, link::kFrameHeaderBytes + link::kFrameCrcBytes + kMaxPayloadBytes> frame_buffer;
link::Endpoint endpoint(frame_buffer, &board::send, "my_company.my_node");
node::SensorRadarNode pipeline;
node::SensorRadarNodeConfig config;
std::array<float, kMaxSamplesPerScan> samples;
link::Detections report;

}  // namespace

int main() {
  ECHOFUSE_CHECK(site::node_config(NODE_ID, config));
  ECHOFUSE_CHECK(pipeline.configure(config) == Status::kOk);
  endpoint.start(NODE_ID, 0);

  const Span<float> scan(samples.data(), static_cast<std::size_t>(config.n_samples));
  for (std::int64_t time_us = 0; board::read_scan(scan, time_us);) {
    if (time_us < 0) {
      ECHOFUSE_CHECK(pipeline.set_empty_room(scan) == Status::kOk);
      continue;
    }
    const Status status = pipeline.process(scan, time_us, report);
    if (status != Status::kInvalidInput && pipeline.report_ready()) {
      const link::TransferHeader header = link::header_of(report, endpoint.ports().detections);
      endpoint.publish(header.port_id, header.transfer_id, link::encode(report, endpoint.payload_buffer()));
    }
    const bool healthy = pipeline.counters().rejected_scans == 0;
    endpoint.heartbeat(time_us, healthy ? link::Health::kNominal : link::Health::kAdvisory,
                       link::Mode::kOperational);
  }
  return 0;
}
