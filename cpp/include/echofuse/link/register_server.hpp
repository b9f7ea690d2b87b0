#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/span.hpp"

namespace echofuse::link {

/// How a member of a structure reads and writes as uavcan.register.Value.
enum class RegisterType : std::uint8_t {
  kBit,        ///< bool
  kNatural8,   ///< an enumeration or std::uint8_t
  kNatural16,  ///< std::uint16_t
  kNatural32,  ///< std::uint32_t
  kNatural64,  ///< std::uint64_t
  kInteger32,  ///< std::int32_t, int
  kReal32,     ///< float, `count` of them in a row
  kString,     ///< const char*, never written
};

/// One register, or `repeat` of them, `stride` bytes apart: '#' in the name then stands for 0, 1, ...
struct RegisterField {
  const char* name;
  RegisterType type;
  std::uint16_t offset;  ///< [byte] from the beginning of the structure
  std::uint8_t count = 1;
  std::uint8_t repeat = 1;
  std::uint16_t stride = 0;
  bool writable = true;
};

template <class T>
constexpr RegisterType register_type() {
  static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, const char*>);
  static_assert(!(std::is_integral_v<T> && std::is_signed_v<T>) || sizeof(T) == 4);
  static_assert(!std::is_enum_v<T> || sizeof(T) == 1);
  static_assert(!std::is_same_v<T, double>);
  if constexpr (std::is_same_v<T, bool>)
    return RegisterType::kBit;
  else if constexpr (std::is_same_v<T, float>)
    return RegisterType::kReal32;
  else if constexpr (std::is_same_v<T, const char*>)
    return RegisterType::kString;
  else if constexpr (sizeof(T) == 1)
    return RegisterType::kNatural8;
  else if constexpr (std::is_signed_v<T>)
    return RegisterType::kInteger32;
  else if constexpr (sizeof(T) == 2)
    return RegisterType::kNatural16;
  else
    return sizeof(T) == 4 ? RegisterType::kNatural32 : RegisterType::kNatural64;
}

/// A member of a structure, also of one within it, under its own name: ECHOFUSE_REGISTER(NodeConfig, cfar.global_factor)
#define ECHOFUSE_REGISTER(Structure, member) ECHOFUSE_REGISTER_AS(Structure, member, #member)
#define ECHOFUSE_REGISTER_AS(Structure, member, name)                                  \
  ::echofuse::link::RegisterField {                                                    \
    name,                                                                              \
        ::echofuse::link::register_type<                                               \
            std::remove_reference_t<decltype((std::declval<Structure&>().member))>>(), \
        static_cast<std::uint16_t>(offsetof(Structure, member))                        \
  }

/// Fields of one structure, wherever that lies.
struct RegisterTable {
  Span<const RegisterField> fields;
  void* structure = nullptr;
};

/// Answers uavcan.register.List and .Access over tables of fields. It reads and writes the structures in place and judges
/// no value: their owner stages them, and says by a register of its own when they shall take force.
class RegisterServer {
 public:
  /// False when there is no room for one more table. The fields outlive the server.
  [[nodiscard]] bool add(const RegisterTable& table) { return tables_.try_push_back(table); }

  /// Answers a request; the answer's length in `out`, or 0 when the request is none.
  std::size_t list(Span<const std::uint8_t> request, Span<std::uint8_t> out) const;
  std::size_t access(Span<const std::uint8_t> request, std::int64_t now_us, Span<std::uint8_t> out);

  std::uint32_t writes() const { return writes_; }  ///< done
  std::uint32_t refused_writes() const {
    return refused_writes_;
  }  ///< of another type or size, or not writable

 private:
  struct Place {
    const RegisterField* field = nullptr;
    std::uint8_t* value = nullptr;
    unsigned index = 0;  ///< among the repeated ones
  };

  Place at(std::size_t index) const;
  Place find(Span<const std::uint8_t> name) const;

  BoundedVector<RegisterTable, 4> tables_;
  std::uint32_t writes_ = 0;
  std::uint32_t refused_writes_ = 0;
};

}  // namespace echofuse::link
