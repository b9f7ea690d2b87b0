#pragma once

#include <cstddef>
#include <cstdint>

/// What the debugger, here QEMU, does for a bare machine: files and the end (Arm semihosting specification 2.0). The
/// machine stands still meanwhile, its timers as well.
namespace echofuse::board::semihosting {

enum class Mode : std::uint32_t { kRead = 1, kWrite = 5 };  ///< "rb", "wb"

/// A file that is open, or not.
class File {
 public:
  /// Opening a named pipe waits for its other end.
  bool open(const char* path, Mode mode);
  bool is_open() const { return handle_ >= 0; }

  /// All of it; false at the end of the file: the other end is gone.
  bool read(void* bytes, std::size_t size) const;
  bool write(const void* bytes, std::size_t size) const;

 private:
  std::int32_t handle_ = -1;
};

/// What stood behind -append (or arg=) of the command that started the machine, ended by 0; false if it is too long.
bool command_line(char* text, std::size_t capacity);

/// Text for whoever watches the machine's console.
void print(const char* text);

[[noreturn]] void exit(std::uint32_t status);

}  // namespace echofuse::board::semihosting
