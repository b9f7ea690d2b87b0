/// Positions in space, from an array of antennas or from anchors.

#include "echofuse/hub/locate/planar_3d.hpp"
#include "echofuse/hub/locate/taylor_3d.hpp"
#include "hub.hpp"

namespace echofuse::bindings {

namespace {

hub::Point3 as_point(const FloatArray& array, const char* name) {
  const auto values = as_span(array, name);
  if (values.size() != 3) throw py::value_error(std::string(name) + " must have shape (3,)");
  return {values[0], values[1], values[2]};
}

py::tuple as_tuple(const hub::Point3& point) { return py::make_tuple(point.x_m, point.y_m, point.z_m); }

std::vector<hub::Point3> as_points(const FloatArray& array, const char* name) {
  const auto values = as_span_of_rows(array, 3, name);
  std::vector<hub::Point3> points;
  for (std::size_t i = 0; i < values.size(); i += 3)
    points.push_back({values[i], values[i + 1], values[i + 2]});
  return points;
}

void bind_planar_3d(py::module_& m) {
  using hub::Planar3dFix;
  using hub::Planar3dMethod;
  using hub::Planar3dStatus;
  py::enum_<Planar3dMethod>(m, "Planar3dMethod")
      .value("three_d_two_d", Planar3dMethod::kThreeDTwoD)
      .value("approximate", Planar3dMethod::kApproximate);
  py::enum_<Planar3dStatus>(m, "Planar3dStatus")
      .value("fix", Planar3dStatus::kFix)
      .value("clipped", Planar3dStatus::kClipped)
      .value("bad_path", Planar3dStatus::kBadPath);
  py::class_<Planar3dFix>(m, "Planar3dFix")
      .def_readonly("status", &Planar3dFix::status)
      .def_property_readonly("position_m", [](const Planar3dFix& fix) { return as_tuple(fix.position); });
  m.def(
      "planar_3d",
      [](Planar3dMethod method, float spacing_m, const FloatArray& path) {
        const auto paths = as_span(path, "path_m");
        if (paths.size() != 4) throw py::value_error("path_m must have shape (4,)");
        if (!(spacing_m > 0.0f)) throw py::value_error("spacing_m must be > 0");
        return hub::planar_3d(method, spacing_m, {paths[0], paths[1], paths[2], paths[3]});
      },
      py::arg("method"), py::arg("spacing_m"), py::arg("path_m").noconvert());
}

}  // namespace

void bind_hub_array(py::module_& m) {
  bind_planar_3d(m);
  using hub::RangeKind;
  using hub::Taylor3d;
  using hub::Taylor3dConfig;
  using hub::Taylor3dFix;
  using hub::Taylor3dStart;
  using hub::Taylor3dStatus;
  py::enum_<Taylor3dStart>(m, "Taylor3dStart")
      .value("three_d_two_d", Taylor3dStart::kThreeDTwoD)
      .value("approximate", Taylor3dStart::kApproximate)
      .value("given", Taylor3dStart::kGiven);
  py::enum_<RangeKind>(m, "RangeKind")
      .value("bistatic", RangeKind::kBistatic)
      .value("one_way", RangeKind::kOneWay);
  py::enum_<Taylor3dStatus>(m, "Taylor3dStatus")
      .value("converged", Taylor3dStatus::kConverged)
      .value("diverging", Taylor3dStatus::kDiverging)
      .value("iteration_limit", Taylor3dStatus::kIterationLimit)
      .value("singular", Taylor3dStatus::kSingular)
      .value("no_start", Taylor3dStatus::kNoStart);
  ConfigBinder<Taylor3dConfig>(m, "Taylor3dConfig", "Position in space by the Taylor-series method.")
      .field("wall", &Taylor3dConfig::wall)
      .field("start", &Taylor3dConfig::start)
      .field("range_kind", &Taylor3dConfig::range_kind)
      .field("min_step_m", &Taylor3dConfig::min_step_m, "[m]")
      .field("max_iterations", &Taylor3dConfig::max_iterations);
  py::class_<Taylor3dFix>(m, "Taylor3dFix")
      .def_readonly("status", &Taylor3dFix::status)
      .def_property_readonly("position_m", [](const Taylor3dFix& fix) { return as_tuple(fix.position); })
      .def_property_readonly(
          "covariance_m2", [](const Taylor3dFix& fix) { return py::tuple(py::cast(fix.covariance_m2)); },
          "(xx, xy, xz, yy, yz, zz) [m^2]")
      .def_readonly("range_residual_m", &Taylor3dFix::range_residual_m)
      .def_readonly("iterations", &Taylor3dFix::iterations)
      .def_readonly("clipped_start", &Taylor3dFix::clipped_start);
  py::class_<Taylor3d>(m, "Taylor3d")
      .def(py::init<>())
      .def(
          "configure",
          [](Taylor3d& self, const Taylor3dConfig& config, const FloatArray& tx, const FloatArray& rx) {
            const std::vector<hub::Point3> receivers = as_points(rx, "rx_m");
            return self.configure(config, as_point(tx, "tx_m"), {receivers.data(), receivers.size()});
          },
          py::arg("config"), py::arg("tx_m").noconvert(), py::arg("rx_m").noconvert(),
          "tx_m (3,), rx_m (n, 3) [m].")
      .def(
          "process",
          [](const Taylor3d& self, const FloatArray& range, const FloatArray& variance,
             const FloatArray& given) {
            Taylor3dFix fix;
            const Status status = self.process(as_span(range, "range_m"), as_span(variance, "variance_m2"),
                                               as_point(given, "given_m"), fix);
            return py::make_tuple(status, fix);
          },
          py::arg("range_m").noconvert(), py::arg("variance_m2").noconvert(), py::arg("given_m").noconvert(),
          "(status, Taylor3dFix); given_m (3,) [m] counts only if the start is given.");
}

}  // namespace echofuse::bindings
