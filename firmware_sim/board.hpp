#pragma once

#include <cstddef>
#include <cstdint>

#include "echofuse/core/span.hpp"

/// The whole hardware contract: what a board gives to the super-loops of node_firmware.cpp and hub_firmware.cpp.
/// One board is linked into an image; docs/porting.md brings one to a new chip.
namespace echofuse::board {

/// Before anything else: clocks, ports and timers. argc and argv are a hosted board's, 0 and nullptr elsewhere.
void start(int argc, char** argv);

/// Node id on the link, from straps, a fuse or the command line; in [0, 65534].
std::uint16_t node_id();

/// Sleeps until there may be something to do: a scan, bytes, or a tick at least ten times a second. An emulated
/// board waits here for the emulation's next step, so everything else happens at the virtual time of that step.
void wait();

/// [us] this board's own clock, from any zero, never decreasing.
std::int64_t now_us();

/// The radar's next raw scan [count], if one is complete: its length, also where `samples` is too short to hold
/// all of it (the rest is dropped), and time_us, when it was taken, on this board's clock. 0: no scan is ready.
std::size_t read_scan(Span<float> samples, std::int64_t& time_us);

/// Bytes that the link has brought, in order: how many were put into `bytes`. 0: none is waiting.
std::size_t receive(Span<std::uint8_t> bytes);

/// Puts bytes on the link, in order, all of them.
void send(Span<const std::uint8_t> bytes);

/// Free-running, wraps: instructions on an emulated board, cycles on a real one.
std::uint32_t ticks();

/// Deepest use of the stack so far [byte], by painting; 0 where the board cannot tell.
std::size_t stack_used_bytes();

/// Somebody listens to the taps of what is done until the next wait().
bool taps_wanted();

/// What a tap or a profile shows, to the board's debug port; false when it has none, so that the link must carry it.
/// kind and id: lockstep.hpp.
bool trace(std::uint8_t kind, std::uint8_t id, Span<const std::uint8_t> bytes);

/// A broken promise: makes it known if it can, and stops or restarts. ECHOFUSE_CHECK ends here.
[[noreturn]] void fault(const char* what, const char* file, int line);

}  // namespace echofuse::board
