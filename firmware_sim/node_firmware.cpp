/// A node of the pipeline sensor_radar: a raw scan in, a report out. The same source on every board.

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "board.hpp"
#include "echofuse/node/node.hpp"
#include "echofuse/node/registers.hpp"
#include "machine.hpp"

#ifdef ECHOFUSE_SITE_CONFIG
#include ECHOFUSE_SITE_CONFIG  // made by `echofuse export-config`
#endif

namespace echofuse::firmware {
namespace {

constexpr link::RegisterField kCommandRegisters[] = {
    ECHOFUSE_REGISTER_AS(Commands, apply, "echofuse.apply"),
    ECHOFUSE_REGISTER_AS(Commands, taps, "echofuse.taps"),
    ECHOFUSE_REGISTER_AS(Commands, empty_room_scans_left, "echofuse.empty_room_scans_left"),
};

/// The longest frame that a node reads is a raw scan, if its radar is on the link; their samples share the memory that a
/// front-end fills otherwise.
constexpr std::size_t kFrameBytes =
    link::kFrameHeaderBytes + link::kFrameCrcBytes + 9 + 4 * kMaxSamplesPerScan;

class NodeFirmware {
 public:
  NodeFirmware() : endpoint_(frame_, &board::send, "echofuse.sensor_radar.node"), profiler_(endpoint_) {}

  void start() {
    endpoint_.start(board::node_id(), board::now_us());
#ifdef ECHOFUSE_SITE_CONFIG
    (void)site::node_config(board::node_id(), staged_);
#endif
    ECHOFUSE_CHECK(endpoint_.registers().add({node::config_registers(), &staged_}));
    ECHOFUSE_CHECK(endpoint_.registers().add({kCommandRegisters, &commands_}));
    apply();
  }

  void turn() {
    const std::int64_t now_us = board::now_us();
    take_link(endpoint_, now_us, [this](std::int64_t now) { take_message(now); });
    if (commands_.apply != applied_) apply();
    std::int64_t scan_time_us = 0;
    const std::size_t n_samples = board::read_scan(scan_, scan_time_us);
    if (n_samples > 0) take_scan(n_samples, scan_time_us);
    if (endpoint_.heartbeat(now_us, health(),
                            applied_ ? link::Mode::kOperational : link::Mode::kInitialization))
      send_health();
  }

 private:
  /// Puts the staged configuration in force if it is possible; the earlier one stays otherwise.
  void apply() {
    staged_.node_id = board::node_id();
    applied_ = node_.configure(staged_) == Status::kOk;
    commands_.apply = applied_;
  }

  void take_message(std::int64_t now_us) {
    const link::TransferHeader& header = endpoint_.header();
    if (header.port_id == link::kTimeSubject) take_time(now_us);
    if (header.port_id != endpoint_.ports().raw_scan || header.destination != link::kBroadcast) return;
    std::int64_t time_us = 0;
    std::size_t n_samples = 0;
    if (link::decode_raw_scan(endpoint_.payload(), time_us, scan_, n_samples) == Status::kOk)
      take_scan(n_samples, time_us);
  }

  /// The hub's clock minus this one, by the message before, whose sending this one tells.
  void take_time(std::int64_t now_us) {
    std::uint64_t previous_us = 0;
    if (link::decode_synchronization(endpoint_.payload(), previous_us) != Status::kOk) return;
    if (previous_us != 0 && synchronization_us_ != 0)
      hub_clock_ahead_us_ = static_cast<std::int64_t>(previous_us) - synchronization_us_;
    synchronization_us_ = now_us;
  }

  void take_scan(std::size_t n_samples, std::int64_t time_us) {
    const Span<const float> scan{scan_.data(), std::min(n_samples, scan_.size())};
    if (commands_.empty_room_scans_left > 0) {
      --commands_.empty_room_scans_left;
      (void)node_.set_empty_room(scan);  // a scan that it cannot use is counted
      return;
    }
    node_.set_tap_sink(profiler_.sink(commands_));
    profiler_.begin();
    const Status status = node_.process(scan, time_us, report_);
    profiler_.end();
    if (status == Status::kInvalidInput || !node_.report_ready()) return;
    const link::TransferHeader header = link::header_of(report_, endpoint_.ports().detections);
    endpoint_.publish(header.port_id, header.transfer_id, link::encode(report_, endpoint_.payload_buffer()));
  }

  link::Health health() const {
    return node_.counters().rejected_scans > 0 ? link::Health::kAdvisory : link::Health::kNominal;
  }

  void send_health() {
    const node::SensorRadarNodeCounters& c = node_.counters();
    link::NodeHealth health;
    health.kind = link::MachineKind::kSensorRadarNode;
    for (const std::uint32_t value :
         {c.scans, c.rejected_scans, c.learning_scans, c.direct_path_missing, c.alignment_doubts,
          c.undetectable_scans, c.truncated_detections, profiler_.most_ticks()})
      add(health, value);
    add_link(health, endpoint_);
    endpoint_.publish(endpoint_.ports().node_health, health_messages_++,
                      link::encode(health, endpoint_.payload_buffer()));
  }

  std::array<std::uint8_t, kFrameBytes> frame_{};
  std::array<float, kMaxSamplesPerScan> scan_{};
  link::Endpoint endpoint_;
  Profiler profiler_;
  node::SensorRadarNodeConfig staged_;
  Commands commands_;
  bool applied_ = false;
  node::SensorRadarNode node_;
  link::Detections report_;
  std::int64_t synchronization_us_ = 0;
  std::int64_t hub_clock_ahead_us_ = 0;
  std::uint64_t health_messages_ = 0;
};

NodeFirmware machine;

}  // namespace
}  // namespace echofuse::firmware

int main(int argc, char** argv) {
  echofuse::board::start(argc, argv);
  echofuse::firmware::machine.start();
  for (;;) {
    echofuse::board::wait();
    echofuse::firmware::machine.turn();
  }
}
