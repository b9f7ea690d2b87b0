#include "common.hpp"
#include "echofuse/node/scan/gaussian_cfar.hpp"
#include "echofuse/node/scan/leading_edge.hpp"
#include "echofuse/node/scan/target_traces.hpp"
#include "echofuse/node/scan/time_zero.hpp"
#include "echofuse/node/scan/weak_signal.hpp"

namespace echofuse::bindings {
namespace {

using namespace echofuse::node;

void bind_time_zero(py::module_& m) {
  ConfigBinder<TimeZeroConfig>(m, "TimeZeroConfig", "Time zero of an M-sequence radar.")
      .field("learning_responses", &TimeZeroConfig::learning_responses,
             "whose mean shows the cross-talk, >= 1")
      .field("strong_fraction", &TimeZeroConfig::strong_fraction, "of the largest magnitude, in (0, 1]")
      .field("least_peak_factor", &TimeZeroConfig::least_peak_factor, "largest over mean magnitude, > 1")
      .field("moved_samples", &TimeZeroConfig::moved_samples, "[sample] farther away, it has moved, >= 0")
      .field("moved_responses", &TimeZeroConfig::moved_responses, "in a row: switched on anew, >= 1");
  py::class_<TimeZeroResult>(m, "TimeZeroResult", "Where a response's cross-talk was.")
      .def_readonly("found", &TimeZeroResult::found, "the response is rotated")
      .def_readonly("moved", &TimeZeroResult::moved, "what was learnt so far is void")
      .def_readonly("rotation_samples", &TimeZeroResult::rotation_samples, "[sample] to the left")
      .def_readonly("fraction_samples", &TimeZeroResult::fraction_samples, "[sample] behind its own");
  py::class_<TimeZeroFinder>(m, "TimeZeroFinder", "Turns responses until the cross-talk stands in its place.")
      .def(py::init<>())
      .def("configure", &TimeZeroFinder::configure, py::arg("config"), py::arg("n_samples"),
           py::arg("expected_samples"))
      .def("reset", &TimeZeroFinder::reset)
      .def(
          "process",
          [](TimeZeroFinder& self, const FloatArray& response, std::size_t kept_samples) {
            const Span<const float> input = as_span(response, "response");
            const std::size_t size = kept_samples == 0 ? input.size() : kept_samples;
            FloatArray rotated(static_cast<py::ssize_t>(size));
            TimeZeroResult result;
            const Status status = self.process(input, {rotated.mutable_data(), size}, result);
            return py::make_tuple(status, result, status == Status::kOk ? rotated : FloatArray(0));
          },
          py::arg("response").noconvert(), py::arg("kept_samples") = 0,
          "(status, result, rotated): response (n_samples,) [count]; rotated its first kept_samples, 0: "
          "all.");
}

void bind_weak_signal(py::module_& m) {
  ConfigBinder<WeakSignalConfig>(m, "WeakSignalConfig", "Weak-signal enhancement.")
      .field("floor_factor", &WeakSignalConfig::floor_factor,
             "least divisor in deviations of the noise, >= 0")
      .field("noise_samples", &WeakSignalConfig::noise_samples, "[sample] at the end of a response, >= 1")
      .field("averaging_factor", &WeakSignalConfig::averaging_factor, "weight of the past, in [0, 1)");
  py::class_<WeakSignalEnhancer>(m, "WeakSignalEnhancer", "Raises far echoes to the height of near ones.")
      .def(py::init<>())
      .def("configure", &WeakSignalEnhancer::configure, py::arg("config"), py::arg("n_samples"))
      .def("reset", &WeakSignalEnhancer::reset)
      .def("noise", &WeakSignalEnhancer::noise, "[count] rms")
      .def(
          "process",
          [](WeakSignalEnhancer& self, const FloatArray& samples) {
            FloatArray enhanced = to_array(as_span(samples, "samples"));
            const Status status =
                self.process({enhanced.mutable_data(), static_cast<std::size_t>(enhanced.size())});
            return py::make_tuple(status, status == Status::kOk ? enhanced : FloatArray(0));
          },
          py::arg("samples").noconvert(), "(status, enhanced): both (n_samples,), the latter in [-1, 1].");
}

void bind_gaussian_cfar(py::module_& m) {
  py::enum_<ClutterSpread>(m, "ClutterSpread", "What the slow spread is about.")
      .value("standard_deviation", ClutterSpread::kStandardDeviation, "the slow mean")
      .value("rms", ClutterSpread::kRms, "0");
  ConfigBinder<GaussianCfarConfig>(m, "GaussianCfarConfig", "CFAR for Gaussian clutter.")
      .field("fast_factor", &GaussianCfarConfig::fast_factor, "weight of a sample, in (0, 1]")
      .field("slow_factor", &GaussianCfarConfig::slow_factor, "weight of a sample, in (0, 1]")
      .field("deviations", &GaussianCfarConfig::deviations, "of the fast mean above the slow one, > 0")
      .field("spread", &GaussianCfarConfig::spread, "what the slow spread is about")
      .field("starting_samples", &GaussianCfarConfig::starting_samples, "[sample] of the run-in, >= 1");
  py::class_<GaussianCfarDetector>(m, "GaussianCfarDetector", "Decides along one response.")
      .def(py::init<>())
      .def("configure", &GaussianCfarDetector::configure, py::arg("config"))
      .def("delay_samples", &GaussianCfarDetector::delay_samples, "[sample] by which the fast mean is late")
      .def(
          "process",
          [](const GaussianCfarDetector& self, const FloatArray& samples) {
            const Span<const float> input = as_span(samples, "samples");
            ArrayOf<std::uint8_t> decisions(samples.size());
            const Status status = self.process(input, {decisions.mutable_data(), input.size()});
            return py::make_tuple(status, status == Status::kOk ? decisions : ArrayOf<std::uint8_t>(0));
          },
          py::arg("samples").noconvert(), "(status, decisions): both (n_samples,), the latter 0 or 1.");
}

void bind_target_traces(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(TargetTrace, toa_samples, weight);
  ConfigBinder<TargetTraceConfig>(m, "TargetTraceConfig", "Simple targets for distributed ones.")
      .field("window_samples", &TargetTraceConfig::window_samples, "[sample] a person's extent, >= 1")
      .field("least_hits", &TargetTraceConfig::least_hits, "in the window, 1 to window_samples")
      .field("density_correction", &TargetTraceConfig::density_correction, "for what missing hits delay");
  py::class_<TargetTracer>(m, "TargetTracer", "Where targets begin.")
      .def(py::init<>())
      .def("configure", &TargetTracer::configure, py::arg("config"))
      .def(
          "process",
          [](const TargetTracer& self, const ArrayOf<std::uint8_t>& decisions) {
            BoundedVector<TargetTrace, kMaxDetectionsPerNode> traces;  // what one report carries
            const Status status = self.process(as_span(decisions, "decisions"), traces);
            return py::make_tuple(status, to_array(traces));
          },
          py::arg("decisions").noconvert(),
          "(status, traces): decisions (n_samples,); traces is structured.");
}

void bind_leading_edge(py::module_& m) {
  py::enum_<EdgeRule>(m, "EdgeRule", "What the beginning of an echo is.")
      .value("fraction", EdgeRule::kFraction, "where the envelope first exceeds a fraction of its largest value")
      .value("contrast", EdgeRule::kContrast, "where its mean behind exceeds that before it the most");
  ConfigBinder<LeadingEdgeConfig>(m, "LeadingEdgeConfig", "Where an echo begins.")
      .field("rule", &LeadingEdgeConfig::rule, "what the beginning of an echo is")
      .field("fraction", &LeadingEdgeConfig::fraction, "fraction: of the window's largest envelope, in (0, 1)")
      .field("mean_samples", &LeadingEdgeConfig::mean_samples, "[sample] contrast: of either mean, 1 to 1000")
      .field("before_samples", &LeadingEdgeConfig::before_samples, "[sample] of the window, 0 to 1000")
      .field("after_samples", &LeadingEdgeConfig::after_samples, "[sample] of the window, 0 to 1000");
  py::class_<LeadingEdge>(m, "LeadingEdge", "Moves traces to the beginning of their echoes.")
      .def(py::init<>())
      .def("configure", &LeadingEdge::configure, py::arg("config"))
      .def(
          "process",
          [](const LeadingEdge& self, const FloatArray& envelope, const ArrayOf<TargetTrace>& given) {
            BoundedVector<TargetTrace, kMaxDetectionsPerNode> traces;
            for (const TargetTrace& trace : as_span(given, "traces"))
              if (!traces.try_push_back(trace)) throw py::value_error("traces: more than one report carries");
            const Status status = self.process(as_span(envelope, "envelope"), traces);
            return py::make_tuple(status, to_array(traces));
          },
          py::arg("envelope").noconvert(), py::arg("traces").noconvert(),
          "(status, traces): envelope (n_samples,) [count]; traces as of TargetTracer.");
}

}  // namespace

void bind_node_through_wall(py::module_& m) {
  bind_time_zero(m);
  bind_weak_signal(m);
  bind_gaussian_cfar(m);
  bind_target_traces(m);
  bind_leading_edge(m);
}

}  // namespace echofuse::bindings
