#pragma once

#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame.hpp"
#include "echofuse/hub/track/people_likelihood.hpp"
#include "echofuse/hub/track/people_search.hpp"
#include "echofuse/hub/track/range_births.hpp"
#include "echofuse/hub/track/range_config.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

/// Tracks people by the nodes' paths themselves: no position has to be found within one frame.
///
/// Where several people cross, the paths of one frame intersect in more places than there are people, and
/// the wrong ones often fit better. So a track begins, unconfirmed, at each place that fits, and an extended
/// Kalman filter follows it by each node's nearest detection. Which of the tracks are people is decided for
/// all of them together: the confirmed ones are the set that explains best what all nodes detected in the last
/// frames, and what they did not detect (people_likelihood.hpp, people_search.hpp). A track that the others
/// explain as well without it is unconfirmed again.
/// Reference: python/echofuse/reference/hub/track/range_tracker.py
class RangeTracker {
 public:
  /// Also resets. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const RangeTrackerConfig& config, float body_radius_m, Span<const NodeSite> nodes,
                   const Area& area);
  void reset();

  /// detections: by ascending node, then path, at most kMaxDetectionsPerNode of a node. dt_s: [s] > 0 since
  /// the last frame. Shows the tap kTracks.
  /// tracks.tracks: all that live, ascending id; its time and frame stay the caller's.
  /// kTruncated: a track could not begin for lack of room; what is there is valid.
  /// kInvalidInput: detections out of order, not finite or too many, or dt_s not positive; nothing changes.
  Status process(Span<const FrameDetection> detections, float dt_s, link::Tracks& tracks);

  void set_tap_sink(const TapSink& sink) { sink_ = sink; }
  std::uint32_t dropped_births() const { return dropped_births_; }  ///< tracks for which there was no room

 private:
  struct RangeTrack {
    std::int32_t id = 0;
    int age = 1;  ///< frames
    bool confirmed = false;
    float score = 0.0f;  ///< of an unconfirmed one, by itself
    int n_own = 0;       ///< nodes with a detection of its own in this frame
    std::int32_t frames_since_update = 0;
    estimation::ConstantVelocityFilter<2> filter;
    Trail trail;
  };

  bool well_formed(Span<const FrameDetection> detections) const;
  void predict(float dt_s);
  void update_confirmed();
  float follow(RangeTrack& track) const;
  void advance();
  bool lives(const RangeTrack& track) const;
  bool crowded(std::size_t index) const;
  void choose_people();
  bool begin_tracks();
  bool begin_at(const Point& place);
  void report(link::Tracks& tracks) const;

  bool configured_ = false;
  RangeTrackerConfig config_;
  std::size_t n_nodes_ = 0;
  Area area_;
  std::int32_t next_id_ = 1;
  std::uint32_t dropped_births_ = 0;
  TapSink sink_;
  PeopleLikelihood likelihood_;
  PeopleSearch search_;
  RangeBirths births_;
  LoneScore lone_;
  BoundedVector<RangeTrack, kMaxTracks> tracks_;  ///< the confirmed ones first, then by descending score
};

}  // namespace echofuse::hub
