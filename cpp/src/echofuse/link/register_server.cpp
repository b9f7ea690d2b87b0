#include "echofuse/link/register_server.hpp"

#include <algorithm>
#include <cstring>

#include "uavcan/_register/Access_1_0.h"
#include "uavcan/_register/List_1_0.h"

namespace echofuse::link {
namespace {

using Value = uavcan_register_Value_1_0;
using Name = uavcan_register_Name_1_0;

/// Writes a field's name, with its number in place of '#'.
void write_name(const RegisterField& field, unsigned index, Name& out) {
  std::size_t size = 0;
  const auto put = [&](char c) {
    if (size < uavcan_register_Name_1_0_name_ARRAY_CAPACITY_)
      out.name.elements[size++] = static_cast<std::uint8_t>(c);
  };
  for (const char* c = field.name; *c != '\0'; ++c) {
    if (*c != '#' || field.repeat == 1) {
      put(*c);
      continue;
    }
    if (index >= 10) put(static_cast<char>('0' + index / 10));
    put(static_cast<char>('0' + index % 10));
  }
  out.name.count = size;
}

/// Elements of an array in the value, or of the array's elements in the field: both are copied byte by byte.
template <class Array>
void read_array(const std::uint8_t* from, std::size_t count, Array& array) {
  array.value.count = count;
  std::memcpy(array.value.elements, from, count * sizeof array.value.elements[0]);
}

template <class Array>
bool write_array(const Array& array, std::size_t count, std::uint8_t* to) {
  if (array.value.count != count) return false;
  std::memcpy(to, array.value.elements, count * sizeof array.value.elements[0]);
  return true;
}

void read_string(const std::uint8_t* from, uavcan_primitive_String_1_0& out) {
  const char* text = nullptr;
  std::memcpy(&text, from, sizeof text);
  const std::size_t size = text == nullptr ? 0 : std::min<std::size_t>(std::strlen(text), 256);
  out.value.count = size;
  std::copy_n(text, size, out.value.elements);
}

void read_value(const RegisterField& field, const std::uint8_t* from, Value& out) {
  switch (field.type) {
    case RegisterType::kBit:
      uavcan_register_Value_1_0_select_bit_(&out);
      out.bit.value.count = 1;
      out.bit.value.bitpacked[0] = *from != 0 ? 1 : 0;
      break;
    case RegisterType::kNatural8:
      uavcan_register_Value_1_0_select_natural8_(&out);
      return read_array(from, field.count, out.natural8);
    case RegisterType::kNatural16:
      uavcan_register_Value_1_0_select_natural16_(&out);
      return read_array(from, field.count, out.natural16);
    case RegisterType::kNatural32:
      uavcan_register_Value_1_0_select_natural32_(&out);
      return read_array(from, field.count, out.natural32);
    case RegisterType::kNatural64:
      uavcan_register_Value_1_0_select_natural64_(&out);
      return read_array(from, field.count, out.natural64);
    case RegisterType::kInteger32:
      uavcan_register_Value_1_0_select_integer32_(&out);
      return read_array(from, field.count, out.integer32);
    case RegisterType::kReal32:
      uavcan_register_Value_1_0_select_real32_(&out);
      return read_array(from, field.count, out.real32);
    case RegisterType::kString:
      uavcan_register_Value_1_0_select_string_(&out);
      return read_string(from, out._string);
  }
}

/// False when the value has another type or size than the field.
bool write_value(const RegisterField& field, const Value& value, std::uint8_t* to) {
  switch (field.type) {
    case RegisterType::kBit:
      if (!uavcan_register_Value_1_0_is_bit_(&value) || value.bit.value.count != 1) return false;
      *to = value.bit.value.bitpacked[0] & 1U;
      return true;
    case RegisterType::kNatural8:
      return uavcan_register_Value_1_0_is_natural8_(&value) && write_array(value.natural8, field.count, to);
    case RegisterType::kNatural16:
      return uavcan_register_Value_1_0_is_natural16_(&value) && write_array(value.natural16, field.count, to);
    case RegisterType::kNatural32:
      return uavcan_register_Value_1_0_is_natural32_(&value) && write_array(value.natural32, field.count, to);
    case RegisterType::kNatural64:
      return uavcan_register_Value_1_0_is_natural64_(&value) && write_array(value.natural64, field.count, to);
    case RegisterType::kInteger32:
      return uavcan_register_Value_1_0_is_integer32_(&value) && write_array(value.integer32, field.count, to);
    case RegisterType::kReal32:
      return uavcan_register_Value_1_0_is_real32_(&value) && write_array(value.real32, field.count, to);
    case RegisterType::kString:
      return false;
  }
  return false;
}

}  // namespace

RegisterServer::Place RegisterServer::at(std::size_t index) const {
  for (const RegisterTable& table : tables_) {
    for (const RegisterField& field : table.fields) {
      if (index < field.repeat) {
        const std::size_t offset = field.offset + index * field.stride;
        return {&field, static_cast<std::uint8_t*>(table.structure) + offset, static_cast<unsigned>(index)};
      }
      index -= field.repeat;
    }
  }
  return {};
}

RegisterServer::Place RegisterServer::find(Span<const std::uint8_t> name) const {
  Name candidate;
  for (std::size_t index = 0;; ++index) {
    const Place place = at(index);
    if (place.field == nullptr) return place;
    write_name(*place.field, place.index, candidate);
    if (candidate.name.count == name.size() && std::equal(name.begin(), name.end(), candidate.name.elements))
      return place;
  }
}

std::size_t RegisterServer::list(Span<const std::uint8_t> request, Span<std::uint8_t> out) const {
  uavcan_register_List_Request_1_0 asked{};
  std::size_t size = request.size();
  if (uavcan_register_List_Request_1_0_deserialize_(&asked, request.data(), &size) < 0) return 0;
  uavcan_register_List_Response_1_0 answer{};
  const Place place = at(asked.index);
  if (place.field != nullptr) write_name(*place.field, place.index, answer.name);
  size = out.size();
  const bool fits = uavcan_register_List_Response_1_0_serialize_(&answer, out.data(), &size) >= 0;
  return fits ? size : 0;
}

std::size_t RegisterServer::access(Span<const std::uint8_t> request, std::int64_t now_us,
                                   Span<std::uint8_t> out) {
  uavcan_register_Access_Request_1_0 asked{};
  std::size_t size = request.size();
  if (uavcan_register_Access_Request_1_0_deserialize_(&asked, request.data(), &size) < 0) return 0;
  uavcan_register_Access_Response_1_0 answer{};
  answer.timestamp.microsecond = static_cast<std::uint64_t>(now_us);
  uavcan_register_Value_1_0_select_empty_(&answer.value);
  const Place place = find({asked.name.name.elements, asked.name.name.count});
  if (!uavcan_register_Value_1_0_is_empty_(&asked.value)) {
    const bool done = place.field != nullptr && place.field->writable &&
                      write_value(*place.field, asked.value, place.value);
    ++(done ? writes_ : refused_writes_);
  }
  if (place.field != nullptr) {
    answer._mutable = place.field->writable;
    read_value(*place.field, place.value, answer.value);
  }
  size = out.size();
  const bool fits = uavcan_register_Access_Response_1_0_serialize_(&answer, out.data(), &size) >= 0;
  return fits ? size : 0;
}

}  // namespace echofuse::link
