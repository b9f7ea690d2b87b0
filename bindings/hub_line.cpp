/// What a line of antennas before a wall needs.

#include "echofuse/hub/locate/line_locator.hpp"
#include "echofuse/hub/locate/wall.hpp"
#include "echofuse/hub/measure/trace_pairing.hpp"
#include "hub.hpp"

namespace echofuse::bindings {

namespace {

void bind_trace_pairing(py::module_& m) {
  using hub::ClosingRule;
  using hub::PairingRule;
  using hub::TraceCouple;
  using hub::TracePairing;
  using hub::TracePairingConfig;
  PYBIND11_NUMPY_DTYPE(TraceCouple, delay1_s, delay2_s, centre, completions);
  py::enum_<PairingRule>(m, "PairingRule")
      .value("assignment", PairingRule::kAssignment)
      .value("all_pairs", PairingRule::kAllPairs);
  py::enum_<ClosingRule>(m, "ClosingRule")
      .value("exact", ClosingRule::kExact)
      .value("printed", ClosingRule::kPrinted);
  ConfigBinder<TracePairingConfig>(m, "TracePairingConfig", "Couples of two receivers' traces.")
      .field("rule", &TracePairingConfig::rule)
      .field("closing", &TracePairingConfig::closing)
      .field("separation_m", &TracePairingConfig::separation_m, "[m] between the receivers")
      .field("clock_hz", &TracePairingConfig::clock_hz, "[Hz]")
      .field("correction_samples", &TracePairingConfig::correction_samples, "[sample]")
      .field("completion_limit", &TracePairingConfig::completion_limit, "responses");
  py::class_<TracePairing>(m, "TracePairing")
      .def(py::init<>())
      .def("configure", &TracePairing::configure, py::arg("config"))
      .def("reset", &TracePairing::reset)
      .def(
          "process",
          [](TracePairing& self, const FloatArray& delay1, const FloatArray& delay2) {
            BoundedVector<TraceCouple, kMaxPointsPerFrame> couples;
            const Status status =
                self.process(as_span(delay1, "delay1_s"), as_span(delay2, "delay2_s"), couples);
            return py::make_tuple(status, to_array(couples));
          },
          py::arg("delay1_s").noconvert(), py::arg("delay2_s").noconvert(),
          "(status, structured array of TraceCouple).");
}

}  // namespace

void bind_hub_line(py::module_& m) {
  bind_trace_pairing(m);
  using hub::LineFix;
  using hub::LineFixStatus;
  using hub::LineLocator;
  using hub::LineLocatorConfig;
  using hub::Wall;
  using hub::WallCompensation;
  using hub::WallConfig;
  py::enum_<WallCompensation>(m, "WallCompensation")
      .value("none", WallCompensation::kNone)
      .value("first_kind", WallCompensation::kFirstKind)
      .value("second_kind", WallCompensation::kSecondKind);
  ConfigBinder<WallConfig>(m, "WallConfig", "A homogeneous slab.")
      .field("thickness_m", &WallConfig::thickness_m, "[m]")
      .field("relative_permittivity", &WallConfig::relative_permittivity, "[1]")
      .field("compensation", &WallConfig::compensation);
  py::class_<Wall>(m, "Wall")
      .def(py::init<>())
      .def("configure", &Wall::configure, py::arg("config"))
      .def(
          "ray",
          [](const Wall& self, float lateral_m, float depth_m) {
            const hub::WallRay ray = self.ray(lateral_m, depth_m);
            return py::make_tuple(ray.excess_m, ray.lateral, ray.depth);
          },
          py::arg("lateral_m"), py::arg("depth_m"),
          "(excess [m], gradient of the optical path along the wall, and across it), one way.");
  py::enum_<LineFixStatus>(m, "LineFixStatus")
      .value("fix", LineFixStatus::kFix)
      .value("no_intersection", LineFixStatus::kNoIntersection)
      .value("too_near_axis", LineFixStatus::kTooNearAxis)
      .value("singular", LineFixStatus::kSingular);
  ConfigBinder<LineLocatorConfig>(m, "LineLocatorConfig", "Position before a line of antennas.")
      .field("wall", &LineLocatorConfig::wall)
      .field("path_std_m", &LineLocatorConfig::path_std_m, "[m]");
  py::class_<LineFix>(m, "LineFix")
      .def_readonly("status", &LineFix::status)
      .def_property_readonly(
          "position_m", [](const LineFix& fix) { return py::make_tuple(fix.position.x_m, fix.position.y_m); })
      .def_property_readonly(
          "covariance_m2",
          [](const LineFix& fix) {
            return py::make_tuple(fix.covariance_xx_m2, fix.covariance_xy_m2, fix.covariance_yy_m2);
          },
          "(xx, xy, yy) [m^2]")
      .def_readonly("iterations", &LineFix::iterations)
      .def_readonly("converged", &LineFix::converged);
  m.def("two_ellipses", &hub::two_ellipses, py::arg("path1_m"), py::arg("path2_m"), py::arg("rx1_x_m"),
        py::arg("rx2_x_m"));
  py::class_<LineLocator>(m, "LineLocator")
      .def(py::init<>())
      .def(
          "configure",
          [](LineLocator& self, const LineLocatorConfig& config, const FloatArray& rx_x) {
            return self.configure(config, as_span(rx_x, "rx_x_m"));
          },
          py::arg("config"), py::arg("rx_x_m").noconvert())
      .def(
          "process",
          [](const LineLocator& self, const FloatArray& path, const FloatArray& weight) {
            LineFix fix;
            const Status status = self.process(as_span(path, "path_m"), as_span(weight, "weight"), fix);
            return py::make_tuple(status, fix);
          },
          py::arg("path_m").noconvert(), py::arg("weight").noconvert(), "(status, LineFix).");
}

}  // namespace echofuse::bindings
