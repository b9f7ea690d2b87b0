/// Counts the instructions of one Taylor-series fix, as test_taylor_3d.py runs it: a line "INSTRUCTIONS ITERATIONS
/// STATUS" for every wall, start and number of receivers, and at last the bytes of stack.

#include "echofuse/hub/locate/taylor_3d.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "board.hpp"
#include "mps2_an500/semihosting.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::hub;

constexpr std::size_t kReceivers = 8;
constexpr float kSpacing_m = 0.39f;
const std::array<Point3, kReceivers> kAntennas{{{-kSpacing_m, 0.0f, 0.0f},
                                                {kSpacing_m, 0.0f, 0.0f},
                                                {0.0f, 0.0f, -kSpacing_m},
                                                {0.0f, 0.0f, kSpacing_m},
                                                {-0.6f, 0.0f, -0.6f},
                                                {0.6f, 0.0f, -0.6f},
                                                {-0.6f, 0.0f, 0.6f},
                                                {0.6f, 0.0f, 0.6f}}};
constexpr Point3 kPerson{1.5f, 4.0f, 0.8f};
constexpr std::array<float, kReceivers> kError_m{0.02f,  -0.01f,  -0.02f, 0.01f,
                                                 0.015f, -0.015f, 0.01f,  -0.02f};

Taylor3d only_taylor;

float distance_m(const Point3& a, const Point3& b) {
  const float x = a.x_m - b.x_m, y = a.y_m - b.y_m, z = a.z_m - b.z_m;
  return std::sqrt(x * x + y * y + z * z);
}

void print(std::uint32_t value, char end) {
  char text[12] = {};
  std::size_t at = sizeof text - 1;
  text[--at] = end;
  do {
    text[--at] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value > 0);
  board::semihosting::print(text + at);
}

void count(const Taylor3dConfig& config, std::size_t n) {
  std::array<float, kReceivers> path_m, variance_m2;
  const float wall_m = config.wall.compensation == WallCompensation::kNone ? 0.0f : 0.4f;
  for (std::size_t i = 0; i < n; ++i) {
    path_m[i] = distance_m(kPerson, {}) + distance_m(kPerson, kAntennas[i]) + wall_m + kError_m[i];
    variance_m2[i] = 4e-4f;
  }
  ECHOFUSE_CHECK(only_taylor.configure(config, {}, {kAntennas.data(), n}) == Status::kOk);
  Taylor3dFix fix;
  const std::uint32_t before = board::ticks();
  const Status status = only_taylor.process({path_m.data(), n}, {variance_m2.data(), n}, {}, fix);
  const std::uint32_t instructions = board::ticks() - before;
  ECHOFUSE_CHECK(status == Status::kOk);
  print(instructions, ' ');
  print(static_cast<std::uint32_t>(fix.iterations), ' ');
  print(static_cast<std::uint32_t>(fix.status), '\n');
}

}  // namespace

int main(int argc, char** argv) {
  echofuse::board::start(argc, argv);
  for (const WallCompensation wall :
       {WallCompensation::kNone, WallCompensation::kFirstKind, WallCompensation::kSecondKind}) {
    for (const Taylor3dStart start : {Taylor3dStart::kThreeDTwoD, Taylor3dStart::kApproximate}) {
      for (const std::size_t n : {std::size_t{4}, kReceivers}) {
        Taylor3dConfig config;
        config.wall.compensation = wall;
        config.start = start;
        count(config, n);
      }
    }
  }
  print(static_cast<std::uint32_t>(echofuse::board::stack_used_bytes()), '\n');
  echofuse::board::semihosting::exit(0);
}
