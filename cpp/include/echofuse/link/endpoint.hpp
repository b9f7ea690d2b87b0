#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/link/frame.hpp"
#include "echofuse/link/messages.hpp"
#include "echofuse/link/ports.hpp"
#include "echofuse/link/register_server.hpp"

namespace echofuse::link {

/// One machine's place on the link: its frames in and out, its heartbeat, and the services that every Cyphal node has
/// (GetInfo, register.List and .Access), which it answers by itself.
class Endpoint {
 public:
  using SendFunction = void (*)(Span<const std::uint8_t> bytes);

  /// frame_buffer: FrameReader's. name: for GetInfo, at most 50 characters, outlives the endpoint.
  Endpoint(Span<std::uint8_t> frame_buffer, SendFunction send_bytes, const char* name);

  void start(std::uint16_t node_id, std::int64_t now_us);

  /// True when a message of somebody else is complete: header() and payload() hold until the next call.
  bool push(std::uint8_t byte, std::int64_t now_us);
  const TransferHeader& header() const { return reader_.header(); }
  Span<const std::uint8_t> payload() const { return reader_.payload(); }

  /// Room for a message's payload, for publish(). Whoever fills it publishes it before the next push().
  Span<std::uint8_t> payload_buffer() { return payload_; }

  /// Sends the first `size` bytes of payload_buffer(); a size of 0 (an encoder had no room) is counted as unsent.
  void publish(std::uint16_t subject, std::uint64_t transfer_id, std::size_t size);

  /// Once a second, and with what it says at once when the mode changes. True when one was sent.
  bool heartbeat(std::int64_t now_us, Health health, Mode mode);

  std::uint16_t node_id() const { return identity_.node_id; }
  Ports& ports() { return identity_.ports; }
  RegisterServer& registers() { return registers_; }
  const RegisterServer& registers() const { return registers_; }
  const FrameCounters& received() const { return reader_.counters(); }
  std::uint32_t unsent() const { return unsent_; }

 private:
  struct Identity {  ///< what registers show of it
    std::uint16_t node_id = kBroadcast;
    Ports ports;
    const char* name = "";
  };

  void serve(std::int64_t now_us);
  std::size_t get_info();
  void send(const TransferHeader& header, std::size_t size);

  static const std::array<RegisterField, 11> kRegisters;

  FrameReader reader_;
  SendFunction send_;
  Identity identity_;
  RegisterServer registers_;
  std::int64_t started_us_ = 0;
  std::int64_t next_heartbeat_us_ = 0;
  std::uint64_t heartbeats_ = 0;
  Mode last_mode_ = Mode::kInitialization;
  std::uint32_t unsent_ = 0;
  std::array<std::uint8_t, kMaxPayloadBytes> payload_{};
  std::array<std::uint8_t, frame_bytes(kMaxPayloadBytes)> frame_{};
};

}  // namespace echofuse::link
