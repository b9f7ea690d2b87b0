#include "echofuse/hub/track/kalman_tracker.hpp"

#include <algorithm>

#include "show_tracks.hpp"

namespace echofuse::hub {

Status KalmanTracker::configure(TrackManagerConfig config) {
  config.update = TrackUpdate::kKalman;
  const Status status = manager_.configure(config);
  if (status == Status::kOk) measurement_variance_m2_ = config.measurement_std_m * config.measurement_std_m;
  return status;
}

void KalmanTracker::reset() { manager_.reset(); }

Status KalmanTracker::process(Span<const Eigen::Vector2f> measurements, float dt_s, link::Tracks& tracks) {
  BoundedVector<TrackEstimate, kMaxPointsPerFrame> points;
  for (const Eigen::Vector2f& z : measurements.first(std::min(measurements.size(), kMaxPointsPerFrame)))
    ECHOFUSE_CHECK(points.try_push_back(
        {z.x(), z.y(), 0.0f, 0.0f, measurement_variance_m2_, 0.0f, measurement_variance_m2_}));
  const Status status = manager_.process(points.span(), dt_s, tracks);
  if (status != Status::kOk && status != Status::kTruncated) return status;
  show_tracks(sink_, tracks);
  return measurements.size() > kMaxPointsPerFrame ? Status::kTruncated : status;
}

}  // namespace echofuse::hub
