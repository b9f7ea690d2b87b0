#pragma once

/// What every file of bindings shares. One file a room; each defines bind_ROOM(m) and adds to the flat module
/// `_core`.
///
/// Arrays. An argument of type FloatArray with .noconvert() takes a C-contiguous float32 array and nothing
/// else: another dtype or stride is a TypeError, never a silent copy. as_span() then checks that it is
/// one-dimensional (ValueError):
///
///   .def("process", [](CfarDetector& self, const FloatArray& power) {
///          BoundedVector<CfarHit, kMaxHitsPerScan> hits;
///          const Status status = self.process(as_span(power, "power"), hits);
///          return py::make_tuple(status, to_array(hits));        // an owned copy, structured if T is a
///          struct
///        }, py::arg("power").noconvert(), "...")
///
/// (For a struct T first say PYBIND11_NUMPY_DTYPE(T, member, ...) in the bind function.)
///
/// Configurations. Names are given once, defaults come from the C++ struct:
///
///   ConfigBinder<CfarConfig>(m, "CfarConfig", "Cell-averaging CFAR.")
///       .field("false_alarm_probability", &CfarConfig::false_alarm_probability, "per tested cell, in (0,
///       1)") .field("guard_cells_per_side", &CfarConfig::guard_cells_per_side, "[bin]");
///
/// gives in Python a keyword-only constructor (an unknown keyword or a wrong type is a TypeError), attributes
/// to read and write (a bool is no number and None is no bool), repr, ==, copy, deepcopy; fields() -> tuple
/// of names; and invalid_field()
/// -> the name of the first field with an impossible value or None, from the C++ function `const char*
/// invalid_field(const CfarConfig&)` (nullptr when valid) that stands beside the struct. Fields may be bool,
/// integers, float, a bound enum, std::array of those, or another bound configuration; bind enums and inner
/// configurations first. The class is complete when the full expression ends. `.type()` is the py::class_ for
/// anything more.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::bindings {

namespace py = pybind11;

void bind_core(py::module_& m);
void bind_signal(py::module_& m);
void bind_estimation(py::module_& m);
void bind_node(py::module_& m);
void bind_hub(py::module_& m);

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

/// How a field's type reads in a stub.
template <class F>
struct FieldType {
  static std::string text() {
    if constexpr (std::is_same_v<F, bool>) {
      return "bool";
    } else if constexpr (std::is_integral_v<F>) {
      return "int";
    } else if constexpr (std::is_floating_point_v<F>) {
      return "float";
    } else {
      const py::type type = py::type::of(py::cast(F{}));
      return py::cast<std::string>(type.attr("__module__")) + "." +
             py::cast<std::string>(type.attr("__qualname__"));
    }
  }
};
template <class E, std::size_t kSize>
struct FieldType<std::array<E, kSize>> {
  static std::string text() { return "collections.abc.Sequence[" + FieldType<E>::text() + "]"; }
};

/// A bool from a bool, an integer from an integer, a float from either number; TypeError otherwise.
template <class F>
F number_of(const py::handle& value, const std::string& label) {
  const bool is_bool = py::isinstance<py::bool_>(value);
  if (is_bool == std::is_same_v<F, bool>) {
    try {
      return py::cast<F>(value);
    } catch (const py::cast_error&) {  // told below
    }
  }
  throw py::type_error(label + " cannot be " + py::cast<std::string>(py::repr(value)));
}

/// repr() of a field's value, floats with the fewest digits that make the same float32.
inline std::string text_of(const py::handle& value) {
  if (!py::isinstance<py::float_>(value)) return py::cast<std::string>(py::repr(value));
  const auto number = py::cast<float>(value);
  char text[32];
  for (int digits = 6; digits <= 9; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, static_cast<double>(number));
    if (std::strtof(text, nullptr) == number) break;
  }
  return py::cast<std::string>(py::repr(py::float_(std::strtod(text, nullptr))));
}

