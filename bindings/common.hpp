#pragma once

/// What every file of bindings shares. Each room defines bind_ROOM(m) and adds to the flat module `_core`.
///
/// Arrays. An argument of type FloatArray with .noconvert() takes a C-contiguous float32 array and nothing
/// else: another dtype or stride is a TypeError, never a silent copy. as_span() then checks that it is
/// one-dimensional (ValueError):
///
///   .def("process", [](CfarDetector& self, const FloatArray& power) {
///          BoundedVector<CfarHit, kMaxHitsPerScan> hits;
///          const Status status = self.process(as_span(power, "power"), hits);
///          return py::make_tuple(status, to_array(hits));  // an owned copy, structured if T is
///        }, py::arg("power").noconvert(), "...")
///
/// (For a struct T first say PYBIND11_NUMPY_DTYPE(T, member, ...) in the bind function.)
///
/// Configurations: see config_binder.hpp.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <string>
#include <type_traits>

#include "config_binder.hpp"
#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::bindings {

namespace py = pybind11;

void bind_core(py::module_& m);
void bind_signal(py::module_& m);
void bind_estimation(py::module_& m);
void bind_node(py::module_& m);
void bind_node_through_wall(py::module_& m);
void bind_node_through_wall_pipeline(py::module_& m);
void bind_hub(py::module_& m);
void bind_link(py::module_& m);

template <class T>
using ArrayOf = py::array_t<T, py::array::c_style>;
using FloatArray = ArrayOf<float>;

/// The elements of a one-dimensional array, viewed; ValueError otherwise.
template <class T>
Span<const T> as_span(const ArrayOf<T>& array, const char* name) {
  if (array.ndim() != 1) throw py::value_error(std::string(name) + " must be one-dimensional");
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// All elements of a two-dimensional array (rows, columns), row by row; ValueError when it has other columns.
template <class T>
Span<const T> as_span_of_rows(const ArrayOf<T>& array, std::size_t columns, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != static_cast<py::ssize_t>(columns))
    throw py::value_error(std::string(name) + " must have shape (n, " + std::to_string(columns) + ")");
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// A new array that owns a copy of the elements.
template <class T>
py::array_t<std::remove_const_t<T>> to_array(Span<T> values) {
  return py::array_t<std::remove_const_t<T>>(static_cast<py::ssize_t>(values.size()), values.data());
}
template <class T>
py::array_t<T> to_array(const BoundedVector<T>& values) {
  return to_array(values.span());
}

}  // namespace echofuse::bindings
