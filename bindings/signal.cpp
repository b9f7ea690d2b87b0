#include "echofuse/signal/alignment.hpp"
#include "echofuse/signal/envelope.hpp"

#include "common.hpp"

namespace echofuse::bindings {
namespace {

using namespace echofuse::signal;

void bind_envelope(py::module_& m) {
  py::enum_<EnvelopeMethod>(m, "EnvelopeMethod", "How the envelope is taken.")
      .value("hilbert", EnvelopeMethod::kHilbert, "|r + jH(r)|")
      .value("square_low_pass", EnvelopeMethod::kSquareLowPass, "sqrt(2 LPF(r^2))");
  ConfigBinder<EnvelopeConfig>(m, "EnvelopeConfig", "Amplitude envelope of a scan.")
      .field("method", &EnvelopeConfig::method, "how the envelope is taken")
      .field("hilbert_half_length_samples", &EnvelopeConfig::hilbert_half_length_samples,
             "[sample] taps on each side")
      .field("low_pass_half_length_samples", &EnvelopeConfig::low_pass_half_length_samples,
             "[sample] taps on each side")
      .field("low_pass_cutoff_hz", &EnvelopeConfig::low_pass_cutoff_hz, "[Hz] below half the sample rate");
  py::class_<Envelope>(m, "Envelope", "Amplitude envelope of a scan.")
      .def(py::init<>())
      .def("configure", &Envelope::configure, py::arg("config"), py::arg("sample_rate_hz"))
      .def(
          "process",
          [](const Envelope& self, const FloatArray& scan) {
            const Span<const float> samples = as_span(scan, "scan");
            FloatArray envelope(scan.size());
            const Status status = self.process(samples, {envelope.mutable_data(), samples.size()});
            return py::make_tuple(status, status == Status::kOk ? envelope : FloatArray(0));
          },
          py::arg("scan").noconvert(), "(status, envelope): both (n_samples,) [count].")
      .def("reach_samples", &Envelope::reach_samples, "[sample] how far a sample spreads");
}

void bind_alignment(py::module_& m) {
  py::enum_<AlignmentMethod>(m, "AlignmentMethod", "How finely scans are aligned.")
      .value("sub_sample", AlignmentMethod::kSubSample, "whole shift and a fraction")
      .value("integer", AlignmentMethod::kInteger, "whole shift")
      .value("none", AlignmentMethod::kNone, "no shift");
  ConfigBinder<AlignmentConfig>(m, "AlignmentConfig", "Alignment of scans with the background.")
      .field("method", &AlignmentConfig::method, "how finely")
      .field("max_shift_samples", &AlignmentConfig::max_shift_samples, "[sample] searched on each side")
      .field("window_samples", &AlignmentConfig::window_samples,
             "[sample] compared, around the background's strongest one; >= 8")
      .field("interpolator_half_length_samples", &AlignmentConfig::interpolator_half_length_samples,
             "[sample] taps on each side");
  py::class_<Alignment>(m, "Alignment", "Delay of a scan against a reference.")
      .def_readonly("shift_samples", &Alignment::shift_samples, "[sample] how much later")
      .def_readonly("correlation", &Alignment::correlation, "[1] normalised, at the best whole shift");
  py::class_<Aligner>(m, "Aligner", "Finds and undoes the delay of a scan.")
      .def(py::init<>())
      .def("configure", &Aligner::configure, py::arg("config"))
      .def(
          "estimate",
          [](const Aligner& self, const FloatArray& envelope, const FloatArray& reference, int coarse_shift,
             int first, int last) {
            Alignment alignment;
            const Status status =
                self.estimate(as_span(envelope, "envelope"), as_span(reference, "reference"), coarse_shift,
                              first, last, alignment);
            return py::make_tuple(status, alignment);
          },
          py::arg("envelope").noconvert(), py::arg("reference").noconvert(), py::arg("coarse_shift"),
          py::arg("first"), py::arg("last"), "(status, alignment); envelope, reference (n_samples,) [count].")
      .def(
          "shift",
          [](const Aligner& self, const FloatArray& input, float shift_samples) {
            const Span<const float> samples = as_span(input, "input");
            FloatArray output(input.size());
            const Status status = self.shift(samples, shift_samples, {output.mutable_data(), samples.size()});
            return py::make_tuple(status, status == Status::kOk ? output : FloatArray(0));
          },
          py::arg("input").noconvert(), py::arg("shift_samples"),
          "(status, output): input (n_samples,) read at k + shift_samples.");
}

}  // namespace

void bind_signal(py::module_& m) {
  bind_envelope(m);
  bind_alignment(m);
}

}  // namespace echofuse::bindings
