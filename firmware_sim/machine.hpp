#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "board.hpp"
#include "echofuse/core/check.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/link/codec.hpp"
#include "echofuse/link/endpoint.hpp"
#include "lockstep.hpp"

/// What node and hub share: the super-loop, with the link's bytes in and out, and taps and the profile of the stages.
namespace echofuse::firmware {

/// Registers of the loop itself: `apply` = true puts the staged configuration in force, and reads back as whether it is.
struct Commands {
  bool apply = false;
  bool taps = false;                        ///< send what each stage shows, where there is no debug port
  std::uint16_t empty_room_scans_left = 0;  ///< the next scans are of the empty room (nodes)
};

/// Times a pipeline's stages by their marks, or shows its taps: to the board's debug port, and where that is missing
/// as messages.
class Profiler {
 public:
  explicit Profiler(link::Endpoint& endpoint) : endpoint_(endpoint) {}

  /// The sink for a pipeline's next call.
  TapSink sink(const Commands& commands) {
    n_marks_ = 0;
    return board::taps_wanted() || commands.taps ? TapSink(&show, this) : TapSink::marks(&mark, this);
  }

  void begin() { began_ = last_ = board::ticks(); }

  /// Tells what the stages took, and all together. [tick]
  void end() {
    const std::uint32_t total = board::ticks() - began_;
    for (std::size_t i = 0; i < n_marks_; ++i)
      tell(board::kTraceProfile, static_cast<std::uint8_t>(marks_[i].tap), marks_[i].ticks);
    tell(board::kTraceProfile, board::kProfileTotal, total);
    tell(board::kTraceStack, 0, static_cast<std::uint32_t>(board::stack_used_bytes()));
    if (total > most_ticks_) most_ticks_ = total;
    ++scans_;
  }

  std::uint32_t most_ticks() const { return most_ticks_; }

 private:
  struct Mark {
    TapId tap;
    std::uint32_t ticks;
  };

  static void mark(void* context, TapId tap, Span<const float> /*values*/) {
    auto& self = *static_cast<Profiler*>(context);
    const std::uint32_t now = board::ticks();
    if (self.n_marks_ < self.marks_.size()) self.marks_[self.n_marks_++] = {tap, now - self.last_};
    self.last_ = now;
  }

  static void show(void* context, TapId tap, Span<const float> values) {
    auto& self = *static_cast<Profiler*>(context);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    if (board::trace(board::kTraceTap, static_cast<std::uint8_t>(tap),
                     {bytes, sizeof(float) * values.size()}))
      return;
    for (std::size_t at = 0; at == 0 || at < values.size(); at += link::kTapValues) {
      const std::size_t size =
          link::encode_tap(tap, self.scans_, values, at, self.endpoint_.payload_buffer());
      self.endpoint_.publish(self.endpoint_.ports().tap, self.tap_messages_++, size);
    }
  }

  static void tell(std::uint8_t kind, std::uint8_t id, std::uint32_t value) {
    std::array<std::uint8_t, sizeof value> bytes;
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
    (void)board::trace(kind, id, bytes);
  }

  link::Endpoint& endpoint_;
  std::array<Mark, 16> marks_{};
  std::size_t n_marks_ = 0;
  std::uint32_t began_ = 0;
  std::uint32_t last_ = 0;
  std::uint32_t most_ticks_ = 0;
  std::uint32_t scans_ = 0;
  std::uint64_t tap_messages_ = 0;
};

/// What a firmware has beside its pipeline.
struct Machine {
  Machine(Span<std::uint8_t> frame_buffer, const char* name)
      : endpoint(frame_buffer, &board::send, name), profiler(endpoint) {}

  void add_registers(Span<const link::RegisterField> fields, void* structure) {
    ECHOFUSE_CHECK(endpoint.registers().add({fields, structure}));
  }

  link::Endpoint endpoint;
  Profiler profiler;
  Commands commands;
  bool applied = false;  ///< the staged configuration is in force
  std::uint64_t health_messages = 0;
};

/// Tells what a firmware has counted, then the link and the stack, in the order of docs/link_protocol.md. Not inlined: its
/// quarter of a kilobyte would lie on the stack under every scan.
template <class Firmware>
[[gnu::noinline]] void send_health(const Firmware& firmware, Machine& machine) {
  link::NodeHealth health;
  health.kind = Firmware::kKind;
  for (const std::uint32_t value : firmware.counters()) (void)health.values.try_push_back(value);
  link::Endpoint& endpoint = machine.endpoint;
  const link::FrameCounters& link = endpoint.received();
  for (const std::uint32_t value :
       {machine.profiler.most_ticks(), link.frames, link.bad_cobs, link.bad_length, link.bad_version,
        link.bad_header_crc, link.bad_payload_crc, link.multi_frame, link.repeated, endpoint.unsent(),
        endpoint.registers().refused_writes(), static_cast<std::uint32_t>(board::stack_used_bytes())})
    (void)health.values.try_push_back(value);
  endpoint.publish(endpoint.ports().node_health, machine.health_messages++,
                   link::encode(health, endpoint.payload_buffer()));
}

/// The super-loop. A firmware has:
///
///   machine()                            its Machine
///   start()                              stages the configuration that is compiled in, adds its registers
///   configure()                          puts what is staged in force; false: the earlier one stays there
///   before_link(now_us)                  each turn, before what has just come is looked at
///   take_message(now_us)                 each message, in machine().endpoint
///   after_link(now_us)                   each turn
///   healthy(), kKind, counters()         for heartbeat and NodeHealth
template <class Firmware>
[[noreturn]] void run(Firmware& firmware, int argc, char** argv) {
  board::start(argc, argv);
  Machine& machine = firmware.machine();
  machine.endpoint.start(board::node_id(), board::now_us());
  firmware.start();
  const auto apply = [&] { machine.commands.apply = machine.applied = firmware.configure(); };
  apply();
  for (;;) {
    board::wait();
    const std::int64_t now_us = board::now_us();
    firmware.before_link(now_us);
    std::array<std::uint8_t, 64> bytes;
    for (std::size_t count = board::receive(bytes); count > 0; count = board::receive(bytes))
      for (std::size_t i = 0; i < count; ++i)
        if (machine.endpoint.push(bytes[i], now_us)) firmware.take_message(now_us);
    if (machine.commands.apply != machine.applied) apply();
    firmware.after_link(now_us);
    if (machine.endpoint.heartbeat(now_us,
                                   firmware.healthy() ? link::Health::kNominal : link::Health::kAdvisory,
                                   machine.applied ? link::Mode::kOperational : link::Mode::kInitialization))
      send_health(firmware, machine);
  }
}

}  // namespace echofuse::firmware
