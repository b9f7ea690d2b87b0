/// A hub: the nodes' reports in, tracks out. The same source for every pipeline (hub_pipelines.hpp) and on every board.

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "board.hpp"
#include "hub_pipelines.hpp"
#include "machine.hpp"

#ifdef ECHOFUSE_SITE_CONFIG
#define ECHOFUSE_FIRMWARE_HUB
#include ECHOFUSE_SITE_CONFIG  // made by `echofuse export-config`
#endif

namespace echofuse::firmware {
namespace {

constexpr link::RegisterField kCommandRegisters[] = {
    ECHOFUSE_REGISTER_AS(Commands, apply, "echofuse.apply"),
    ECHOFUSE_REGISTER_AS(Commands, taps, "echofuse.taps"),
};

constexpr std::size_t kFrameBytes = link::kFrameHeaderBytes + link::kFrameCrcBytes + kMaxPayloadBytes;
constexpr std::int64_t kSynchronizationPeriod_us = 1000000;

template <class Pipeline>
class HubFirmware {
 public:
  static constexpr link::MachineKind kKind = Pipeline::kKind;

  Machine& machine() { return machine_; }

  void start() {
#ifdef ECHOFUSE_SITE_CONFIG  // of another pipeline: this image has to be told over the link
    if constexpr (std::is_same_v<decltype(site::hub_config()), typename Pipeline::Config>)
      staged_ = site::hub_config();
#endif
    machine_.add_registers(Pipeline::registers(), &staged_);
    machine_.add_registers(kCommandRegisters, &machine_.commands);
  }

  bool configure() { return hub_.configure(staged_) == Status::kOk; }

  /// Frames that are overdue close before what has just come is looked at.
  void before_link(std::int64_t now_us) { close_frames(now_us); }

  void take_message(std::int64_t now_us) {
    if (!machine_.applied || machine_.endpoint.header().port_id != machine_.endpoint.ports().detections)
      return;
    if (link::decode(machine_.endpoint.header(), machine_.endpoint.payload(), report_) != Status::kOk) {
      ++undecodable_;
      return;
    }
    (void)hub_.receive(report_, now_us);  // what it does not take it counts
    close_frames(now_us);
  }

  void after_link(std::int64_t now_us) { synchronize(now_us); }

  bool healthy() const { return hub_.counters().reports.malformed == 0; }

  auto counters() const { return Pipeline::counted(hub_.counters(), undecodable_); }

 private:
  void close_frames(std::int64_t now_us) {
    for (bool closed = machine_.applied; closed;) {
      hub_.set_tap_sink(machine_.profiler.sink(machine_.commands));
      machine_.profiler.begin();
      (void)hub_.poll(now_us, tracks_, closed);  // kTruncated: what was cut it counts
      if (!closed) return;
      machine_.profiler.end();
      report();
    }
  }

  void report() {
    link::Endpoint& endpoint = machine_.endpoint;
    if constexpr (Pipeline::kSpatial)
      endpoint.publish(endpoint.ports().spatial_tracks, tracks_.frame,
                       link::encode_spatial(tracks_, endpoint.payload_buffer()));
    else
      endpoint.publish(endpoint.ports().tracks, tracks_.frame,
                       link::encode(tracks_, endpoint.payload_buffer()));
  }

  /// The hub is the master of time: each message tells when the one before was sent.
  void synchronize(std::int64_t now_us) {
    if (synchronizations_ > 0 && now_us < synchronized_us_ + kSynchronizationPeriod_us) return;
    const auto previous =
        synchronizations_ == 0 ? std::uint64_t{0} : static_cast<std::uint64_t>(synchronized_us_);
    synchronized_us_ = now_us;
    machine_.endpoint.publish(link::kTimeSubject, synchronizations_++,
                              link::encode_synchronization(previous, machine_.endpoint.payload_buffer()));
  }

  std::array<std::uint8_t, kFrameBytes> frame_{};
  Machine machine_{frame_, Pipeline::kName};
  typename Pipeline::Config staged_;
  typename Pipeline::Hub hub_;
  link::Detections report_;
  link::Tracks tracks_;
  std::int64_t synchronized_us_ = 0;
  std::uint64_t synchronizations_ = 0;
  std::uint32_t undecodable_ = 0;
};

HubFirmware<hub_pipelines::ECHOFUSE_PIPELINE> firmware;

}  // namespace
}  // namespace echofuse::firmware

int main(int argc, char** argv) { echofuse::firmware::run(echofuse::firmware::firmware, argc, argv); }
