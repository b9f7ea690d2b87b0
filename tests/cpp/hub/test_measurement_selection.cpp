#include "echofuse/hub/measure/measurement_selection.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "echofuse/hub/measure/point_clusters.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::hub;

constexpr Area kRoom{0.0f, 0.0f, 11.5f, 6.0f};

std::vector<NodeSite> ring(int n) {
  std::vector<NodeSite> nodes;
  for (int i = 0; i < n; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(n);
    nodes.push_back({i, {5.75f, 0.0f}, {5.75f + 5.7f * std::cos(angle), 3.0f + 2.9f * std::sin(angle)}});
  }
  return nodes;
}

std::vector<FrameDetection> frame_of(const std::vector<NodeSite>& nodes, const std::vector<Point>& people) {
  std::vector<FrameDetection> detections;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::vector<float> paths;
    for (const Point& person : people) paths.push_back(path_length(person, nodes[i].tx, nodes[i].rx, 0.0f));
    std::sort(paths.begin(), paths.end());
    for (const float path : paths) detections.push_back({static_cast<int>(i), path, 15.0f});
  }
  return detections;
}

template <class T>
Span<const T> view(const std::vector<T>& values) {
  return {values.data(), values.size()};
}

}  // namespace

TEST_CASE("Three people, exact paths: three measurements, no ghosts; all tuples give dozens") {
  const std::vector<NodeSite> nodes = ring(6);
  const std::vector<Point> people{{2.5f, 2.0f}, {6.0f, 4.0f}, {9.0f, 1.8f}};
  const std::vector<FrameDetection> detections = frame_of(nodes, people);
  MeasurementSelection stage;
  BoundedVector<Measurement, kMaxMeasurementsPerFrame> measurements;
  REQUIRE(stage.configure(SelectionConfig{}, EllipseConfig{}, view(nodes), kRoom) == Status::kOk);
  REQUIRE(stage.process(view(detections), 6, {}, measurements) == Status::kOk);
  REQUIRE(measurements.size() == 3);
  for (const Point& person : people) {
    float nearest = 100.0f;
    for (const Measurement& m : measurements)
      nearest = std::min(nearest, std::hypot(m.x_m - person.x_m, m.y_m - person.y_m));
    CHECK(nearest < 0.02f);
  }
  SelectionConfig paper;
  paper.method = SelectionMethod::kAllTuples;
  REQUIRE(stage.configure(paper, EllipseConfig{}, view(nodes), kRoom) == Status::kOk);
  REQUIRE(stage.process(view(detections), 6, {}, measurements) == Status::kOk);
  CHECK(measurements.size() > 30);
  CHECK(stage.counters().tuples == 20 * 27);
}

TEST_CASE("A known person needs three nodes where a stranger needs four") {
  const std::vector<NodeSite> nodes = ring(6);
  std::vector<FrameDetection> detections = frame_of(nodes, {{4.0f, 3.0f}});
  detections.erase(detections.begin(), detections.begin() + 3);
  MeasurementSelection stage;
  BoundedVector<Measurement, kMaxMeasurementsPerFrame> measurements;
  REQUIRE(stage.configure(SelectionConfig{}, EllipseConfig{}, view(nodes), kRoom) == Status::kOk);
  REQUIRE(stage.process(view(detections), 6, {}, measurements) == Status::kOk);
  CHECK(measurements.empty());
  const std::array<Point, 1> known{{{4.2f, 2.9f}}};
  REQUIRE(stage.process(view(detections), 6, known, measurements) == Status::kOk);
  REQUIRE(measurements.size() == 1);
  CHECK(measurements[0].n_nodes == 3);
}

TEST_CASE("Sixteen detections on each of sixteen nodes: bounded, and what is cut is counted") {
  const std::vector<NodeSite> nodes = ring(16);
  std::vector<FrameDetection> detections;
  for (int node = 0; node < 16; ++node)
    for (int d = 0; d < 16; ++d)
      detections.push_back(
          {node, 12.0f + 0.3f * static_cast<float>(d), 4.0f + static_cast<float>((d * 7) % 16)});
  for (const int nu : {3, 8, 16}) {  // of nu = 16 a depth of two would make 65,536: one tuple remains
    SelectionConfig config;
    config.nodes_per_tuple = nu;
    MeasurementSelection stage;
    BoundedVector<Measurement, kMaxMeasurementsPerFrame> measurements;
    REQUIRE(stage.configure(config, EllipseConfig{}, view(nodes), kRoom) == Status::kOk);
    CHECK(stage.process(view(detections), 16, {}, measurements) == Status::kTruncated);
    CHECK(stage.counters().tuples <= kMaxTuplesPerFrame);
    CHECK(stage.counters().tuples >= (nu == 16 ? 1 : kMaxTuplesPerFrame / 2));
    CHECK(stage.counters().dropped_detections > 0);
    if (nu == 3) CHECK(stage.counters().tuples + stage.counters().dropped_tuples == 560u * 4096u);
  }
}

TEST_CASE("What is not a frame is refused and changes nothing") {
  const std::vector<NodeSite> nodes = ring(6);
  MeasurementSelection stage;
  BoundedVector<Measurement, kMaxMeasurementsPerFrame> measurements;
  CHECK(stage.process({}, 6, {}, measurements) == Status::kNotConfigured);
  REQUIRE(stage.configure(SelectionConfig{}, EllipseConfig{}, view(nodes), kRoom) == Status::kOk);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::vector<FrameDetection>> bad{{{6, 10.0f, 5.0f}},
                                                     {{-1, 10.0f, 5.0f}},
                                                     {{1, 10.0f, 5.0f}, {0, 10.0f, 5.0f}},
                                                     {{0, nan, 5.0f}},
                                                     {{0, 11.0f, 5.0f}, {0, 10.0f, 5.0f}},
                                                     {{0, 10.0f, nan}},
                                                     {{0, 10.0f, -1.0f}}};
  for (const std::vector<FrameDetection>& frame : bad)
    CHECK(stage.process(view(frame), 6, {}, measurements) == Status::kInvalidInput);
  CHECK(stage.counters().frames == 0);
  CHECK(stage.process({}, 0, {}, measurements) == Status::kOk);
}

TEST_CASE("A failed configure leaves the earlier configuration in force") {
  const std::vector<NodeSite> nodes = ring(6);
  MeasurementSelection stage;
  REQUIRE(stage.configure(SelectionConfig{}, EllipseConfig{}, view(nodes), kRoom) == Status::kOk);
  SelectionConfig paper;
  paper.method = SelectionMethod::kAllTuples;
  paper.residual = SelectionResidual::kEquationResidual;
  std::vector<NodeSite> mixed = nodes;
  mixed[2].tx = mixed[2].rx;
  CHECK(stage.configure(paper, EllipseConfig{}, view(mixed), kRoom) == Status::kInvalidConfig);
  CHECK(stage.configure(SelectionConfig{}, EllipseConfig{}, view(nodes).first(2), kRoom) ==
        Status::kInvalidConfig);
  BoundedVector<Measurement, kMaxMeasurementsPerFrame> measurements;
  CHECK(stage.process(view(frame_of(nodes, {{4.0f, 3.0f}})), 6, {}, measurements) == Status::kOk);
  CHECK(measurements.size() == 1);
}

TEST_CASE("The stages of measuring fit into 40 KiB") {
  CHECK(sizeof(MeasurementSelection) + sizeof(PointClusters) < 32 * 1024);
}
