#include "board.hpp"

#include <algorithm>
#include <cstring>

#include "echofuse/core/ring_buffer.hpp"
#include "lockstep.hpp"
#include "semihosting.hpp"

/// A bare Cortex-M7 (or M4) of Arm's MPS2 board in QEMU, stepped by the emulation (lockstep.hpp). What is behind -append:
///
///   --node-id N [--front-end PIPE --trace PIPE]
///
/// The link is UART 0. Without pipes the board has no radar, its clock is its timer, and nobody gives it turns.
namespace echofuse::board {
namespace {

using semihosting::File;

constexpr std::size_t kReceiveBytes = 512;       ///< kept of the link until the firmware takes them
constexpr std::size_t kCommandLineBytes = 1024;  ///< three paths and the words between them
constexpr std::uint32_t kInstructionsPerTimerTick =
    40;  ///< 25 MHz, one instruction a nanosecond (-icount shift=0)

struct Uart {
  volatile std::uint32_t data;
  volatile std::uint32_t state;
  volatile std::uint32_t control;
  volatile std::uint32_t interrupt;
  volatile std::uint32_t baud_divider;
};
constexpr std::uint32_t kUartSendFull = 1;
constexpr std::uint32_t kUartReceiveFull = 2;
constexpr std::uint32_t kUartEnable = 3;  // sender and receiver

struct Timer {
  volatile std::uint32_t control;
  volatile std::uint32_t value;
  volatile std::uint32_t reload;
};
constexpr std::uint32_t kTimerEnable = 1;
constexpr std::uint32_t kTimerStart = 0xffffffff;

Uart& uart() { return *reinterpret_cast<Uart*>(0x40004000); }     // CMSDK UART 0
Timer& timer() { return *reinterpret_cast<Timer*>(0x40000000); }  // CMSDK timer 0, counts down

struct State {
  std::uint16_t node_id = 0;
  File front_end;
  File trace;
  StepHeader step;
  std::size_t samples_left = 0;  ///< of the step's scan, still in the pipe
  bool step_open = false;        ///< given to the firmware, not all of its link bytes yet
  DonePayload counted;
  RingBuffer<std::uint8_t, kReceiveBytes> received;
  char command_line[kCommandLineBytes] = {};
};

State only_state;
State& state() { return only_state; }

/// The value of an option of the command line, ended by 0; nullptr if it is not there. Cuts the line up.
const char* option(const char* name, char* line, char* end) {
  const std::size_t length = std::strlen(name);
  for (char* at = line; at < end; ++at) {
    const bool begins = at == line || at[-1] == ' ' || at[-1] == '\0';
    if (!begins || std::strncmp(at, name, length) != 0 || at[length] != ' ') continue;
    char* value = at + length + 1;
    *std::find(value, end, ' ') = '\0';
    return value;
  }
  return nullptr;
}

void read_options() {
  State& s = state();
  if (!semihosting::command_line(s.command_line, kCommandLineBytes))
    fault("command line too long", __FILE__, __LINE__);
  char* const end = s.command_line + std::strlen(s.command_line);
  if (const char* id = option("--node-id", s.command_line, end); id != nullptr)
    for (; *id >= '0' && *id <= '9'; ++id)
      s.node_id = static_cast<std::uint16_t>(10 * s.node_id + (*id - '0'));
  const char* front_end = option("--front-end", s.command_line, end);
  const char* trace_path = option("--trace", s.command_line, end);
  if (front_end == nullptr || trace_path == nullptr) return;
  if (!s.front_end.open(front_end, semihosting::Mode::kRead))
    fault("cannot open front-end", __FILE__, __LINE__);
  if (!s.trace.open(trace_path, semihosting::Mode::kWrite)) fault("cannot open trace", __FILE__, __LINE__);
}

/// The timer stands still while the board waits, so that waiting, which takes as long as the host likes, is in no
/// difference of ticks(). Starting it anew also aligns its 40 ns to the instruction.
void stop_timer() { timer().control = 0; }
void start_timer() { timer().control = kTimerEnable; }

void read_front_end(void* bytes, std::size_t size) {
  if (!state().front_end.read(bytes, size)) semihosting::exit(0);  // the emulation is gone: power off
}

void drop_samples() {
  State& s = state();
  float dropped[16];
  while (s.samples_left > 0) {
    const std::size_t count = std::min<std::size_t>(s.samples_left, 16);
    read_front_end(dropped, count * sizeof(float));
    s.samples_left -= count;
  }
}

void next_step() {
  State& s = state();
  drop_samples();
  std::uint8_t done[sizeof(DonePayload)];
  std::memcpy(done, &s.counted, sizeof done);
  (void)trace(kTraceDone, 0, {done, sizeof done});
  read_front_end(&s.step, sizeof s.step);
  if (s.step.magic != kStepMagic) fault("front-end out of step", __FILE__, __LINE__);
  if ((s.step.flags & kStepStop) != 0) semihosting::exit(0);
  s.samples_left = s.step.n_samples;
  s.step_open = true;
}

/// Takes what the UART brings until the step's last byte; false if there is no more room for it.
bool take_link_bytes() {
  State& s = state();
  while (s.counted.link_bytes_received != s.step.link_bytes) {
    if (s.received.full()) return false;
    if ((uart().state & kUartReceiveFull) == 0) continue;
    (void)s.received.try_push_back(static_cast<std::uint8_t>(uart().data));
    ++s.counted.link_bytes_received;
  }
  return true;
}

}  // namespace

void start(int /*argc*/, char** /*argv*/) {
  uart().baud_divider = 16;
  uart().control = kUartEnable;
  timer().reload = kTimerStart;
  timer().value = kTimerStart;
  read_options();
  start_timer();
}

std::uint16_t node_id() { return state().node_id; }

void wait() {
  State& s = state();
  if (!s.front_end.is_open()) {  // nobody gives turns: what the UART holds now
    if (!s.received.full() && (uart().state & kUartReceiveFull) != 0)
      (void)s.received.try_push_back(static_cast<std::uint8_t>(uart().data));
    return;
  }
  stop_timer();
  if (!s.step_open) next_step();
  if (take_link_bytes()) s.step_open = false;  // else the firmware makes room first, and the step goes on
  start_timer();
}

std::int64_t now_us() {
  if (state().front_end.is_open()) return state().step.now_us;
  static std::uint32_t last = kTimerStart;
  static std::uint64_t ticks = 0;
  const std::uint32_t value = timer().value;
  ticks += last - value;
  last = value;
  return static_cast<std::int64_t>(ticks / 25);
}

std::size_t read_scan(Span<float> samples, std::int64_t& time_us) {
  State& s = state();
  if (s.samples_left == 0) return 0;
  const std::size_t length = s.samples_left;
  const std::size_t count = std::min(length, samples.size());
  time_us = s.step.scan_time_us;
  read_front_end(samples.data(), count * sizeof(float));
  s.samples_left -= count;
  drop_samples();
  return length;
}

std::size_t receive(Span<std::uint8_t> bytes) {
  State& s = state();
  std::size_t count = 0;
  for (; count < bytes.size() && !s.received.empty(); ++count) {
    bytes[count] = s.received.front();
    s.received.pop_front();
  }
  return count;
}

void send(Span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    uart().data = byte;
    while ((uart().state & kUartSendFull) != 0) {
    }
  }
  state().counted.link_bytes_sent += static_cast<std::uint32_t>(bytes.size());
}

