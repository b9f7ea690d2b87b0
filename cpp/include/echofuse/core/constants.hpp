#pragma once

namespace echofuse {

inline constexpr float kSpeedOfLight_mps = 299792458.0f;    ///< [m/s] exact by definition of the metre
inline constexpr float kBoltzmann_J_per_K = 1.380649e-23f;  ///< [J/K] exact by definition of the kelvin
inline constexpr float kPi = 3.14159265358979323846f;       ///< [rad] half a turn
inline constexpr float kSecondsPerMicrosecond =
    1e-6f;  ///< [s/us] times cross boundaries as integer microseconds

}  // namespace echofuse
