#pragma once

#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"

namespace echofuse::hub {

inline constexpr std::size_t kMaxFrameDetections = kMaxNodes * kMaxDetectionsPerNode;

struct FrameDetection {
  int node_index = 0;   ///< into the site's nodes
  float path_m = 0.0f;  ///< [m] tx -> person -> rx
  float weight = 0.0f;  ///< [1] samples that the node's detector marked
};

/// What all nodes said about one instant.
struct Frame {
  std::int64_t time_us = 0;  ///< [us] when its first report came, the hub's clock
  std::uint32_t frame = 0;   ///< counts the hub's frames
  int n_reported = 0;        ///< nodes that reported, with or without detections
  BoundedVector<FrameDetection, kMaxFrameDetections> detections;  ///< ascending node, then path
};

}  // namespace echofuse::hub
