#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/hub/measure/measurement_selection.hpp"

namespace echofuse::hub {

enum class ClusterDistance : std::uint8_t {
  kCentroid,  ///< (26) between the centroids
  kMinimum,   ///< (28) between the nearest members
  kMaximum,   ///< (29) between the farthest members
};

struct PointClusterConfig {
  ClusterDistance distance = ClusterDistance::kCentroid;
  float threshold_m = 0.8f;  ///< [m] clusters nearer than this are one, > 0
};

const char* invalid_field(const PointClusterConfig& config);

struct PointCluster {
  float x_m = 0.0f;     ///< [m] centroid
  float y_m = 0.0f;     ///< [m]
  int members = 0;      ///< measurements in it
  float weight = 0.0f;  ///< [1] sum of its measurements' weights
};

/// Hierarchical clustering in the plane (sensor-radar paper, Algorithm 2, with the least distance found anew
/// in each pass: with the printed one, which survives a merge, too many clusters remain).
/// Each cluster remembers its nearest later one, so a pass costs what the last merge changed.
/// Reference: python/echofuse/reference/hub/measure/point_clusters.py
class PointClusters {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const PointClusterConfig& config);

  void reset() { dropped_ = 0; }

  /// clusters: cleared, then filled in the order of their first members. kTruncated: it is full, and the
  /// clusters of the least weight were left out (counted by dropped()).
  /// kInvalidInput: more than kMaxMeasurementsPerFrame measurements, or one is not finite.
  Status process(Span<const Measurement> measurements, BoundedVector<PointCluster>& clusters);

  /// Clusters left out since configure() or reset().
  std::uint64_t dropped() const { return dropped_; }

 private:
  struct Cluster {
    float x_m, y_m;          ///< centroid
    float sum_x_m, sum_y_m;  ///< over members
    float weight;
    std::uint16_t members;
    std::uint16_t first, last;  ///< member list
    std::uint16_t nearest;      ///< index of the nearest later cluster
    float distance_m;           ///< to it; infinite for the last
  };

  float distance(const Cluster& a, const Cluster& b) const;
  void find_nearest(std::size_t index);
  void merge(std::size_t into, std::size_t from);

  PointClusterConfig config_;
  bool configured_ = false;
  std::uint64_t dropped_ = 0;
  Span<const Measurement> points_;
  std::array<std::uint16_t, kMaxMeasurementsPerFrame> next_{};  ///< the next member of the same cluster
  BoundedVector<Cluster, kMaxMeasurementsPerFrame> clusters_;
};

}  // namespace echofuse::hub
