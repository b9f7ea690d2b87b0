#include "config_binder.hpp"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace echofuse::bindings {
namespace {

void* at(void* config, const ConfigField& field) { return static_cast<char*>(config) + field.offset; }

void set_or_refuse(void* config, const ConfigField& field, const std::string& type_name,
                   const py::handle& value) {
  try {
    field.set(at(config, field), value);
  } catch (const py::cast_error&) {
    throw py::type_error(type_name + "." + field.name + " cannot be " +
                         py::cast<std::string>(py::repr(value)));
  }
}

}  // namespace

std::string text_of(const py::handle& value) {
  if (!py::isinstance<py::float_>(value)) return py::cast<std::string>(py::repr(value));
  const auto number = py::cast<float>(value);
  char text[32];
  for (int digits = 6; digits <= 9; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, static_cast<double>(number));
    if (std::strtof(text, nullptr) == number) break;
  }
  return py::cast<std::string>(py::repr(py::float_(std::strtod(text, nullptr))));
}

ErasedConfig::ErasedConfig(py::object type, void* (*address_of)(const py::handle&),
                           py::object (*copy)(const py::handle&),
                           const char* (*invalid_field_of)(const void*))
    : type_(std::move(type)),
      name_(py::cast<std::string>(type_.attr("__name__"))),
      full_name_(py::cast<std::string>(type_.attr("__module__")) + "." + name_),
      address_of_(address_of),
      copy_(copy),
      invalid_field_of_(invalid_field_of) {}

void ErasedConfig::add_field(ConfigField field, const char* doc) {
  py::options options;
  options.disable_function_signatures();
  const std::string getter_doc = "(self: " + full_name_ + ") -> " + field.type_text + "\n\n" + doc;
  const std::string setter_doc = "(self: " + full_name_ + ", value: " + field.type_text + ") -> None\n";

  const py::cpp_function getter(
      [field, address_of = address_of_](const py::object& self) {
        return field.get(at(address_of(self), field), self);
      },
      py::is_method(type_), getter_doc.c_str());
  const py::cpp_function setter(
      [field, address_of = address_of_, type_name = name_](const py::object& self, const py::object& value) {
        set_or_refuse(address_of(self), field, type_name, value);
      },
      py::is_method(type_), setter_doc.c_str());
  const py::handle property(reinterpret_cast<PyObject*>(&PyProperty_Type));
  type_.attr(field.name.c_str()) = property(getter, setter, py::none(), doc);
  fields_->push_back(std::move(field));
}

std::string ErasedConfig::init_doc() const {
  std::string text = "__init__(self: " + full_name_;
  if (!fields_->empty()) text += ", *";
  for (const ConfigField& field : *fields_)
    text += ", " + field.name + ": " + field.type_text + " = " + field.default_text;
  return text + ") -> None\n";
}

void ErasedConfig::set_from_keywords(void* address, const Fields& fields, const std::string& type_name,
                                     const py::kwargs& keywords) {
  for (const auto& item : keywords) {
    const auto key = py::cast<std::string>(item.first);
    const ConfigField* found = nullptr;
    for (const ConfigField& field : fields)
      if (field.name == key) found = &field;
    if (found == nullptr) throw py::type_error(type_name + " has no field '" + key + "'");
    set_or_refuse(address, *found, type_name, item.second);
  }
}

void ErasedConfig::add_methods() {
  const std::shared_ptr<const Fields> fields = fields_;
  const auto method = [this](const char* name, auto function, const std::string& signature,
                             const char* doc = "") {
    type_.attr(name) = py::cpp_function(function, py::name(name), py::is_method(type_),
                                        (name + signature + "\n\n" + doc).c_str());
  };
  py::options options;
  options.disable_function_signatures();
  const std::string self_text = "(self: " + full_name_;

  method(
      "__repr__",
      [fields, name = name_](const py::object& self) {
        std::string text = name + "(";
        for (const ConfigField& field : *fields) {
          if (text.back() != '(') text += ", ";
          text += field.name + "=" + text_of(self.attr(field.name.c_str()));
        }
        return text + ")";
      },
      self_text + ") -> str");
  method(
      "__eq__",
      [fields](const py::object& self, const py::object& other) -> py::object {
        if (!py::type::of(self).is(py::type::of(other)))
          return py::reinterpret_borrow<py::object>(Py_NotImplemented);
        for (const ConfigField& field : *fields)
          if (!self.attr(field.name.c_str()).equal(other.attr(field.name.c_str()))) return py::bool_(false);
        return py::bool_(true);
      },
      self_text + ", other: object) -> bool");
  type_.attr("__hash__") = py::none();
  method(
      "__copy__", [copy = copy_](const py::object& self) { return copy(self); },
      self_text + ") -> " + full_name_);
  method(
      "__deepcopy__",
      [copy = copy_](const py::object& self, const py::object& /*memo*/) { return copy(self); },
      self_text + ", memo: object) -> " + full_name_);
  method(
      "invalid_field",
      [address_of = address_of_, invalid = invalid_field_of_](const py::object& self) -> py::object {
        const char* field = invalid(address_of(self));
        if (field == nullptr) return py::none();
        return py::str(field);
      },
      self_text + ") -> str | None", "Name of the first field with an impossible value, or None.");

  py::tuple names(fields->size());
  for (std::size_t i = 0; i < fields->size(); ++i) names[i] = (*fields)[i].name;
  type_.attr("fields") =
      py::staticmethod(py::cpp_function([names] { return names; }, py::name("fields"), py::scope(type_),
                                        "fields() -> tuple[str, ...]\n\nThe names of all fields, in order."));
}

}  // namespace echofuse::bindings
