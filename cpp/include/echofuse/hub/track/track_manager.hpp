#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

enum class AssociationRule : std::uint8_t {
  kPerPair,         ///< each pair is judged by its own distance
  kHypothesisCost,  ///< all pairs hold when their mean distance is small, else each is judged (paper)
};

enum class TrackUpdate : std::uint8_t {
  kEstimate,  ///< the point's own state replaces the track's (peaks of the PHD, which are filtered already)
  kKalman,    ///< the track filters the point (bare measurements)
};

struct TrackManagerConfig {
  AssociationRule association = AssociationRule::kPerPair;
  TrackUpdate update = TrackUpdate::kEstimate;
  float gate_m = 1.0f;      ///< [m] furthest point from a track's prediction, > 0
  float cost_max_m = 1.0f;  ///< [m] kHypothesisCost: mean distance up to which all pairs hold, >= 0
  float gate_sigma = 4.0f;  ///< [1] kKalman: furthest point in deviations of the innovation, >= 0; 0: no test
  float silent_gate_growth_mps = 0.2f;     ///< [m/s] gate_m grows by this while a track is silent, >= 0
  float silent_gate_max_m = 1.5f;          ///< [m] up to this, >= 0
  float birth_exclusion_m = 0.5f;          ///< [m] no track begins nearer to another one, >= 0
  int confirm_updates = 3;                 ///< [1] consecutive frames with a point, the first included, >= 1
  float silent_time_min_s = 1.0f;          ///< [s] every confirmed track may be silent so long, >= 0
  float silent_time_per_confirmed = 1.0f;  ///< [1] or this share of the time for which it was confirmed, >= 0
  float silent_time_max_s = 10.0f;         ///< [s] but no longer than this, >= 0
  float silent_velocity_time_s = 0.5f;     ///< [s] a silent track's velocity fades with this constant, >= 0
  float acceleration_density_m2ps3 = 0.1f;  ///< [m^2/s^3] velocity variance gained per second, >= 0
  float measurement_std_m = 0.3f;           ///< [m] kKalman: of a point, per coordinate, > 0
  float velocity_std_mps = 1.2f;            ///< [m/s] of a velocity not seen yet, per coordinate, > 0
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const TrackManagerConfig& config);

/// A point of this frame; velocity 0 when it is a bare measurement.
template <int kDimension>
struct TrackEstimate {
  Eigen::Matrix<float, kDimension, 1> position_m;
  Eigen::Matrix<float, kDimension, 1> velocity_mps;
  Eigen::Matrix<float, kDimension, kDimension> covariance_m2;  ///< of the position
};

/// Tracks from the points of each frame, by their identities and states (section V-E of the sensor-radar
/// paper): unconfirmed -> confirmed after some consecutive points, dead at the first miss; confirmed ->
/// silent at a miss; silent -> confirmed at a point, dead after a time. A silent track comes to rest where it
/// was and its gate grows slowly, so a person who stops keeps the identity. In the plane or in space.
/// Reference: python/echofuse/reference/hub/track/track_manager.py
template <int kDimension>
class TrackManager {
 public:
  using Estimate = TrackEstimate<kDimension>;

  /// Also resets. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const TrackManagerConfig& config);
  void reset();

  /// points: finite. dt_s: [s] > 0 since the last frame. tracks.tracks: filled with all that live, ascending
  /// id; its time and frame stay the caller's. kTruncated: points beyond kMaxAssignment were ignored, or a
  /// track could not begin; what is there is valid. kInvalidInput: nothing changes, no tracks.
  Status process(Span<const Estimate> points, float dt_s, link::Tracks& tracks);

  /// (n tracks before the last frame,) the point that each got, or estimation::kUnassigned.
  Span<const int> point_of_track() const { return {point_of_track_.data(), n_associated_}; }
  std::uint32_t dropped_births() const { return dropped_births_; }  ///< tracks for which there was no room

 private:
  using Filter = estimation::ConstantVelocityFilter<kDimension>;

  struct ManagedTrack {
    std::int32_t id = 0;
    link::TrackState state = link::TrackState::kUnconfirmed;
    int updates = 1;  ///< consecutive frames with a point, until confirmed
    std::int32_t frames_since_update = 0;
    float confirmed_time_s = 0.0f;  ///< [s] for which it was updated since its confirmation
    float silent_time_s = 0.0f;     ///< [s] since its last point
    float motion = 1.0f;            ///< [1] what is left of the motion of a silent track
    Filter filter;
  };

  static float distance_m(const ManagedTrack& track, const Estimate& point);
  void predict(ManagedTrack& track, float dt_s) const;
  void associate(Span<const Estimate> points);
  void associate_per_pair(Span<const Estimate> points);
  void associate_by_hypothesis(Span<const Estimate> points);
  float gate_m(const ManagedTrack& track) const;
  bool within_sigma(const ManagedTrack& track, const Estimate& point) const;
  bool hit(ManagedTrack& track, const Estimate& point, float dt_s) const;
  bool miss(ManagedTrack& track, float dt_s) const;
  bool begin(const Estimate& point);
  Filter filter_of(const Estimate& point) const;
  typename Filter::PositionCovariance measurement_covariance() const;
  void report(link::Tracks& tracks) const;

  TrackManagerConfig config_{};
  bool configured_ = false;
  std::int32_t next_id_ = 1;
  std::uint32_t dropped_births_ = 0;
  BoundedVector<ManagedTrack, kMaxTracks> tracks_;
  std::array<int, kMaxTracks> point_of_track_{};
  std::size_t n_associated_ = 0;
  std::array<float, kMaxTracks * kMaxAssignment> cost_{};  ///< scratch: (tracks, points) [m]
};

}  // namespace echofuse::hub