template <class T>
class ConfigBinder {
 public:
  ConfigBinder(py::module_& m, const char* name, const char* doc = "")
      : name_(name), type_(m, name, doc), names_(std::make_shared<std::vector<std::string>>()) {}
  ConfigBinder(const ConfigBinder&) = delete;
  ConfigBinder& operator=(const ConfigBinder&) = delete;
  ~ConfigBinder() noexcept(false) { finish(); }

  template <class F>
  ConfigBinder& field(const char* name, F T::*member, const char* doc = "") {
    std::string default_text = "...";
    if constexpr (std::is_arithmetic_v<F>) {  // pybind11 alone would take None for a bool and True for a
                                              // number
      type_.def_property(
          name, [member](const T& self) { return self.*member; },
          [member, label = name_ + "." + name](T& self, const py::typing::Union<F>& value) {
            self.*member = number_of<F>(value, label);
          },
          doc);
      default_text = text_of(py::cast(T{}.*member));
    } else {
      type_.def_readwrite(name, member, doc);
    }
    signature_ += std::string(", ") + name + ": " + FieldType<F>::text() + " = " + default_text;
    names_->emplace_back(name);
    return *this;
  }

  py::class_<T>& type() { return type_; }

 private:
  using Names = std::shared_ptr<const std::vector<std::string>>;

  static T from_keywords(const std::string& type_name, const Names& names, const py::kwargs& keywords) {
    py::object made = py::cast(T{});
    for (const auto& item : keywords) {
      const auto key = py::cast<std::string>(item.first);
      bool known = false;
      for (const std::string& name : *names) known = known || name == key;
      if (!known) throw py::type_error(type_name + " has no field '" + key + "'");
      try {
        made.attr(key.c_str()) = item.second;
      } catch (py::error_already_set& error) {
        if (!error.matches(PyExc_TypeError)) throw;
        throw py::type_error(type_name + "." + key + " cannot be " +
                             py::cast<std::string>(py::repr(item.second)));
      }
    }
    return py::cast<T>(made);
  }

  static std::string repr(const std::string& type_name, const Names& names, const py::object& self) {
    std::string text = type_name + "(";
    for (const std::string& name : *names) {
      if (text.back() != '(') text += ", ";
      text += name + "=" + text_of(self.attr(name.c_str()));
    }
    return text + ")";
  }

  static bool equal(const Names& names, const py::object& self, const py::object& other) {
    for (const std::string& name : *names)
      if (!self.attr(name.c_str()).equal(other.attr(name.c_str()))) return false;
    return true;
  }

  void finish() {
    const Names names = names_;
    const std::string type_name = name_;
    {
      py::options options;  // our own signature line names the fields, for help() and for the stub
      options.disable_function_signatures();
      const std::string doc = "__init__(self: " + py::cast<std::string>(type_.attr("__module__")) + "." +
                              type_name + (names->empty() ? std::string() : ", *" + signature_) +
                              ") -> None\n";
      type_.def(py::init([type_name, names](const py::kwargs& keywords) {
                  return from_keywords(type_name, names, keywords);
                }),
                doc.c_str());
    }
    type_.def("__repr__",
              [type_name, names](const py::object& self) { return repr(type_name, names, self); });
    type_.def("__eq__", [names](const py::object& self, const py::object& other) -> py::object {
      if (!py::isinstance<T>(other)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
      return py::bool_(equal(names, self, other));
    });
    type_.attr("__hash__") = py::none();
    type_.def("__copy__", [](const T& self) { return T(self); });
    type_.def(
        "__deepcopy__", [](const T& self, const py::object& /*memo*/) { return T(self); }, py::arg("memo"));
    type_.def_static(
        "fields", [names] { return py::typing::Tuple<py::str, py::ellipsis>(py::tuple(py::cast(*names))); },
        "The names of all fields, in order.");
    type_.def(
        "invalid_field",
        [](const T& self) -> std::optional<std::string> {
          const char* field = invalid_field(self);
          return field == nullptr ? std::nullopt : std::optional<std::string>(field);
        },
        "Name of the first field with an impossible value, or None.");
  }

  std::string name_;
  py::class_<T> type_;
  std::shared_ptr<std::vector<std::string>> names_;
  std::string signature_;
};

}  // namespace echofuse::bindings
