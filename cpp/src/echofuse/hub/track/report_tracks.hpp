#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/eigen.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

/// A track as the message has it: all of z is 0 in the plane.
template <int kDimension>
link::Track to_message(std::int32_t id, link::TrackState state, std::int32_t frames_since_update,
                       const estimation::ConstantVelocityFilter<kDimension>& filter) {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero();
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  position.head<kDimension>() = filter.position();
  velocity.head<kDimension>() = filter.velocity();
  covariance.topLeftCorner<kDimension, kDimension>() = filter.position_covariance();
  return {id,
          state,
          frames_since_update,
          position(0),
          position(1),
          position(2),
          velocity(0),
          velocity(1),
          velocity(2),
          covariance(0, 0),
          covariance(0, 1),
          covariance(1, 1),
          covariance(0, 2),
          covariance(1, 2),
          covariance(2, 2)};
}

/// The tap kTracks: (n, 7) id, state, x, y, vx, vy, frames since the last update; in space kSpatialTracks:
/// (n, 9) id, state, x, y, z, vx, vy, vz, frames since the last update.
template <int kDimension>
void show_tracks(const TapSink& sink, const link::Tracks& tracks) {
  constexpr TapId kTap = kDimension == 2 ? TapId::kTracks : TapId::kSpatialTracks;
  if (!sink.wants(kTap)) return;
  constexpr std::size_t kColumns = 2 * kDimension + 3;
  std::array<float, kMaxTracks * kColumns> rows{};
  std::size_t n = 0;
  for (const link::Track& track : tracks.tracks) {
    rows[n++] = static_cast<float>(track.id);
    rows[n++] = static_cast<float>(static_cast<int>(track.state));
    const std::array<float, 3> position_m{track.x_m, track.y_m, track.z_m};
    const std::array<float, 3> velocity_mps{track.vx_mps, track.vy_mps, track.vz_mps};
    for (std::size_t axis = 0; axis < kDimension; ++axis) rows[n++] = position_m[axis];
    for (std::size_t axis = 0; axis < kDimension; ++axis) rows[n++] = velocity_mps[axis];
    rows[n++] = static_cast<float>(track.frames_since_update);
  }
  sink(kTap, {rows.data(), n});
}

}  // namespace echofuse::hub
