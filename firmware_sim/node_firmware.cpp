/// A node: a raw scan in, a report out. The same source for every pipeline (node_pipelines.hpp) and on every board.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "board.hpp"
#include "machine.hpp"
#include "node_pipelines.hpp"

#ifdef ECHOFUSE_SITE_CONFIG
#include ECHOFUSE_SITE_CONFIG  // made by `echofuse export-config`
#endif

namespace echofuse::firmware {
namespace {

constexpr link::RegisterField kCommandRegisters[] = {
    ECHOFUSE_REGISTER_AS(Commands, apply, "echofuse.apply"),
    ECHOFUSE_REGISTER_AS(Commands, taps, "echofuse.taps"),
};
constexpr link::RegisterField kEmptyRoomRegisters[] = {
    ECHOFUSE_REGISTER_AS(Commands, empty_room_scans_left, "echofuse.empty_room_scans_left"),
};

template <class Pipeline>
class NodeFirmware {
 public:
  static constexpr link::MachineKind kKind = Pipeline::kKind;

  Machine& machine() { return machine_; }

  void start() {
#ifdef ECHOFUSE_SITE_CONFIG  // of another pipeline: this image has to be told over the link
    if constexpr (std::is_invocable_v<decltype(site::node_config), std::uint16_t, typename Pipeline::Config&>)
      (void)site::node_config(board::node_id(), staged_);
#endif
    machine_.add_registers(Pipeline::registers(), &staged_);
    machine_.add_registers(kCommandRegisters, &machine_.commands);
    if constexpr (Pipeline::kTakesEmptyRoom) machine_.add_registers(kEmptyRoomRegisters, &machine_.commands);
  }

  bool configure() {
    staged_.node_id = board::node_id();
    return node_.configure(staged_) == Status::kOk;
  }

  void before_link(std::int64_t /*now_us*/) {}

  void take_message(std::int64_t now_us) {
    const link::TransferHeader& header = machine_.endpoint.header();
    if (header.port_id == link::kTimeSubject) take_time(now_us);
    if (header.port_id != machine_.endpoint.ports().raw_scan || header.destination != link::kBroadcast)
      return;
    std::int64_t time_us = 0;
    std::size_t n_samples = 0;
    if (link::decode_raw_scan(machine_.endpoint.payload(), time_us, scan_, n_samples) == Status::kOk)
      take_scan(n_samples, time_us);
  }

  void after_link(std::int64_t /*now_us*/) {
    std::int64_t scan_time_us = 0;
    const std::size_t n_samples = board::read_scan(scan_, scan_time_us);
    if (n_samples > 0) take_scan(n_samples, scan_time_us);
  }

  bool healthy() const { return Pipeline::healthy(node_); }

  auto counters() const { return Pipeline::counted(node_); }

 private:
  /// The hub's clock minus this one, by the message before, whose sending this one tells.
  void take_time(std::int64_t now_us) {
    std::uint64_t previous_us = 0;
    if (link::decode_synchronization(machine_.endpoint.payload(), previous_us) != Status::kOk) return;
    if (previous_us != 0 && synchronization_us_ != 0)
      hub_clock_ahead_us_ = static_cast<std::int64_t>(previous_us) - synchronization_us_;
    synchronization_us_ = now_us;
  }

  void take_scan(std::size_t n_samples, std::int64_t time_us) {
    const Span<const float> scan{scan_.data(), std::min(n_samples, scan_.size())};
    if constexpr (Pipeline::kTakesEmptyRoom) {
      if (machine_.commands.empty_room_scans_left > 0) {
        --machine_.commands.empty_room_scans_left;
        (void)node_.set_empty_room(scan);  // a scan that it cannot use is counted
        return;
      }
    }
    node_.set_tap_sink(machine_.profiler.sink(machine_.commands));
    machine_.profiler.begin();
    const Status status = node_.process(scan, time_us, report_);
    machine_.profiler.end();
    if (status == Status::kInvalidInput || !node_.report_ready()) return;
    const link::TransferHeader header = link::header_of(report_, machine_.endpoint.ports().detections);
    machine_.endpoint.publish(header.port_id, header.transfer_id,
                              link::encode(report_, machine_.endpoint.payload_buffer()));
  }

  /// The longest frame that a node reads is a raw scan, if its radar is on the link; their samples share the memory that a
  /// front-end fills otherwise.
  static constexpr std::size_t kFrameBytes =
      link::kFrameHeaderBytes + link::kFrameCrcBytes + 9 + 4 * Pipeline::kScanSamples;

  std::array<std::uint8_t, kFrameBytes> frame_{};
  std::array<float, Pipeline::kScanSamples> scan_{};
  Machine machine_{frame_, Pipeline::kName};
  typename Pipeline::Config staged_;
  typename Pipeline::Node node_;
  link::Detections report_;
  std::int64_t synchronization_us_ = 0;
  std::int64_t hub_clock_ahead_us_ = 0;
};

NodeFirmware<node_pipelines::ECHOFUSE_PIPELINE> firmware;

}  // namespace
}  // namespace echofuse::firmware

int main(int argc, char** argv) { echofuse::firmware::run(echofuse::firmware::firmware, argc, argv); }
