/// A host process: scans from standard input, each an int64 time_us and float32 samples, little-endian; frames to standard
/// output.

#include <cstdio>

#include "board.hpp"

namespace board {

bool read_scan(echofuse::Span<float> samples, std::int64_t& time_us) {
  return std::fread(&time_us, sizeof time_us, 1, stdin) == 1 &&
         std::fread(samples.data(), sizeof(float), samples.size(), stdin) == samples.size();
}

void send(echofuse::Span<const std::uint8_t> bytes) {
  std::fwrite(bytes.data(), 1, bytes.size(), stdout);
  std::fflush(stdout);
}

}  // namespace board
