#include "echofuse/hub/track/phd_tracker.hpp"

#include <array>
#include <cmath>

#include "report_tracks.hpp"

namespace echofuse::hub {
namespace {

bool is_finite(Span<const Eigen::Vector2f> measurements) {
  for (const Eigen::Vector2f& z : measurements)
    if (!z.allFinite()) return false;
  return true;
}

}  // namespace

Status PhdTracker::configure(const PhdConfig& phd, const estimation::MixtureConfig& em,
                             const TrackManagerConfig& tracks) {
  if (invalid_field(phd) != nullptr || invalid_field(em) != nullptr || invalid_field(tracks) != nullptr)
    return Status::kInvalidConfig;
  (void)phd_.configure(phd);
  (void)fitter_.configure(em);
  (void)manager_.configure(tracks);
  mixture_.components.clear();
  return Status::kOk;
}

void PhdTracker::reset() {
  phd_.reset();
  manager_.reset();
  mixture_.components.clear();
}

Status PhdTracker::process(Span<const Eigen::Vector2f> measurements, float dt_s, link::Tracks& tracks) {
  tracks.tracks.clear();
  if (!is_finite(measurements)) return Status::kInvalidInput;
  if (const Status status = phd_.predict(dt_s); status != Status::kOk) return status;
  sink_(TapId::kPredicted, estimation::as_rows(phd_.particles()));
  const Status updated = phd_.update(measurements);
  sink_(TapId::kUpdated, estimation::as_rows(phd_.particles()));

  Pcg32 random(phd_.peak_seed());
  (void)fitter_.process(phd_.persistent(), phd_.seeds(), phd_.number(), random, mixture_);
  show_peaks();
  BoundedVector<TrackEstimate<2>, kMaxTargets> peaks;
  for (const estimation::MixtureComponent& c : mixture_.components) {
    if (!(c.share > 0.0f)) continue;
    Eigen::Matrix2f covariance;
    covariance << c.covariance_xx_m2, c.covariance_xy_m2, c.covariance_xy_m2, c.covariance_yy_m2;
    ECHOFUSE_CHECK(peaks.try_push_back({{c.x_m, c.y_m}, {c.vx_mps, c.vy_mps}, covariance}));
  }

  (void)phd_.resample();
  sink_(TapId::kResampled, estimation::as_rows(phd_.particles()));
  const Status tracked = manager_.process(peaks.span(), dt_s, tracks);
  show_tracks<2>(sink_, tracks);
  return tracked == Status::kOk ? updated : tracked;
}

void PhdTracker::show_peaks() const {
  if (!sink_.wants(TapId::kPeaks)) return;
  std::array<float, kMaxTargets * 5> rows{};
  std::size_t n = 0;
  for (const estimation::MixtureComponent& c : mixture_.components)
    for (const float value : {c.x_m, c.y_m, c.vx_mps, c.vy_mps, c.share * phd_.mass()}) rows[n++] = value;
  sink_(TapId::kPeaks, {rows.data(), n});
}

}  // namespace echofuse::hub
