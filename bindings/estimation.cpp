#include <stdexcept>

#include "common.hpp"
#include "echofuse/core/random.hpp"
#include "echofuse/estimation/assignment.hpp"
#include "echofuse/estimation/gaussian.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/estimation/mixture_em.hpp"
#include "echofuse/estimation/resampling.hpp"
#include "echofuse/estimation/turning_filter.hpp"
#include "particles.hpp"

namespace echofuse::bindings {
namespace {

using estimation::ConstantVelocityFilter;
using estimation::Mixture;
using estimation::MixtureComponent;
using estimation::MixtureConfig;
using estimation::MixtureFitter;
using estimation::PeakInitialisation;
using estimation::TurningFilter;

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

template <class Vector>
Vector array_to_vector(const FloatArray& array, const char* name) {
  const auto values = as_span(array, name);
  if (values.size() != static_cast<std::size_t>(Vector::SizeAtCompileTime))
    throw py::value_error(std::string(name) + " has the wrong shape");
  return Vector(values.data());
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

template <int kDimension>
void bind_kalman(py::module_& m, const char* name, const char* documentation) {
  using Filter = ConstantVelocityFilter<kDimension>;
  using Covariance = typename Filter::Covariance;
  using PositionCovariance = typename Filter::PositionCovariance;
  using State = typename Filter::State;
  using Vector = typename Filter::Vector;
  py::class_<Filter>(m, name, documentation)
      .def(py::init([](const FloatArray& state, const FloatArray& covariance) {
             return Filter(array_to_vector<State>(state, "state"),
                           array_to_matrix<Covariance>(covariance, "covariance"));
           }),
           py::arg("state").noconvert(), py::arg("covariance").noconvert())
      .def("predict", &Filter::predict, py::arg("dt_s"), py::arg("acceleration_density_m2ps3"),
           py::arg("velocity_decay") = 1.0f)
      .def(
          "update",
          [](Filter& self, const FloatArray& position, const FloatArray& covariance) {
            self.update(array_to_vector<Vector>(position, "position_m"),
                        array_to_matrix<PositionCovariance>(covariance, "measurement_covariance_m2"));
          },
          py::arg("position_m").noconvert(), py::arg("measurement_covariance_m2").noconvert())
      .def(
          "update_along",
          [](Filter& self, const FloatArray& direction, float innovation_m, float variance_m2) {
            self.update_along(array_to_vector<Vector>(direction, "direction"), innovation_m, variance_m2);
          },
          py::arg("direction").noconvert(), py::arg("innovation_m"), py::arg("variance_m2"))
      .def_property_readonly(
          "state",
          [](const Filter& self) { return to_array(Span<const float>(self.state().data(), 2 * kDimension)); })
      .def_property_readonly("covariance",
                             [](const Filter& self) { return matrix_to_array(self.covariance()); });
}

template <int kDimension>
void bind_turning_filter(py::module_& m, const char* name, const char* documentation) {
  using Filter = TurningFilter<kDimension>;
  using State = typename Filter::State;
  using Vector = typename Filter::Vector;
  py::class_<Filter>(m, name, documentation)
      .def(py::init([](const FloatArray& state, const FloatArray& covariance, bool turns) {
             return Filter({array_to_vector<State>(state, "state"),
                            array_to_matrix<typename Filter::Covariance>(covariance, "covariance")},
                           turns);
           }),
           py::arg("state").noconvert(), py::arg("covariance").noconvert(), py::arg("turns"))
      .def(
          "predict",
          [](Filter& self, float dt_s, float straight, float turning, float begin, float end, float decay) {
            self.predict(dt_s, {straight, turning, begin, end}, decay);
          },
          py::arg("dt_s"), py::arg("straight_density_m2ps3"), py::arg("turning_density_m2ps3"),
          py::arg("begin_probability"), py::arg("end_probability"), py::arg("velocity_decay") = 1.0f)
      .def(
          "update_along",
          [](Filter& self, const FloatArray& direction, float innovation_m, float variance_m2) {
            self.update_along(array_to_vector<Vector>(direction, "direction"), innovation_m, variance_m2);
          },
          py::arg("direction").noconvert(), py::arg("innovation_m"), py::arg("variance_m2"))
      .def("hold", &Filter::hold, py::arg("axis"), py::arg("low_m"), py::arg("high_m"))
      .def_property_readonly(
          "state",
          [](const Filter& self) { return to_array(Span<const float>(self.state().data(), 2 * kDimension)); })
      .def_property_readonly("covariance",
                             [](const Filter& self) { return matrix_to_array(self.covariance()); })
      .def_property_readonly("turning_probability", &Filter::turning_probability);
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
  bind_kalman<2>(m, "ConstantVelocityFilter", "State x, vx, y, vy and its covariance.");
  bind_kalman<3>(m, "ConstantVelocityFilter3d", "State x, vx, y, vy, z, vz and its covariance.");
  bind_turning_filter<2>(m, "TurningFilter", "ConstantVelocityFilter of one who walks straight, or turns.");
  bind_turning_filter<3>(m, "TurningFilter3d", "ConstantVelocityFilter3d of one who walks straight, or turns.");
  bind_mixture(m);
}

}  // namespace echofuse::bindings
