#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "echofuse/core/span.hpp"

/// tests/wire/vectors.toml, which PyCyphal has made; the Python tests read the same.
namespace echofuse::link::testing {

struct Vector {
  std::uint16_t subject = 0;
  std::uint16_t source = 0;
  std::uint64_t transfer_id = 0;
  std::vector<std::uint8_t> payload;
  std::vector<std::uint8_t> frame;
};

inline std::vector<std::uint8_t> from_hex(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
  return bytes;
}

/// Of TOML only what that file uses: [name], key = number, key = "hex".
inline std::map<std::string, Vector> read_vectors() {
  std::map<std::string, Vector> vectors;
  std::ifstream file(ECHOFUSE_WIRE_VECTORS);
  std::string line;
  Vector* vector = nullptr;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#') continue;
    if (line[0] == '[') {
      vector = &vectors[line.substr(1, line.size() - 2)];
      continue;
    }
    const std::string key = line.substr(0, line.find(' '));
    const std::string value = line.substr(line.find('=') + 2);
    if (key == "payload") vector->payload = from_hex(value.substr(1, value.size() - 2));
    if (key == "frame") vector->frame = from_hex(value.substr(1, value.size() - 2));
    if (key == "subject") vector->subject = static_cast<std::uint16_t>(std::stoul(value));
    if (key == "source") vector->source = static_cast<std::uint16_t>(std::stoul(value));
    if (key == "transfer_id") vector->transfer_id = std::stoull(value);
  }
  return vectors;
}

template <class T>
Span<const T> span_of(const std::vector<T>& values) {
  return {values.data(), values.size()};
}

}  // namespace echofuse::link::testing
