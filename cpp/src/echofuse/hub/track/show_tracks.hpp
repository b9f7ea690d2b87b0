#pragma once

#include <array>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

/// The tap kTracks: (n, 7) id, state, x, y, vx, vy, frames since the last update.
inline void show_tracks(const TapSink& sink, const link::Tracks& tracks) {
  if (!sink.wants(TapId::kTracks)) return;
  std::array<float, kMaxTracks * 7> rows{};
  std::size_t n = 0;
  for (const link::Track& track : tracks.tracks) {
    for (const float value :
         {static_cast<float>(track.id), static_cast<float>(static_cast<int>(track.state)), track.x_m,
          track.y_m, track.vx_mps, track.vy_mps, static_cast<float>(track.frames_since_update)})
      rows[n++] = value;
  }
  sink(TapId::kTracks, {rows.data(), n});
}

/// The tap kSpatialTracks: (n, 9) id, state, x, y, z, vx, vy, vz, frames since the last update.
inline void show_spatial_tracks(const TapSink& sink, const link::Tracks& tracks) {
  if (!sink.wants(TapId::kSpatialTracks)) return;
  std::array<float, kMaxTracks * 9> rows{};
  std::size_t n = 0;
  for (const link::Track& track : tracks.tracks) {
    for (const float value : {static_cast<float>(track.id), static_cast<float>(static_cast<int>(track.state)),
                              track.x_m, track.y_m, track.z_m, track.vx_mps, track.vy_mps, track.vz_mps,
                              static_cast<float>(track.frames_since_update)})
      rows[n++] = value;
  }
  sink(TapId::kSpatialTracks, {rows.data(), n});
}

}  // namespace echofuse::hub
