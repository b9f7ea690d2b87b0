#pragma once

#include <cstdint>

namespace echofuse {

/// What a stage says of one call. Small and shared: programmer errors are ECHOFUSE_CHECK, bad data is a
/// Status.
enum class [[nodiscard]] Status : std::uint8_t{
    kOk,             ///< done, outputs complete
    kTruncated,      ///< a capacity was reached: what the outputs hold is valid, something was left out
    kNotConfigured,  ///< configure() has not succeeded yet; outputs empty
    kInvalidConfig,  ///< the configuration is impossible; the earlier one stays in force
    kInvalidInput,   ///< the data cannot be used (length, order, not finite); outputs empty
};

/// The code's name as Python shows it ("ok", "truncated", ...); "unknown" for a value that is no code.
const char* name(Status status);

}  // namespace echofuse
