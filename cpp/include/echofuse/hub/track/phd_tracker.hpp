#pragma once

#include <cstdint>

#include "echofuse/core/eigen.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/estimation/mixture_em.hpp"
#include "echofuse/hub/track/phd_filter.hpp"
#include "echofuse/hub/track/track_manager.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

/// The paper's tracker, sections V-D and V-E: particle PHD filter, its peaks by expectation-maximisation,
/// tracks. Reference: python/echofuse/reference/hub/track/phd_tracker.py
class PhdTracker {
 public:
  /// Also resets. kInvalidConfig: all earlier configurations and the state stay in force.
  Status configure(const PhdConfig& phd, const estimation::MixtureConfig& em,
                   const TrackManagerConfig& tracks);
  void reset();

  /// measurements: (m,) [m]. dt_s: [s] > 0 since the last frame.
  /// Shows the taps kPredicted, kUpdated, kPeaks, kResampled, kTracks.
  /// kInvalidInput: a measurement is not finite or dt_s is not positive; nothing changes.
  /// kTruncated: only the first kMaxPointsPerFrame were used, or a track could not begin.
  Status process(Span<const Eigen::Vector2f> measurements, float dt_s, link::Tracks& tracks);

  void set_tap_sink(const TapSink& sink) { sink_ = sink; }
  const PhdFilter& phd() const { return phd_; }
  const TrackManager<2>& manager() const { return manager_; }

 private:
  void show_peaks() const;

  PhdFilter phd_;
  estimation::MixtureFitter fitter_;
  TrackManager<2> manager_;
  estimation::Mixture mixture_;
  TapSink sink_;
};

}  // namespace echofuse::hub
