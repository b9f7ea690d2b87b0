#include "echofuse/signal/alignment.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace echofuse;
using signal::Aligner;
using signal::Alignment;
using signal::AlignmentConfig;
using signal::AlignmentMethod;

namespace {

std::vector<float> bell(std::size_t n, float place) {
  std::vector<float> samples(n);
  for (std::size_t k = 0; k < n; ++k) {
    const float x = (static_cast<float>(k) - place) / 6.0f;
    samples[k] = 100.0f * std::exp(-0.5f * x * x);
  }
  return samples;
}

Span<const float> view(const std::vector<float>& samples) { return {samples.data(), samples.size()}; }

}  // namespace

TEST_CASE("a delay is found and undone, by as much as the method allows") {
  const std::vector<float> reference = bell(300, 140.0f);
  const std::vector<float> scan = bell(300, 143.3f);
  struct Case {
    AlignmentMethod method;
    float shift;
    float residual;
  };
  for (const Case& expected :
       {Case{AlignmentMethod::kSubSample, 3.3f, 0.3f}, Case{AlignmentMethod::kInteger, 3.0f, 4.0f},
        Case{AlignmentMethod::kNone, 0.0f, 40.0f}}) {
    AlignmentConfig config;
    config.method = expected.method;
    Aligner aligner;
    REQUIRE(aligner.configure(config) == Status::kOk);
    Alignment alignment;
    REQUIRE(aligner.estimate(view(scan), view(reference), 0, 0, 300, alignment) == Status::kOk);
    CHECK(alignment.shift_samples == doctest::Approx(expected.shift).epsilon(0.01));
    std::vector<float> aligned(302, -1.0f);
    REQUIRE(aligner.shift(view(scan), alignment.shift_samples, {aligned.data() + 1, 300}) == Status::kOk);
    CHECK(aligned.front() == -1.0f);
    CHECK(aligned.back() == -1.0f);
    float worst = 0.0f;
    for (std::size_t k = 0; k < 300; ++k) worst = std::max(worst, std::abs(aligned[k + 1] - reference[k]));
    CHECK(worst < expected.residual);
    CHECK(worst > 0.01f * expected.residual);
  }
}

TEST_CASE("an empty envelope has no correlation and no shift from a parabola") {
  Aligner aligner;
  REQUIRE(aligner.configure(AlignmentConfig{}) == Status::kOk);
  const std::vector<float> nothing(50, 0.0f);
  Alignment alignment;
  REQUIRE(aligner.estimate(view(nothing), view(nothing), 0, 0, 50, alignment) == Status::kOk);
  CHECK(alignment.correlation == 0.0f);
  CHECK(std::isfinite(alignment.shift_samples));
}
