#include <stdexcept>

#include "common.hpp"
#include "echofuse/core/random.hpp"
#include "echofuse/estimation/assignment.hpp"
#include "echofuse/estimation/gaussian.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/estimation/mixture_em.hpp"
#include "echofuse/estimation/resampling.hpp"
#include "particles.hpp"

namespace echofuse::bindings {
namespace {

using estimation::ConstantVelocityFilter;
using estimation::Mixture;
using estimation::MixtureComponent;
using estimation::MixtureConfig;
using estimation::MixtureFitter;
using estimation::PeakInitialisation;

template <class Matrix>
py::array_t<float> matrix_to_array(const Matrix& matrix) {
  py::array_t<float> array({matrix.rows(), matrix.cols()});
  auto out = array.mutable_unchecked<2>();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) out(r, c) = matrix(r, c);
  return array;
}

template <class Matrix>
Matrix array_to_matrix(const FloatArray& array, const char* name) {
  Matrix matrix;
  const auto rows = as_span_of_rows(array, static_cast<std::size_t>(matrix.cols()), name);
  if (array.shape(0) != matrix.rows()) throw py::value_error(std::string(name) + " has the wrong shape");
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
    for (Eigen::Index c = 0; c < matrix.cols(); ++c)
      matrix(r, c) = rows[static_cast<std::size_t>(r * matrix.cols() + c)];
  return matrix;
}

void bind_functions(py::module_& m) {
  m.def(
      "gaussian_kernel",
      [](const FloatArray& squared_distance) {
        const auto in = as_span(squared_distance, "squared_distance");
        py::array_t<float> out(static_cast<py::ssize_t>(in.size()));
        for (std::size_t i = 0; i < in.size(); ++i)
          out.mutable_data()[i] = estimation::gaussian_kernel(in[i]);
        return out;
      },
      py::arg("squared_distance").noconvert(), "exp(-d^2 / 2) of each squared distance (n,), 0 beyond 25.");
  m.def(
      "systematic_resample",
      [](const FloatArray& weights, float uniform, std::size_t n_out) {
        ArrayOf<std::uint16_t> indices(static_cast<py::ssize_t>(n_out));
        const Status status = estimation::systematic_resample(as_span(weights, "weights"), uniform,
                                                              {indices.mutable_data(), n_out});
        return py::make_tuple(status, indices);
      },
      py::arg("weights").noconvert(), py::arg("uniform"), py::arg("n_out"), "(status, indices (n_out,)).");
  m.def(
      "assign",
      [](const FloatArray& cost) {
        if (cost.ndim() != 2) throw py::value_error("cost must have shape (n_rows, n_columns)");
        ArrayOf<int> columns(cost.shape(0));
        const Status status = estimation::assign(
            {cost.data(), static_cast<std::size_t>(cost.size())}, static_cast<std::size_t>(cost.shape(0)),
            static_cast<std::size_t>(cost.shape(1)),
            {columns.mutable_data(), static_cast<std::size_t>(columns.size())});
        return py::make_tuple(status, columns);
      },
      py::arg("cost").noconvert(), "(status, column of each row or -1) of the least total cost.");
}

void bind_kalman(py::module_& m) {
  using State = ConstantVelocityFilter::State;
  using Covariance = ConstantVelocityFilter::Covariance;
  using Covariance2 = ConstantVelocityFilter::Covariance2;
  py::class_<ConstantVelocityFilter>(m, "ConstantVelocityFilter", "State x, vx, y, vy and its covariance.")
      .def(py::init([](const FloatArray& state, const FloatArray& covariance) {
             const auto values = as_span(state, "state");
             if (values.size() != 4) throw py::value_error("state must have shape (4,)");
             return ConstantVelocityFilter(State(values[0], values[1], values[2], values[3]),
                                           array_to_matrix<Covariance>(covariance, "covariance"));
           }),
           py::arg("state").noconvert(), py::arg("covariance").noconvert())
      .def("predict", &ConstantVelocityFilter::predict, py::arg("dt_s"),
           py::arg("acceleration_density_m2ps3"), py::arg("velocity_decay") = 1.0f)
      .def(
          "update",
          [](ConstantVelocityFilter& self, float x_m, float y_m, const FloatArray& covariance) {
            self.update({x_m, y_m}, array_to_matrix<Covariance2>(covariance, "measurement_covariance_m2"));
          },
          py::arg("x_m"), py::arg("y_m"), py::arg("measurement_covariance_m2").noconvert())
      .def_property_readonly("state",
                             [](const ConstantVelocityFilter& self) {
                               return to_array(Span<const float>(self.state().data(), 4));
                             })
      .def_property_readonly("covariance", [](const ConstantVelocityFilter& self) {
        return matrix_to_array(self.covariance());
      });
}

void bind_mixture(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(MixtureComponent, x_m, y_m, vx_mps, vy_mps, covariance_xx_m2, covariance_xy_m2,
                       covariance_yy_m2, share);
  py::enum_<PeakInitialisation>(m, "PeakInitialisation", "Where the search for peaks begins.")
      .value("measurements", PeakInitialisation::kMeasurements)
      .value("k_means_plus_plus", PeakInitialisation::kKMeansPlusPlus);
  ConfigBinder<MixtureConfig>(m, "MixtureConfig", "Gaussian mixture by expectation-maximisation.")
      .field("initialisation", &MixtureConfig::initialisation)
      .field("restarts", &MixtureConfig::restarts, "of k_means_plus_plus")
      .field("initial_std_m", &MixtureConfig::initial_std_m, "[m]")
      .field("covariance_floor_m2", &MixtureConfig::covariance_floor_m2, "[m^2]")
      .field("background_density_per_m2", &MixtureConfig::background_density_per_m2, "[1/m^2], 0: none")
      .field("max_iterations", &MixtureConfig::max_iterations)
      .field("tolerance_m", &MixtureConfig::tolerance_m, "[m]");
  py::class_<MixtureFitter>(m, "MixtureFitter", "Peaks of a particle density.")
      .def(py::init<>())
      .def("configure", &MixtureFitter::configure, py::arg("config"))
      .def(
          "process",
          [](const MixtureFitter& self, const FloatArray& particles, const FloatArray& seeds,
             std::size_t n_components, Pcg32& random) {
            const auto rows = as_span_of_rows(seeds, 3, "seeds");
            std::vector<estimation::MixtureSeed> places;
            for (std::size_t i = 0; i < rows.size(); i += 3)
              places.push_back({rows[i], rows[i + 1], rows[i + 2]});
            Mixture mixture;
            const auto set = to_particles(particles);
            const Status status = self.process(view(set), view(places), n_components, random, mixture);
            return py::make_tuple(status, to_array(mixture.components), mixture.background);
          },
          py::arg("particles").noconvert(), py::arg("seeds").noconvert(), py::arg("n_components"),
          py::arg("random"),
          "(status, structured array of MixtureComponent, background share) of particles (n, 5) and seeds "
          "(s, 3).")
      .def(
          "log_likelihood",
          [](const MixtureFitter& self, const FloatArray& particles,
             const py::array_t<MixtureComponent, py::array::c_style>& components, float background) {
            Mixture mixture;
            (void)mixture.components.assign(as_span(components, "components"));
            mixture.background = background;
            const auto set = to_particles(particles);
            return self.log_likelihood(view(set), mixture);
          },
          py::arg("particles").noconvert(), py::arg("components"), py::arg("background"),
          "Weighted mean log density of particles (n, 5).");
}

}  // namespace

void bind_estimation(py::module_& m) {
  bind_functions(m);
  bind_kalman(m);
  bind_mixture(m);
}

}  // namespace echofuse::bindings
