#pragma once

#include <cstdint>

#include "echofuse/core/eigen.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/hub/track/track_manager.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

/// The baseline: a constant-velocity Kalman filter a track, global nearest neighbour (the assignment of least
/// total distance within the gates), and the same track states as after the PHD filter. In the plane or in
/// space. Reference: python/echofuse/reference/hub/track/kalman_tracker.py
template <int kDimension>
class KalmanTracker {
 public:
  /// config.update is taken as kKalman, whatever it says.
  Status configure(TrackManagerConfig config);
  void reset();

  /// measurements: (m,) [m]. dt_s: [s] > 0 since the last frame. Shows the tap kTracks or kSpatialTracks.
  /// kInvalidInput: a measurement is not finite or dt_s is not positive; nothing changes.
  /// kTruncated: only the first kMaxPointsPerFrame were used, or a track could not begin.
  Status process(Span<const Eigen::Matrix<float, kDimension, 1>> measurements, float dt_s,
                 link::Tracks& tracks);

  void set_tap_sink(const TapSink& sink) { sink_ = sink; }
  const TrackManager<kDimension>& manager() const { return manager_; }

 private:
  TrackManager<kDimension> manager_;
  float measurement_variance_m2_ = 0.0f;
  TapSink sink_;
};

}  // namespace echofuse::hub
