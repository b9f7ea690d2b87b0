#pragma once

/// Configurations for Python. Names are given once, defaults come from the C++ struct:
///
///   ConfigBinder<CfarConfig>(m, "CfarConfig", "Cell-averaging CFAR.")
///       .field("false_alarm_probability", &CfarConfig::false_alarm_probability, "per tested cell")
///       .field("guard_cells_per_side", &CfarConfig::guard_cells_per_side, "[bin]");
///
/// gives in Python a keyword-only constructor (an unknown keyword or a wrong type is a TypeError), attributes to
/// read and write (a bool is no number and None is no bool), repr, ==, copy, deepcopy; fields() -> tuple of names;
/// and invalid_field() -> the first field with an impossible value or None, from the C++ function
/// `const char* invalid_field(const CfarConfig&)` (nullptr when valid) that stands beside the struct.
///
/// Fields may be bool, integers, float, a bound enum, std::array of those, or another bound configuration; bind enums
/// and inner configurations first. The class is complete when the full expression ends. `.type()` is the py::class_,
/// for anything more.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace echofuse::bindings {

namespace py = pybind11;

/// One field, without its type: `address` is where it lies, `owner` the Python object that holds it.
struct ConfigField {
  std::string name;
  std::string type_text;     ///< as it reads in a stub
  std::string default_text;  ///< as it reads in a stub
  std::size_t offset;        ///< [byte] from the beginning of the configuration
  py::object (*get)(void* address, const py::handle& owner);
  void (*set)(void* address, const py::handle& value);  ///< throws py::cast_error
};

/// What is the same for every configuration: written, and compiled, once.
class ErasedConfig {
 public:
  using Fields = std::vector<ConfigField>;

  ErasedConfig(py::object type, void* (*address_of)(const py::handle&), py::object (*copy)(const py::handle&),
               const char* (*invalid_field_of)(const void*));

  void add_field(ConfigField field, const char* doc);
  void add_methods();

  /// The constructor's signature for help() and stubs.
  std::string init_doc() const;

  std::shared_ptr<const Fields> fields() const { return fields_; }

  /// Sets fields of the configuration at `address`; TypeError for an unknown name or a wrong type.
  static void set_from_keywords(void* address, const Fields& fields, const std::string& type_name,
                                const py::kwargs& keywords);

 private:
  py::object type_;
  std::string name_;
  std::string full_name_;  ///< with its module
  void* (*address_of_)(const py::handle&);
  py::object (*copy_)(const py::handle&);
  const char* (*invalid_field_of_)(const void*);
  std::shared_ptr<Fields> fields_ = std::make_shared<Fields>();
};

/// repr() of a field's value, floats with the fewest digits that make the same float32.
std::string text_of(const py::handle& value);

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

/// The value itself, or for an inner configuration a reference that keeps its owner alive.
template <class F>
py::object get_field(void* address, const py::handle& owner) {
  return py::cast(*static_cast<F*>(address), py::return_value_policy::reference_internal, owner);
}

/// A bool from a bool alone, a number from a number alone: pybind11 would take None and True for either.
template <class F>
void set_field(void* address, const py::handle& value) {
  if constexpr (std::is_arithmetic_v<F>) {
    if (py::isinstance<py::bool_>(value) != std::is_same_v<F, bool>) throw py::cast_error();
  }
  *static_cast<F*>(address) = py::cast<F>(value);
}

template <class T>
class ConfigBinder {
 public:
  ConfigBinder(py::module_& m, const char* name, const char* doc = "")
      : type_(m, name, doc), erased_(type_, &address_of, &copy, &invalid_field_of) {}
  ConfigBinder(const ConfigBinder&) = delete;
  ConfigBinder& operator=(const ConfigBinder&) = delete;
  ~ConfigBinder() noexcept(false) { finish(); }

  template <class F>
  ConfigBinder& field(const char* name, F T::*member, const char* doc = "") {
    T defaults{};
    F& value = defaults.*member;
    const auto offset = reinterpret_cast<const char*>(&value) - reinterpret_cast<const char*>(&defaults);
    const std::string default_text = std::is_arithmetic_v<F> ? text_of(py::cast(value)) : "...";
    erased_.add_field({name, FieldType<F>::text(), default_text, static_cast<std::size_t>(offset),
                       &get_field<F>, &set_field<F>},
                      doc);
    return *this;
  }

  py::class_<T>& type() { return type_; }

 private:
  static void* address_of(const py::handle& self) { return py::cast<T*>(self); }
  static py::object copy(const py::handle& self) { return py::cast(T(*py::cast<const T*>(self))); }
  static const char* invalid_field_of(const void* address) {
    return invalid_field(*static_cast<const T*>(address));
  }

  void finish() {
    const auto name = py::cast<std::string>(type_.attr("__name__"));
    py::options options;
    options.disable_function_signatures();
    type_.def(py::init([fields = erased_.fields(), name](const py::kwargs& keywords) {
                T made{};
                ErasedConfig::set_from_keywords(&made, *fields, name, keywords);
                return made;
              }),
              erased_.init_doc().c_str());
    erased_.add_methods();
  }

  py::class_<T> type_;
  ErasedConfig erased_;
};

}  // namespace echofuse::bindings