std::uint32_t ticks() { return (kTimerStart - timer().value) * kInstructionsPerTimerTick; }

bool taps_wanted() { return (state().step.flags & kStepTaps) != 0; }

bool trace(std::uint8_t kind, std::uint8_t id, Span<const std::uint8_t> bytes) {
  const State& s = state();
  if (!s.trace.is_open()) return false;
  TraceHeader header;
  header.sequence = s.step.sequence;
  header.kind = kind;
  header.id = id;
  header.n_bytes = static_cast<std::uint32_t>(bytes.size());
  return s.trace.write(&header, sizeof header) && s.trace.write(bytes.data(), bytes.size());
}

void fault(const char* what, const char* file, int line) {
  static char text[160];  // static: the stack may be what broke
  char digits[12] = {};
  std::size_t first = sizeof digits - 1;
  for (int rest = line; rest > 0 && first > 0; rest /= 10)
    digits[--first] = static_cast<char>('0' + rest % 10);
  std::size_t size = 0;
  for (const char* part : {what, " (", file, ":", static_cast<const char*>(digits + first), ")\n"})
    for (; *part != '\0' && size + 1 < sizeof text; ++part) text[size++] = *part;
  semihosting::print(text);
  (void)trace(kTraceFault, 0, {reinterpret_cast<const std::uint8_t*>(text), size});
  semihosting::exit(1);
}

}  // namespace echofuse::board
