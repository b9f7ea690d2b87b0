#pragma once

#include <cstddef>

/// Every capacity, with its reason. A port replaces them all: -DECHOFUSE_LIMITS_HEADER="my_limits.hpp" names
/// a header that defines the same constants. What exceeds one is cut, reported as kTruncated and counted,
/// never undefined.

#ifdef ECHOFUSE_LIMITS_HEADER

#include ECHOFUSE_LIMITS_HEADER

#else

namespace echofuse {

// One scan, on a node.
inline constexpr std::size_t kMaxSamplesPerScan =
    1920;  ///< [sample] the case study's scan: 117 ns at 16.4 GHz
inline constexpr std::size_t kMaxResponseSamples =
    4095;  ///< [sample] the Taylor-series paper's M-sequence, of order 12, before it is turned to time zero and cut
inline constexpr std::size_t kMaxHitsPerScan =
    kMaxSamplesPerScan;  ///< a detector may hit in every sample, never more
inline constexpr std::size_t kMaxClustersPerScan =
    64;  ///< 17 m of echoes in clusters 0.25 m apart, before the best are kept
inline constexpr std::size_t kMaxDetectionsPerNode =
    16;  ///< what one report carries: five people, walls' ghosts, clutter

// One frame, on the hub.
inline constexpr std::size_t kMaxNodes = 16;  ///< one hub serves one site of up to 16 nodes
inline constexpr std::size_t kMaxArrayReceivers =
    8;  ///< of one array: the papers' have 2 or 4, a room's set of ranging anchors commonly 6 to 8
inline constexpr std::size_t kMaxFrameHistory =
    8;  ///< frames that wait for late reports; 8 at 10 Hz is 0.8 s
inline constexpr std::size_t kMaxTuplesPerFrame =
    4096;  ///< nu-tuples solved: 16 nodes of 16 detections would have 17^16
inline constexpr std::size_t kMaxMeasurementsPerFrame =
    256;  ///< located tuples kept, before clustering (which is quadratic)
inline constexpr std::size_t kMaxPointsPerFrame =
    32;  ///< clustered measurements that a tracker gets: targets and clutter

// Tracking, on the hub.
inline constexpr std::size_t kMaxTargets = 16;  ///< people that one site reports at once
inline constexpr std::size_t kMaxTracks = 24;   ///< targets, and half as many again still unconfirmed
inline constexpr std::size_t kMaxParticles =
    2048;  ///< that persist from frame to frame: 128 a target at 16 targets
inline constexpr std::size_t kMaxNewbornParticles =
    1024;  ///< born in one frame: 32 a measurement at 32 measurements
inline constexpr std::size_t kMaxAssignment =
    32;  ///< rows or columns of an assignment: points and tracks both fit

// The link.
inline constexpr std::size_t kMaxLinkSessions =
    64;  ///< pairs of sender and port whose last transfer is remembered: 16 nodes of 4 subjects
inline constexpr std::size_t kMaxHealthValues =
    48;  ///< counters in one NodeHealth: a hub has 28, and its link 8
inline constexpr std::size_t kMaxPayloadBytes =
    1332;  ///< [byte] of any message but RawScan: SpatialTracks takes 24 times 55 and 12

}  // namespace echofuse

#endif

namespace echofuse {

static_assert(kMaxAssignment >= kMaxTracks && kMaxAssignment >= kMaxPointsPerFrame,
              "every track and every point of a frame must fit into one assignment");
static_assert(kMaxTracks >= kMaxTargets, "every target needs a track");

}  // namespace echofuse
