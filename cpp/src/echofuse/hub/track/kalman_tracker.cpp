#include "echofuse/hub/track/kalman_tracker.hpp"

#include <algorithm>

#include "report_tracks.hpp"

namespace echofuse::hub {

template <int kDimension>
Status KalmanTracker<kDimension>::configure(TrackManagerConfig config) {
  config.update = TrackUpdate::kKalman;
  const Status status = manager_.configure(config);
  if (status == Status::kOk) measurement_variance_m2_ = config.measurement_std_m * config.measurement_std_m;
  return status;
}

template <int kDimension>
void KalmanTracker<kDimension>::reset() {
  manager_.reset();
}

template <int kDimension>
Status KalmanTracker<kDimension>::process(Span<const Eigen::Matrix<float, kDimension, 1>> measurements,
                                          float dt_s, link::Tracks& tracks) {
  using Vector = Eigen::Matrix<float, kDimension, 1>;
  using Square = Eigen::Matrix<float, kDimension, kDimension>;
  BoundedVector<TrackEstimate<kDimension>, kMaxPointsPerFrame> points;
  for (const Vector& z : measurements.first(std::min(measurements.size(), kMaxPointsPerFrame)))
    ECHOFUSE_CHECK(points.try_push_back({z, Vector::Zero(), measurement_variance_m2_ * Square::Identity()}));
  const Status status = manager_.process(points.span(), dt_s, tracks);
  if (status != Status::kOk && status != Status::kTruncated) return status;
  show_tracks<kDimension>(sink_, tracks);
  return measurements.size() > kMaxPointsPerFrame ? Status::kTruncated : status;
}

template class KalmanTracker<2>;
template class KalmanTracker<3>;

}  // namespace echofuse::hub
