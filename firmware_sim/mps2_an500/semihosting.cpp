#include "semihosting.hpp"

#include <cstring>

namespace echofuse::board::semihosting {
namespace {

enum Operation : std::uint32_t {
  kOpen = 0x01,
  kWrite0 = 0x04,
  kWrite = 0x05,
  kRead = 0x06,
  kGetCommandLine = 0x15,
  kExitExtended = 0x20,
};
constexpr std::uint32_t kApplicationExit = 0x20026;

std::int32_t call(Operation operation, const void* arguments) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = arguments;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

std::uint32_t word(const void* address) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(address));
}

}  // namespace

bool File::open(const char* path, Mode mode) {
  const std::uint32_t block[] = {word(path), static_cast<std::uint32_t>(mode),
                                 static_cast<std::uint32_t>(std::strlen(path))};
  handle_ = call(kOpen, block);
  return is_open();
}

// Both calls return how many bytes are left to do; a pipe may be short of bytes, or of room, for a while.

bool File::read(void* bytes, std::size_t size) const {
  auto* at = static_cast<std::uint8_t*>(bytes);
  while (size > 0) {
    const std::uint32_t block[] = {static_cast<std::uint32_t>(handle_), word(at), size};
    const auto left = static_cast<std::uint32_t>(call(kRead, block));
    if (left >= size) return false;  // nothing came, or -1
    at += size - left;
    size = left;
  }
  return true;
}

bool File::write(const void* bytes, std::size_t size) const {
  const auto* at = static_cast<const std::uint8_t*>(bytes);
  while (size > 0) {
    const std::uint32_t block[] = {static_cast<std::uint32_t>(handle_), word(at), size};
    const auto left = static_cast<std::uint32_t>(call(kWrite, block));
    if (left >= size) return false;
    at += size - left;
    size = left;
  }
  return true;
}

bool command_line(char* text, std::size_t capacity) {
  std::uint32_t block[] = {word(text), capacity};
  return call(kGetCommandLine, block) == 0;
}

void print(const char* text) { (void)call(kWrite0, text); }

void exit(std::uint32_t status) {
  const std::uint32_t block[] = {kApplicationExit, status};
  for (;;) (void)call(kExitExtended, block);
}

}  // namespace echofuse::board::semihosting
