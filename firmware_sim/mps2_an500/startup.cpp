#include <cstddef>
#include <cstdint>

#include "board.hpp"
#include "echofuse/core/check.hpp"
#include "memory.hpp"

/// From reset to main(), and what happens after a fault.

namespace echofuse {

/// Takes the place of the library's default, which aborts.
[[noreturn]] void check_failed(const char* expression, const char* file, int line) {
  board::fault(expression, file, line);
}

}  // namespace echofuse

extern "C" {

// Defined by image.ld.
extern std::uint32_t image_stack_begin[], image_stack_end[];
extern std::uint32_t image_data_begin[], image_data_end[], image_data_source[];
extern std::uint32_t image_bss_begin[], image_bss_end[];
using Initialiser = void (*)();
extern Initialiser image_init_begin[], image_init_end[];

/// The registers that the processor put on the stack when it took an exception.
struct ExceptionFrame {
  std::uint32_t r0, r1, r2, r3, r12, lr, pc, xpsr;
};

// Called by the assembly below.

/// Memory as C++ expects it. The stack is painted below what this function itself uses.
[[gnu::used]] void image_prepare_memory(std::uint32_t* stack) {
  for (std::uint32_t* word = image_stack_begin; word < stack; ++word) *word = echofuse::board::kStackPaint;
  const std::uint32_t* source = image_data_source;
  for (std::uint32_t* word = image_data_begin; word < image_data_end; ++word) *word = *source++;
  for (std::uint32_t* word = image_bss_begin; word < image_bss_end; ++word) *word = 0;
  for (Initialiser* initialise = image_init_begin; initialise < image_init_end; ++initialise) (*initialise)();
}

[[gnu::used, noreturn]] void image_end() { echofuse::board::fault("main() returned", "startup.cpp", 0); }

[[gnu::used, noreturn]] void image_exception(const ExceptionFrame* frame, std::uint32_t number) {
  const bool on_stack =
      reinterpret_cast<std::uintptr_t>(frame) >= reinterpret_cast<std::uintptr_t>(image_stack_begin) &&
      frame + 1 <= reinterpret_cast<const ExceptionFrame*>(image_stack_end);
  if (!on_stack) echofuse::board::fault("stack overflow", "exception", static_cast<int>(number));
  static char text[] = "processor fault at 0x00000000";
  for (std::size_t digit = 0; digit < 8; ++digit)
    text[sizeof text - 2 - digit] = "0123456789abcdef"[(frame->pc >> (4 * digit)) & 15u];
  echofuse::board::fault(text, "exception", static_cast<int>(number));
}

/// The floating-point unit first (CPACR, coprocessors 10 and 11): any C++ may use it. The stack pointer comes
/// from the vector table; 64 bytes below it are left to image_prepare_memory().
[[gnu::naked, gnu::used, noreturn]] void image_reset() {
  asm volatile(
      "ldr r0, =0xe000ed88\n"
      "ldr r1, [r0]\n"
      "orr r1, r1, #0x00f00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "sub r0, sp, #64\n"
      "bl image_prepare_memory\n"
      "movs r0, #0\n"
      "movs r1, #0\n"
      "bl main\n"
      "b image_end\n"
      ".ltorg\n");
}

/// Every exception: none is enabled, so each is a fault. It starts on a fresh stack: the old one may be what broke.
[[gnu::naked, gnu::used, noreturn]] void image_take_exception() {
  asm volatile(
      "mov r0, sp\n"
      "mrs r1, ipsr\n"
      "ldr sp, =image_stack_end\n"
      "b image_exception\n"
      ".ltorg\n");
}

}  // extern "C"

namespace {

using Handler = void (*)();

struct VectorTable {
  const std::uint32_t* stack;
  Handler handlers[15];
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable kVectors = {
    image_stack_end,
    {image_reset, image_take_exception, image_take_exception, image_take_exception, image_take_exception,
     image_take_exception, image_take_exception, image_take_exception, image_take_exception,
     image_take_exception, image_take_exception, image_take_exception, image_take_exception,
     image_take_exception, image_take_exception}};

}  // namespace

namespace echofuse::board {

std::size_t stack_used_bytes() {
  const std::uint32_t* word = image_stack_begin;
  while (word < image_stack_end && *word == kStackPaint) ++word;
  return static_cast<std::size_t>(image_stack_end - word) * sizeof(std::uint32_t);
}

}  // namespace echofuse::board
