/// The hub of the pipeline sensor_radar: the nodes' reports in, tracks out. The same source on every board.

#include <array>
#include <cstddef>
#include <utility>

#include "board.hpp"
#include "echofuse/hub/hub.hpp"
#include "echofuse/hub/registers.hpp"
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

class HubFirmware {
 public:
  HubFirmware() : endpoint_(frame_, &board::send, "echofuse.sensor_radar.hub"), profiler_(endpoint_) {}

  void start() {
    endpoint_.start(board::node_id(), board::now_us());
#ifdef ECHOFUSE_SITE_CONFIG
    staged_ = site::hub_config();
#endif
    ECHOFUSE_CHECK(endpoint_.registers().add({hub::config_registers(), &staged_}));
    ECHOFUSE_CHECK(endpoint_.registers().add({kCommandRegisters, &commands_}));
    apply();
  }

  void turn() {
    const std::int64_t now_us = board::now_us();
    // Frames that are overdue close before what has just come is looked at.
    close_frames(now_us);
    take_link(endpoint_, now_us, [this](std::int64_t now) { take_message(now); });
    if (commands_.apply != applied_) apply();
    synchronize(now_us);
    if (endpoint_.heartbeat(now_us, health(),
                            applied_ ? link::Mode::kOperational : link::Mode::kInitialization))
      send_health();
  }

 private:
  /// Puts the staged configuration in force if it is possible; the earlier one stays otherwise.
  void apply() {
    applied_ = hub_.configure(staged_) == Status::kOk;
    commands_.apply = applied_;
  }

  void take_message(std::int64_t now_us) {
    if (!applied_ || endpoint_.header().port_id != endpoint_.ports().detections) return;
    if (link::decode(endpoint_.header(), endpoint_.payload(), report_) != Status::kOk) {
      ++undecodable_;
      return;
    }
    (void)hub_.receive(report_, now_us);  // what it does not take it counts
    close_frames(now_us);
  }

  void close_frames(std::int64_t now_us) {
    for (bool closed = applied_; closed;) {
      hub_.set_tap_sink(profiler_.sink(commands_));
      profiler_.begin();
      (void)hub_.poll(now_us, tracks_, closed);  // kTruncated: what was cut it counts
      if (!closed) return;
      profiler_.end();
      endpoint_.publish(endpoint_.ports().tracks, tracks_.frame,
                        link::encode(tracks_, endpoint_.payload_buffer()));
    }
  }

  /// The hub is the master of time: each message tells when the one before was sent.
  void synchronize(std::int64_t now_us) {
    if (synchronizations_ > 0 && now_us < synchronized_us_ + kSynchronizationPeriod_us) return;
    const auto previous =
        synchronizations_ == 0 ? std::uint64_t{0} : static_cast<std::uint64_t>(synchronized_us_);
    synchronized_us_ = now_us;
    endpoint_.publish(link::kTimeSubject, synchronizations_++,
                      link::encode_synchronization(previous, endpoint_.payload_buffer()));
  }

  link::Health health() const {
    return hub_.counters().reports.malformed > 0 ? link::Health::kAdvisory : link::Health::kNominal;
  }

  void send_health() {
    const hub::SensorRadarHubCounters c = hub_.counters();
    link::NodeHealth health;
    health.kind = link::MachineKind::kSensorRadarHub;
    for (const std::uint32_t value : {c.reports.accepted,
                                      c.reports.late,
                                      c.reports.early,
                                      c.reports.doubled,
                                      c.reports.malformed,
                                      c.reports.unknown_node,
                                      c.reports.lost,
                                      c.reports.resynchronised,
                                      c.reports.frames,
                                      c.reports.absent,
                                      c.reports.slow,
                                      static_cast<std::uint32_t>(c.selection.tuples),
                                      static_cast<std::uint32_t>(c.selection.dropped_tuples),
                                      static_cast<std::uint32_t>(c.selection.dropped_detections),
                                      static_cast<std::uint32_t>(c.selection.dropped_measurements),
                                      static_cast<std::uint32_t>(c.dropped_points),
                                      c.dropped_births,
                                      c.clock_faults,
                                      undecodable_,
                                      profiler_.most_ticks()})
      add(health, value);
    add_link(health, endpoint_);
    endpoint_.publish(endpoint_.ports().node_health, health_messages_++,
                      link::encode(health, endpoint_.payload_buffer()));
  }

  std::array<std::uint8_t, kFrameBytes> frame_{};
  link::Endpoint endpoint_;
  Profiler profiler_;
  hub::SensorRadarHubConfig staged_;
  Commands commands_;
  bool applied_ = false;
  hub::SensorRadarHub hub_;
  link::Detections report_;
  link::Tracks tracks_;
  std::int64_t synchronized_us_ = 0;
  std::uint64_t synchronizations_ = 0;
  std::uint64_t health_messages_ = 0;
  std::uint32_t undecodable_ = 0;
};

HubFirmware machine;

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
