#pragma once

#include <cstdint>

/// How the emulation and an emulated board take turns. Two byte channels beside the link: the front-end (emulation to
/// board) and the trace (board to emulation); named pipes by semihosting on the bare board, a socket on the posix one.
/// All fields little-endian, no padding. Twin: python/echofuse/emulation/lockstep.py
///
///   emulation                                board
///   link bytes of this step      ---------->   (UART or socket)
///   StepHeader + samples         ---------->   wait() returns once link_bytes of the link are in, in all
///                                <----------   TraceHeader + payload: taps and profile, as they come
///                                <----------   (UART or socket) what the firmware sends
///                                <----------   TraceHeader kDone + DonePayload: in wait() again
///
/// The emulation reads the link until DonePayload's count, so nothing depends on the wall clock. It reads link and trace
/// at once: a board whose link nobody drains waits in send() (a Unix socket holds only 278 bytes that come one by one).
namespace echofuse::board {

inline constexpr std::uint32_t kStepMagic = 0x50455453;   ///< "STEP"
inline constexpr std::uint32_t kTraceMagic = 0x43415254;  ///< "TRAC"

struct StepHeader {
  std::uint32_t magic = kStepMagic;
  std::uint32_t sequence = 0;     ///< counts the board's steps from 1; kDone repeats it
  std::int64_t now_us = 0;        ///< the board's clock from here on
  std::int64_t scan_time_us = 0;  ///< of the scan, the board's clock
  std::uint32_t n_samples = 0;    ///< float32 samples that follow; 0: no scan in this step
  std::uint32_t link_bytes = 0;   ///< that the emulation has put on the link since the start, modulo 2^32
  std::uint32_t flags = 0;        ///< kStepStop | kStepTaps
  std::uint32_t reserved = 0;
};
static_assert(sizeof(StepHeader) == 40);

inline constexpr std::uint32_t kStepStop = 1;  ///< power off: the board ends, exit status 0
inline constexpr std::uint32_t kStepTaps = 2;  ///< the firmware shall show its taps of this step by trace()

enum TraceKind : std::uint8_t {
  kTraceDone = 0,     ///< payload DonePayload
  kTraceTap = 1,      ///< id: TapId; payload: float32 values
  kTraceProfile = 2,  ///< id: TapId that ended the stage, or kProfileTotal; payload: uint32 ticks it took
  kTraceFault = 3,    ///< payload: text, the last thing a board says
  kTraceStack = 4,    ///< payload: uint32 deepest use of the stack [byte]
};
inline constexpr std::uint8_t kProfileTotal = 255;

struct TraceHeader {
  std::uint32_t magic = kTraceMagic;
  std::uint32_t sequence = 0;  ///< of the step that is in work, 0 before the first
  std::uint8_t kind = kTraceDone;
  std::uint8_t id = 0;
  std::uint16_t reserved = 0;
  std::uint32_t n_bytes = 0;  ///< of payload that follow
};
static_assert(sizeof(TraceHeader) == 16);

struct DonePayload {
  std::uint32_t link_bytes_sent = 0;      ///< since the start, modulo 2^32
  std::uint32_t link_bytes_received = 0;  ///< as StepHeader::link_bytes
};
static_assert(sizeof(DonePayload) == 8);

}  // namespace echofuse::board
