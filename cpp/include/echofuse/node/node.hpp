#pragma once

#include <array>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/link/messages.hpp"
#include "echofuse/node/scan/cfar.hpp"
#include "echofuse/node/scan/clutter.hpp"
#include "echofuse/node/scan/direct_path.hpp"
#include "echofuse/node/scan/noise_floor.hpp"
#include "echofuse/node/scan/pulse_integrator.hpp"
#include "echofuse/node/scan/range_clusters.hpp"
#include "echofuse/signal/alignment.hpp"
#include "echofuse/signal/envelope.hpp"

namespace echofuse::node {

/// Where delays are counted from.
enum class TimeZero : std::uint8_t {
  kDirectPath,  ///< the background's direct path, which took baseline / c (a bistatic node)
  kRecorded,    ///< first_sample_s is known (a monostatic node, one with a synchronised transmitter)
};

struct SensorRadarNodeConfig {
  std::int32_t node_id = 0;
  int n_samples = static_cast<int>(kMaxSamplesPerScan);  ///< [sample] of a scan, <= kMaxSamplesPerScan
  float sample_rate_hz = 16.384e9f;                      ///< [Hz]
  float first_sample_s = 0.0f;  ///< [s] delay of sample 0 after transmission, if recorded
  float baseline_m = 0.0f;      ///< [m] transmitter to receiver, 0 for a monostatic node
  TimeZero time_zero = TimeZero::kDirectPath;
  float delay_offset_s = 0.0f;   ///< [s] calibration, added to every delay
  float blind_zone_s = 1.5e-9f;  ///< [s] after the direct path's delay: not judged, >= 0
  PulseIntegratorConfig pulse_integrator;
  signal::EnvelopeConfig envelope;
  DirectPathConfig direct_path;
  signal::AlignmentConfig alignment;
  ClutterConfig clutter;
  CfarConfig cfar;
  NoiseFloorConfig noise_floor;
  RangeClusterConfig range_clusters;
};

/// The first impossible field; of a stage that is impossible by itself only the stage's name.
const char* invalid_field(const SensorRadarNodeConfig& config);

/// What happened since configure(). Nothing is dropped uncounted.
struct SensorRadarNodeCounters {
  std::uint32_t scans = 0;                 ///< integrated scans processed
  std::uint32_t rejected_scans = 0;        ///< wrong length, not finite
  std::uint32_t learning_scans = 0;        ///< went into the background, so nothing was reported
  std::uint32_t direct_path_missing = 0;   ///< not found although delays count from it
  std::uint32_t alignment_doubts = 0;      ///< the direct path jumped further than the alignment searches
  std::uint32_t undetectable_scans = 0;    ///< too few samples between blind zone and end
  std::uint32_t truncated_detections = 0;  ///< dropped because the report was full
};

/// A node of the pipeline `sensor_radar`: one raw scan in, the delays of echoes from people out
/// (sensor-radar paper, Sec. IV). Bistatic (shared transmitter) or monostatic; the background comes from
/// empty-room scans or is learnt from the first scans.
/// Reference: python/echofuse/reference/node/node.py
class SensorRadarNode {
 public:
  /// Forgets background and counters. kInvalidConfig: the earlier configuration stays in force.
  Status configure(const SensorRadarNodeConfig& config);

  /// Forgets the background and what scans left behind; counters stay.
  void reset();

  /// One integrated scan of the empty room, (n_samples,) [count]: aligned to those before it and averaged
  /// into the background, in place of what was learnt. All of them before the first process() that shall
  /// report.
  Status set_empty_room(Span<const float> scan);

  /// scan: (n_samples,) [count], one pulse response if several make a scan; magnitudes up to 1e12.
  /// kOk: out is the report on a scan, if report_ready(). kTruncated: it holds the heaviest detections.
  /// kInvalidInput (counted): nothing changed, out is empty.
  Status process(Span<const float> scan, std::int64_t time_us, link::Detections& out);

  /// The last process() completed a scan.
  bool report_ready() const { return report_ready_; }

  /// The background is known, so that scans give detections.
  bool ready() const;

  void set_tap_sink(const TapSink& sink) { taps_ = sink; }
  const SensorRadarNodeCounters& counters() const { return counters_; }

 private:
  struct Range {  ///< [sample] first and one past the last
    int first = 0;
    int last = 0;
  };
  using Scan = std::array<float, kMaxSamplesPerScan>;

  bool usable(Span<const float> scan) const;
  DirectPath find_direct_path(Span<const float> envelope) const;
  signal::Alignment align(Span<const float> envelope, const DirectPath& direct_path);
  Range compared_range() const;
  void learn_reference(Span<const float> envelope, float shift_samples);
  void remove_clutter(Span<const float> scan, float shift_samples);
  Range usable_range(float shift_samples) const;
  void detect(Range range);
  Status report(link::Detections& out);
  float delay_s(float position_samples) const;
  void tap_direct_path(const DirectPath& direct_path) const;
  void tap_alignment(const signal::Alignment& alignment) const;
  void tap_clusters(Span<const std::uint8_t> decisions);
  Span<float> cut(Scan& scan) { return {scan.data(), static_cast<std::size_t>(config_.n_samples)}; }

  bool configured_ = false;
  bool report_ready_ = false;
  SensorRadarNodeConfig config_;
  SensorRadarNodeCounters counters_;
  TapSink taps_;

  PulseIntegrator pulse_integrator_;
  signal::Envelope envelope_;
  DirectPathSearcher direct_path_;
  signal::Aligner aligner_;
  ClutterFilter clutter_;
  CfarDetector cfar_;
  NoiseFloor noise_floor_;
  RangeClusterer range_clusterer_;

  int n_reference_ = 0;              ///< scans averaged into the reference envelope
  Range compared_;                   ///< of the reference envelope, by the alignment
  int n_empty_room_ = 0;             ///< of which empty-room ones
  float last_shift_samples_ = 0.0f;  ///< [sample] of the last scan
  DirectPath background_direct_path_;
  std::uint32_t frame_ = 0;

  Scan reference_envelope_{};  ///< what scans are aligned to
  Scan amplitude_{};           ///< a scan's envelope, then the rectified residual
  Scan work_{};                ///< the aligned scan or envelope, then the threshold
  std::array<std::uint8_t, kMaxSamplesPerScan> decisions_{};
  BoundedVector<RangeCluster, kMaxClustersPerScan> clusters_;
};

static_assert(4 * kMaxClustersPerScan <= kMaxSamplesPerScan,
              "the clusters' tap is prepared in a scan's place");

static_assert(sizeof(SensorRadarNode) <= 80 * 1024, "a node's RAM budget");

}  // namespace echofuse::node
