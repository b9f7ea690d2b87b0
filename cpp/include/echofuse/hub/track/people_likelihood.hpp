#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame.hpp"
#include "echofuse/hub/track/range_config.hpp"

namespace echofuse::hub {

/// Where one person was in the frames of the window, by slot, and the paths over her.
struct Trail {
  std::array<Point, kMaxWindowFrames> position;
  std::array<float, kMaxWindowFrames> scale_m;        ///< [m] mean deviation of a detection from the path
  std::array<float, kMaxWindowFrames> log_two_scale;  ///< [1]
  std::array<std::array<float, kMaxNodes>, kMaxWindowFrames> path_m;  ///< [m] under 0: too near to be seen
};

/// How well a set of people explains all that the nodes detected in the last frames.
///
/// Given who is there and where, a node detects each of them or not, by how far behind the first he is and by
/// who stands in the way; what it detects besides is clutter, of which there is hardly any ahead of everybody
/// and much behind. So a place that only seems to fit costs the misses of those nodes that should have seen a
/// person there, and a person left out leaves detections that nobody explains.
/// Reference: python/echofuse/reference/hub/track/people_likelihood.py
class PeopleLikelihood {
 public:
  using People = Span<const Trail* const>;

  /// A detection that is a person's, and how sure that is.
  struct Claim {
    int detection = -1;     ///< into the frame's, or -1
    float sureness = 0.0f;  ///< [1] probability that it is hers
  };

  /// The settings are possible (range_config.hpp). Also resets.
  void configure(const RangeTrackerConfig& config, float body_radius_m, Span<const NodeSite> nodes);
  void reset();

  /// The next frame; the oldest beyond the window is forgotten. Detections by ascending node, then path.
  void add_frame(Span<const FrameDetection> detections, float dt_s);

  /// Puts a filter's state into the newest frame of a trail; frames before the track began, `age` frames ago
  /// counting the newest as 1, are filled in straight back, the less sure the further.
  void lay(const estimation::ConstantVelocityFilter<2>& filter, int age, Trail& trail) const;

  /// Logarithm of the likelihood of the window's detections, up to what is the same for all sets.
  float score(People people) const;

  /// Whose is what in the newest frame at a node; stds_m: of each one's path before the detection.
  void claim(People people, Span<const float> stds_m, std::size_t node, Span<Claim> claims) const;

  /// [m] the path over a place, at least the nearest that is detected; under 0: too near to be seen.
  float visible_path(const Point& place, std::size_t node, Point* gradient = nullptr) const;

  /// Paths of the newest frame's detections at a node, ascending [m].
  Span<const float> paths(std::size_t node) const { return paths(newest_, node); }

 private:
  struct Frame {
    std::array<std::uint16_t, kMaxNodes + 1> first{};  ///< where each node's paths begin
    std::array<float, kMaxFrameDetections> path_m{};
    float dt_s = 0.0f;  ///< since the frame before
  };
  /// One person at one node in one frame.
  struct Member {
    const Trail* trail = nullptr;
    std::size_t index = 0;  ///< into the people
    float path_m = 0.0f;
    int visibility = 0;  ///< into log_hit_ and log_miss_
    int detection = -1;
  };
  struct Scene {
    BoundedVector<Member, kMaxTargets> members;  ///< by ascending path
    float first_m = 0.0f;                        ///< [m] path of the first person, seen or too near
    std::array<bool, kMaxDetectionsPerNode> explained{};
  };
  static constexpr int kVisibilities = 6;  ///< near and far, each in the clear, half and wholly shadowed

  Span<const float> paths(std::size_t slot, std::size_t node) const;
  void gather(People people, std::size_t slot, std::size_t node, Scene& scene) const;
  int visibility(People people, const Member& member, std::size_t slot, std::size_t node,
                 float first_m) const;
  void associate(Span<const float> paths_m, Scene& scene) const;
  bool shares(const Scene& scene, const Member& member) const;
  float log_clutter(float path_m, const Scene& scene) const;
  float scene_score(People people, std::size_t slot, std::size_t node) const;

  RangeTrackerConfig config_;
  float body_radius_m_ = 0.0f;
  std::size_t n_nodes_ = 0;
  std::array<NodeSite, kMaxNodes> nodes_;
  std::array<float, kMaxNodes> baseline_m_{};
  std::array<float, kVisibilities> probability_{};
  std::array<float, kVisibilities> log_hit_{};
  std::array<float, kVisibilities> log_miss_{};
  float log_ahead_ = 0.0f;
  float log_near_ = 0.0f;
  float log_far_ = 0.0f;
  std::size_t n_frames_ = 0;
  std::size_t newest_ = 0;
  std::array<Frame, kMaxWindowFrames> frames_;
};

}  // namespace echofuse::hub
