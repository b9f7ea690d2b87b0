#include "board.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include "lockstep.hpp"

/// A board as a host process. With --front-end and --trace (two named pipes) it is stepped by the emulation
/// (lockstep.hpp); without them it runs by the host's clock, and raw scans have to come over the link.
///
///   PROGRAM --node-id N (--link unix:PATH | tcp:HOST:PORT | serial:DEVICE) [--front-end PIPE --trace PIPE]
namespace echofuse::board {
namespace {

constexpr int kTickMilliseconds = 50;  ///< [ms] longest sleep of a board that nobody steps

struct Host {
  std::uint16_t id = 0;
  int link = -1;
  int front_end = -1;
  int trace = -1;
  StepHeader step;
  std::vector<float> samples;  ///< of this step's scan
  bool scan_waiting = false;
  std::vector<std::uint8_t> received;  ///< not yet taken by the firmware
  DonePayload counted;

  bool stepped() const { return front_end >= 0; }
};

Host& host() {
  static Host only;
  return only;
}

[[noreturn]] void leave(const char* what, const char* detail) {
  std::fprintf(stderr, "board %u: %s %s: %s\n", host().id, what, detail, std::strerror(errno));
  std::exit(3);
}

std::int64_t monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1000000000 + now.tv_nsec;
}

/// False at the end of the stream: the other side is gone, which is how a board is switched off.
bool read_all(int file, void* bytes, std::size_t size) {
  auto* at = static_cast<std::uint8_t*>(bytes);
  while (size > 0) {
    const ssize_t got = ::read(file, at, size);
    if (got == 0) return false;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

void write_all(int file, const void* bytes, std::size_t size) {
  const auto* at = static_cast<const std::uint8_t*>(bytes);
  while (size > 0) {
    const ssize_t put = ::write(file, at, size);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) std::exit(0);  // nobody listens any more
    at += put;
    size -= static_cast<std::size_t>(put);
  }
}

int open_unix(const char* path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (std::strlen(path) >= sizeof address.sun_path) leave("link path too long", path);
  std::strncpy(address.sun_path, path, sizeof address.sun_path - 1);
  const int file = ::socket(AF_UNIX, SOCK_STREAM, 0);
  if (file < 0 || ::connect(file, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
    leave("cannot join the link", path);
  return file;
}

int open_tcp(const char* where) {
  const char* colon = std::strrchr(where, ':');
  if (colon == nullptr) leave("expected tcp:HOST:PORT, got", where);
  const std::vector<char> text(where, colon);
  std::vector<char> name(text);
  name.push_back('\0');
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(name.data(), colon + 1, &hints, &found) != 0) leave("unknown host", where);
  const int file = ::socket(found->ai_family, found->ai_socktype, found->ai_protocol);
  if (file < 0 || ::connect(file, found->ai_addr, found->ai_addrlen) != 0)
    leave("cannot join the link", where);
  ::freeaddrinfo(found);
  return file;
}

int open_serial(const char* device) {
  const int file = ::open(device, O_RDWR | O_NOCTTY);
  termios settings{};
  if (file < 0 || ::tcgetattr(file, &settings) != 0) leave("cannot open", device);
  ::cfmakeraw(&settings);
  if (::tcsetattr(file, TCSANOW, &settings) != 0) leave("cannot set up", device);
  return file;
}

int open_link(const char* where) {
  if (std::strncmp(where, "unix:", 5) == 0) return open_unix(where + 5);
  if (std::strncmp(where, "tcp:", 4) == 0) return open_tcp(where + 4);
  if (std::strncmp(where, "serial:", 7) == 0) return open_serial(where + 7);
  leave("unknown kind of link", where);
}

int open_pipe(const char* path, int flags) {
  const int file = ::open(path, flags);
  if (file < 0) leave("cannot open", path);
  return file;
}

/// Takes what the link holds, at most `limit` bytes; waits for the first of them when `limit` says they will come.
void take_link_bytes(std::size_t limit) {
  std::uint8_t bytes[512];
  const ssize_t got = ::read(host().link, bytes, std::min(limit, sizeof bytes));
  if (got == 0 || (got < 0 && errno != EINTR)) std::exit(0);  // the link is gone
  if (got < 0) return;
  host().received.insert(host().received.end(), bytes, bytes + got);
  host().counted.link_bytes_received += static_cast<std::uint32_t>(got);
}

void wait_for_step() {
  Host& h = host();
  std::uint8_t done[sizeof(DonePayload)];
  std::memcpy(done, &h.counted, sizeof done);
  (void)trace(kTraceDone, 0, {done, sizeof done});
  if (!read_all(h.front_end, &h.step, sizeof h.step)) std::exit(0);
  if (h.step.magic != kStepMagic) fault("front-end out of step", __FILE__, __LINE__);
  if ((h.step.flags & kStepStop) != 0) std::exit(0);
  h.samples.resize(h.step.n_samples);
  if (!read_all(h.front_end, h.samples.data(), h.samples.size() * sizeof(float))) std::exit(0);
  h.scan_waiting = h.step.n_samples > 0;
  while (h.counted.link_bytes_received != h.step.link_bytes)
    take_link_bytes(h.step.link_bytes - h.counted.link_bytes_received);
}

}  // namespace

void start(int argc, char** argv) {
  Host& h = host();
  const char* front_end = nullptr;
  const char* trace_path = nullptr;
  for (int i = 1; i + 1 < argc; i += 2) {
    const char* value = argv[i + 1];
    if (std::strcmp(argv[i], "--node-id") == 0) {
      h.id = static_cast<std::uint16_t>(std::atoi(value));
    } else if (std::strcmp(argv[i], "--link") == 0) {
      h.link = open_link(value);
    } else if (std::strcmp(argv[i], "--front-end") == 0) {
      front_end = value;
    } else if (std::strcmp(argv[i], "--trace") == 0) {
      trace_path = value;
    } else {
      leave("unknown option", argv[i]);
    }
  }
  if (h.link < 0 || (front_end == nullptr) != (trace_path == nullptr))
    leave("usage: --node-id N --link WHERE [--front-end PIPE --trace PIPE]", "");
  if (front_end == nullptr) return;
  h.front_end = open_pipe(front_end, O_RDONLY);
  h.trace = open_pipe(trace_path, O_WRONLY);
}

std::uint16_t node_id() { return host().id; }

void wait() {
  Host& h = host();
  if (h.stepped()) return wait_for_step();
  pollfd link{h.link, POLLIN, 0};
  if (::poll(&link, 1, kTickMilliseconds) > 0) take_link_bytes(512);
}

std::int64_t now_us() { return host().stepped() ? host().step.now_us : monotonic_ns() / 1000; }

std::size_t read_scan(Span<float> samples, std::int64_t& time_us) {
  Host& h = host();
  if (!h.scan_waiting) return 0;
  h.scan_waiting = false;
  std::copy_n(h.samples.begin(), std::min(samples.size(), h.samples.size()), samples.begin());
  time_us = h.step.scan_time_us;
  return h.samples.size();
}

std::size_t receive(Span<std::uint8_t> bytes) {
  std::vector<std::uint8_t>& waiting = host().received;
  const std::size_t count = std::min(bytes.size(), waiting.size());
  const auto end = waiting.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(waiting.begin(), end, bytes.begin());
  waiting.erase(waiting.begin(), end);
  return count;
}

void send(Span<const std::uint8_t> bytes) {
  write_all(host().link, bytes.data(), bytes.size());
  host().counted.link_bytes_sent += static_cast<std::uint32_t>(bytes.size());
}

std::uint32_t ticks() { return static_cast<std::uint32_t>(monotonic_ns()); }

std::size_t stack_used_bytes() { return 0; }

bool taps_wanted() { return host().stepped() && (host().step.flags & kStepTaps) != 0; }

bool trace(std::uint8_t kind, std::uint8_t id, Span<const std::uint8_t> bytes) {
  Host& h = host();
  if (!h.stepped()) return false;
  TraceHeader header;
  header.sequence = h.step.sequence;
  header.kind = kind;
  header.id = id;
  header.n_bytes = static_cast<std::uint32_t>(bytes.size());
  write_all(h.trace, &header, sizeof header);
  write_all(h.trace, bytes.data(), bytes.size());
  return true;
}

void fault(const char* what, const char* file, int line) {
  char text[256];
  const int size = std::snprintf(text, sizeof text, "%s (%s:%d)", what, file, line);
  const auto length = static_cast<std::size_t>(std::clamp(size, 0, static_cast<int>(sizeof text) - 1));
  (void)trace(kTraceFault, 0, {reinterpret_cast<const std::uint8_t*>(text), length});
  std::fprintf(stderr, "board %u: %s\n", host().id, text);
  std::_Exit(4);
}

}  // namespace echofuse::board
