#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

enum class ClusterRepresentative : std::uint8_t {
  kLeadingEdge,  ///< where the first member's rise crosses the threshold: a person's echo trails a tail
  kMedian,       ///< the paper's: the middle member, the lower of two
};

struct RangeClusterConfig {
  float merge_distance_s =
      3.97e-9f;        ///< [s] clusters whose medians are closer become one (65 samples of 61 ps)
  int min_weight = 4;  ///< lighter clusters are dropped, >= 1
  ClusterRepresentative representative = ClusterRepresentative::kLeadingEdge;
};

const char* invalid_field(const RangeClusterConfig& config);

struct RangeCluster {
  float position_samples = 0.0f;  ///< [sample]
  std::int32_t weight = 0;        ///< number of decisions
  std::int32_t first_sample = 0;
  std::int32_t last_sample = 0;
};

/// One-dimensional clustering (sensor-radar paper, Sec. IV-F): every decision is a cluster; again and again
/// the two with the closest medians merge, the leftmost of equals, while closer than the merge distance. A
/// merged median lies between its parts', so distances only grow: sweeping the neighbours once for each
/// distance in ascending order takes the same decisions in about n ln(merge distance) steps.
/// Reference: python/echofuse/reference/node/scan/range_clusters.py
class RangeClusterer {
 public:
  Status configure(const RangeClusterConfig& config, float sample_rate_hz);

  /// decisions (n_samples,) 0 or 1; amplitude [count] and threshold [count^2] (n_samples,) place the leading
  /// edges. clusters: by ascending position. kTruncated: the heaviest that it holds.
  Status process(Span<const std::uint8_t> decisions, Span<const float> amplitude, Span<const float> threshold,
                 BoundedVector<RangeCluster>& clusters);

 private:
  void collect(Span<const std::uint8_t> decisions);
  void merge();
  int median(std::size_t begin, std::size_t end) const { return hits_[begin + (end - begin - 1) / 2]; }
  RangeCluster cluster(std::size_t index, Span<const float> amplitude, Span<const float> threshold) const;

  int merge_distance_samples_ = 0;  ///< [sample] 0 until configured
  RangeClusterConfig config_;
  std::size_t n_clusters_ = 0;
  std::array<std::uint16_t, kMaxHitsPerScan> hits_{};  ///< [sample] ascending
  std::array<std::uint16_t, kMaxHitsPerScan + 1>
      starts_{};  ///< of each cluster in hits_, and the last one's end
};

}  // namespace echofuse::node
