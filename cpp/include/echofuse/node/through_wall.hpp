#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/link/messages.hpp"
#include "echofuse/node/scan/clutter.hpp"
#include "echofuse/node/scan/gaussian_cfar.hpp"
#include "echofuse/node/scan/leading_edge.hpp"
#include "echofuse/node/scan/target_traces.hpp"
#include "echofuse/node/scan/time_zero.hpp"
#include "echofuse/node/scan/weak_signal.hpp"
#include "echofuse/signal/envelope.hpp"

namespace echofuse::node {

struct ThroughWallNodeConfig {
  std::int32_t node_id = 0;
  int n_samples = 511;  ///< [sample] of a response: the sequence's length, 3 to kMaxResponseSamples
  /// [sample] of a turned response, from its beginning: all that the stages behind time zero see, so that a long sequence
  /// costs them nothing where a room is short. Their last weak_signal.noise_samples, behind the blind zone, hold noise
  /// alone. 0, or more than n_samples: all. In all cases at most kMaxSamplesPerScan are left.
  int kept_samples = 0;
  float sample_rate_hz = 4.5e9f;  ///< [Hz] the sequence's clock
  float baseline_m = 0.4f;        ///< [m] transmitter to receiver: the way of the cross-talk
  float delay_offset_s = 0.0f;    ///< [s] calibration, added to every delay
  /// [s] after the cross-talk's delay, >= 0: a trace that begins within is not reported. Nobody is nearer than the wall's
  /// far face: 1.44 m there and back from 0.24 m before 0.24 m of brick, less 0.4 m of baseline, and less 0.23 m, for an
  /// edge lies up to 3.5 samples before its peak.
  float blind_zone_s = 2.7e-9f;
  float max_delay_s = 0.0f;       ///< [s] a trace that begins later is not reported; 0: all are
  float full_scale_count = 0.0f;  ///< [count] magnitude that says the receiver is saturated; 0: not known
  int saturated_samples = 2;      ///< [sample] at full scale that a response may have and be trusted, >= 0
  TimeZeroConfig time_zero;
  /// Its learning_scans settle the exponential average, which at first still holds the people of the first responses.
  ClutterConfig clutter = {ClutterMethod::kExponentialAverage, 0.95f, 8};
  signal::EnvelopeConfig envelope;
  WeakSignalConfig weak_signal;
  GaussianCfarConfig gaussian_cfar;
  TargetTraceConfig target_traces;
  LeadingEdgeConfig leading_edge;
};

/// The first impossible field; of a stage that is impossible by itself only the stage's name.
const char* invalid_field(const ThroughWallNodeConfig& config);

/// What happened since configure(). Nothing is dropped uncounted: each of the responses is in one of the next four, or was
/// judged.
struct ThroughWallNodeCounters {
  std::uint32_t responses = 0;             ///< processed, each with a report
  std::uint32_t dead_responses = 0;        ///< the same value in every sample
  std::uint32_t saturated_responses = 0;   ///< too many samples at full scale
  std::uint32_t cross_talk_missing = 0;    ///< time zero neither known nor being learnt
  std::uint32_t settling_responses = 0;    ///< time zero or background still being learnt
  std::uint32_t rejected_responses = 0;    ///< wrong length, not finite: no report
  std::uint32_t time_zero_moved = 0;       ///< switched on anew: all that had been learnt was void
  std::uint32_t truncated_detections = 0;  ///< dropped because the report was full
};

/// A node of the pipeline `through_wall_2d`: the response of one receiver of an M-sequence radar in, the delays of people's
/// echoes out (through-wall paper, Sec. 2 and 3). A dead or saturated response teaches the stages nothing.
/// Reference: python/echofuse/reference/node/through_wall.py
class ThroughWallNode {
 public:
  /// Forgets all and sets the counters to 0. kInvalidConfig: the earlier configuration stays in force.
  Status configure(const ThroughWallNodeConfig& config);

  /// Forgets time zero, background and noise; counters stay.
  void reset();

  /// response: (n_samples,) [count], beginning at any chip; magnitudes up to 1e12. kOk: out is the report on it.
  /// kTruncated: it holds the heaviest detections. kInvalidInput (counted): nothing changed, out is empty.
  Status process(Span<const float> response, std::int64_t time_us, link::Detections& out);

  /// The last process() gave a report.
  bool report_ready() const { return report_ready_; }

  /// Time zero and background are known, so that responses give detections.
  bool ready() const { return clutter_.ready(); }

  void set_tap_sink(const TapSink& sink) { taps_ = sink; }
  const ThroughWallNodeCounters& counters() const { return counters_; }

 private:
  using Kept = std::array<float, kMaxSamplesPerScan>;

  bool usable(Span<const float> response) const;
  bool trusted(Span<const float> response);
  TimeZeroResult find_time_zero(Span<const float> response);
  bool subtract_background(bool found);
  void detect(bool judges);
  Status report(const TimeZeroResult& time_zero, Status status, link::Detections& out);
  float delay_s(float toa_samples, const TimeZeroResult& time_zero) const;
  void tap_time_zero(const TimeZeroResult& time_zero) const;
  void tap_decisions();
  void tap_traces(TapId tap) const;
  Span<float> cut(Kept& samples) { return {samples.data(), n_kept_}; }

  bool configured_ = false;
  bool report_ready_ = false;
  ThroughWallNodeConfig config_;
  ThroughWallNodeCounters counters_;
  TapSink taps_;

  TimeZeroFinder time_zero_;
  ClutterFilter clutter_;
  signal::Envelope envelope_;
  WeakSignalEnhancer weak_signal_;
  GaussianCfarDetector gaussian_cfar_;
  TargetTracer target_traces_;
  LeadingEdge leading_edge_;

  std::size_t n_kept_ = 0;  ///< [sample] of a turned response
  int n_learning_ = 0;      ///< responses since time zero was last void, no further than it is learnt
  std::uint32_t frame_ = 0;

  Kept work_{};       ///< the response, turned, then subtracted, then enhanced
  Kept amplitude_{};  ///< envelope of what is subtracted
  std::array<std::uint8_t, kMaxSamplesPerScan> decisions_{};
  BoundedVector<TargetTrace, kMaxClustersPerScan> traces_;
};

static_assert(sizeof(ThroughWallNode) <= 60 * 1024, "a node's RAM budget");

}  // namespace echofuse::node
