#include "common.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/random.hpp"
#include "echofuse/core/status.hpp"
#include "taps.hpp"

namespace echofuse::bindings {
namespace {

void bind_status(py::module_& m) {
  py::enum_<Status> status(m, "Status", "What a stage says of one call.");
  const auto add = [&status](Status value, const char* doc) { status.value(name(value), value, doc); };
  add(Status::kOk, "done, outputs complete");
  add(Status::kTruncated, "a capacity was reached: what the outputs hold is valid, something was left out");
  add(Status::kNotConfigured, "configure() has not succeeded yet; outputs empty");
  add(Status::kInvalidConfig, "the configuration is impossible; the earlier one stays in force");
  add(Status::kInvalidInput, "the data cannot be used; outputs empty");
}

void bind_limits(py::module_& m) {
  py::dict limits;
  const auto add = [&limits](const char* key, std::size_t value) { limits[key] = value; };
  add("max_samples_per_scan", kMaxSamplesPerScan);
  add("max_response_samples", kMaxResponseSamples);
  add("max_hits_per_scan", kMaxHitsPerScan);
  add("max_clusters_per_scan", kMaxClustersPerScan);
  add("max_detections_per_node", kMaxDetectionsPerNode);
  add("max_nodes", kMaxNodes);
  add("max_frame_history", kMaxFrameHistory);
  add("max_tuples_per_frame", kMaxTuplesPerFrame);
  add("max_measurements_per_frame", kMaxMeasurementsPerFrame);
  add("max_points_per_frame", kMaxPointsPerFrame);
  add("max_targets", kMaxTargets);
  add("max_tracks", kMaxTracks);
  add("max_particles", kMaxParticles);
  add("max_newborn_particles", kMaxNewbornParticles);
  add("max_assignment", kMaxAssignment);
  m.attr("LIMITS") = limits;
}

template <class Draw>
py::array_t<float> draw_many(std::size_t count, Draw draw) {
  py::array_t<float> values(static_cast<py::ssize_t>(count));
  float* out = values.mutable_data();
  for (std::size_t i = 0; i < count; ++i) out[i] = draw();
  return values;
}

void bind_random(py::module_& m) {
  py::class_<Pcg32>(m, "Pcg32", "PCG-XSH-RR 64/32; every number takes one 32-bit draw.")
      .def(py::init<std::uint64_t, std::uint64_t>(), py::arg("seed") = 0, py::arg("stream") = 0)
      .def("next_u32", &Pcg32::next_u32)
      .def("uniform", &Pcg32::uniform, "In [0, 1), a multiple of 2^-24.")
      .def("normal", &Pcg32::normal, "Standard normal, within +-5.42.")
      .def(
          "uniforms", [](Pcg32& self, std::size_t n) { return draw_many(n, [&] { return self.uniform(); }); },
          py::arg("n"), "The next n uniforms, (n,).")
      .def(
          "normals", [](Pcg32& self, std::size_t n) { return draw_many(n, [&] { return self.normal(); }); },
          py::arg("n"), "The next n normals, (n,).");
}

/// TAPS: a tap's number on a board's trace -> its name and columns (0: one-dimensional).
void bind_taps(py::module_& m) {
  py::dict taps;
  for (const TapLayout& layout : kTapLayouts)
    taps[py::int_(static_cast<int>(layout.tap))] = py::make_tuple(layout.name, layout.columns);
  m.attr("TAPS") = taps;
}

}  // namespace

void bind_core(py::module_& m) {
  bind_status(m);
  bind_taps(m);
  bind_limits(m);
  bind_random(m);
}

}  // namespace echofuse::bindings
