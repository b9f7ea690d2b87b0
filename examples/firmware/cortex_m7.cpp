/// A bare Cortex-M7 without any vendor's code: from reset to main(), and a board whose radar and link are the files
/// scans.bin and frames.bin of the debugger (Arm semihosting; the records are posix.cpp's). In a product read_scan() and
/// send() are drivers.

#include <cstddef>
#include <cstdint>

#include "board.hpp"
#include "echofuse/core/check.hpp"

namespace {

/// Arm semihosting 2.0: what the debugger does for the machine.
std::int32_t semihosting(std::uint32_t operation, const void* block) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = block;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}
constexpr std::uint32_t kOpen = 0x01, kWriteText = 0x04, kWrite = 0x05, kRead = 0x06, kExit = 0x20;
constexpr std::uint32_t kReadMode = 1, kWriteMode = 5;
constexpr std::uint32_t kApplicationExit = 0x20026;

std::uint32_t word(const void* address) { return reinterpret_cast<std::uintptr_t>(address); }

[[noreturn]] void stop(std::uint32_t status) {
  const std::uint32_t block[] = {kApplicationExit, status};
  for (;;) semihosting(kExit, block);
}

[[noreturn]] void fault(const char* what) {
  semihosting(kWriteText, what);
  stop(1);
}

std::uint32_t open(const char* path, std::size_t length, std::uint32_t mode) {
  const std::uint32_t block[] = {word(path), mode, length};
  const std::int32_t handle = semihosting(kOpen, block);
  if (handle < 0) fault("cannot open scans.bin or frames.bin\n");
  return static_cast<std::uint32_t>(handle);
}

/// True when all of it was moved.
bool transfer(std::uint32_t operation, std::uint32_t handle, const void* bytes, std::size_t size) {
  const std::uint32_t block[] = {handle, word(bytes), size};
  return semihosting(operation, block) == 0;
}

std::uint32_t scans, frames;  // handles

}  // namespace

namespace board {

bool read_scan(echofuse::Span<float> samples, std::int64_t& time_us) {
  return transfer(kRead, scans, &time_us, sizeof time_us) &&
         transfer(kRead, scans, samples.data(), samples.size() * sizeof(float));
}

void send(echofuse::Span<const std::uint8_t> bytes) {
  if (!transfer(kWrite, frames, bytes.data(), bytes.size())) fault("cannot write frames.bin\n");
}

}  // namespace board

/// In place of the library's, which aborts.
[[noreturn]] void echofuse::check_failed(const char* expression, const char*, int) { fault(expression); }

int main();

extern "C" {

// Defined by cortex_m7.ld.
extern std::uint32_t stack_end[], data_begin[], data_end[], data_source[], bss_begin[], bss_end[];
using Function = void (*)();
extern Function init_begin[], init_end[];

/// Memory as C++ expects it, then main().
[[gnu::noinline, noreturn]] void begin() {
  const std::uint32_t* source = data_source;
  for (std::uint32_t* at = data_begin; at < data_end; ++at) *at = *source++;
  for (std::uint32_t* at = bss_begin; at < bss_end; ++at) *at = 0;
  for (Function* construct = init_begin; construct < init_end; ++construct) (*construct)();
  scans = open("scans.bin", 9, kReadMode);
  frames = open("frames.bin", 10, kWriteMode);
  stop(static_cast<std::uint32_t>(main()));
}

/// The floating-point unit before anything else: any C++ may use it.
[[noreturn]] void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xe000ed88) |= 0x00f00000u;  // CPACR
  asm volatile("dsb\n isb" ::: "memory");
  begin();
}

/// No exception is enabled, so each is a fault.
[[noreturn]] void exception() { fault("processor fault\n"); }

struct Vectors {
  const std::uint32_t* stack;
  Function handlers[15];
};
[[gnu::section(".vectors"), gnu::used]] const Vectors vectors = {
    stack_end,
    {reset, exception, exception, exception, exception, exception, exception, exception, exception, exception,
     exception, exception, exception, exception, exception}};

}  // extern "C"
