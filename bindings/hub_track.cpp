#include "echofuse/estimation/mixture_em.hpp"
#include "echofuse/hub/track/kalman_tracker.hpp"
#include "echofuse/hub/track/phd_filter.hpp"
#include "echofuse/hub/track/phd_tracker.hpp"
#include "echofuse/hub/track/range_tracker.hpp"
#include "echofuse/hub/track/track_manager.hpp"
#include "particles.hpp"
#include "tracks.hpp"

namespace echofuse::bindings {
namespace {

using hub::AssociationRule;
using hub::KalmanTracker;
using hub::PhdConfig;
using hub::PhdFilter;
using hub::PhdTracker;
using hub::ResamplingChance;
using hub::TrackEstimate;
using hub::TrackManager;
using hub::TrackManagerConfig;
using hub::TrackUpdate;
using link::Track;
using link::TrackState;

/// The taps of one call, by id, copied while they are valid.
struct TapRecorder {
  py::dict taps;
  static std::size_t columns_of(TapId tap) {
    if (tap == TapId::kTracks) return 7;
    return tap == TapId::kSpatialTracks ? 9 : 5;
  }
  static void record(void* context, TapId tap, Span<const float> values) {
    auto& self = *static_cast<TapRecorder*>(context);
    const std::size_t columns = columns_of(tap);
    py::array_t<float> rows(
        {static_cast<py::ssize_t>(values.size() / columns), static_cast<py::ssize_t>(columns)});
    std::copy(values.begin(), values.end(), rows.mutable_data());
    self.taps[py::int_(static_cast<int>(tap))] = rows;
  }
};

template <int kDimension, class Tracker>
py::tuple run(Tracker& self, const FloatArray& measurements, float dt_s) {
  link::Tracks tracks;
  const auto positions = to_positions<kDimension>(measurements, "measurements");
  const Status status = self.process(view(positions), dt_s, tracks);
  return py::make_tuple(status, to_array(tracks));
}

template <int kDimension, class Tracker>
py::tuple run_with_taps(Tracker& self, const FloatArray& measurements, float dt_s) {
  TapRecorder recorder;
  self.set_tap_sink({&TapRecorder::record, &recorder});
  const py::tuple result = run<kDimension>(self, measurements, dt_s);
  self.set_tap_sink({});
  return py::make_tuple(result[0], result[1], recorder.taps);
}

void bind_phd_filter(py::module_& m) {
  py::enum_<ResamplingChance>(m, "ResamplingChance", "In proportion to what particles are drawn.")
      .value("square_root", ResamplingChance::kSquareRoot)
      .value("proportional", ResamplingChance::kProportional);
  ConfigBinder<PhdConfig>(m, "PhdConfig", "Particle PHD filter with measurement-driven birth.")
      .field("detection_probability", &PhdConfig::detection_probability, "per frame")
      .field("survival_probability", &PhdConfig::survival_probability, "per frame")
      .field("clutter_per_frame", &PhdConfig::clutter_per_frame, "expected, uniform over the area")
      .field("birth_per_frame", &PhdConfig::birth_per_frame, "expected, uniform over the area")
      .field("area_m2", &PhdConfig::area_m2, "[m^2]")
      .field("measurement_std_m", &PhdConfig::measurement_std_m, "[m] per coordinate")
      .field("acceleration_density_m2ps3", &PhdConfig::acceleration_density_m2ps3, "[m^2/s^3]")
      .field("newborn_velocity_std_mps", &PhdConfig::newborn_velocity_std_mps, "[m/s] per coordinate")
      .field("particles_per_target", &PhdConfig::particles_per_target)
      .field("newborn_per_measurement", &PhdConfig::newborn_per_measurement)
      .field("mass_average_frames", &PhdConfig::mass_average_frames)
      .field("resampling", &PhdConfig::resampling)
      .field("seed", &PhdConfig::seed);
  py::class_<PhdFilter>(m, "PhdFilter", "A frame is predict, update, resample.")
      .def(py::init<>())
      .def("configure", &PhdFilter::configure, py::arg("config"))
      .def("reset", &PhdFilter::reset)
      .def("predict", &PhdFilter::predict, py::arg("dt_s"))
      .def(
          "update",
          [](PhdFilter& self, const FloatArray& measurements) {
            const auto positions = to_positions<2>(measurements, "measurements");
            return self.update(view(positions));
          },
          py::arg("measurements").noconvert(), "measurements (m, 2) [m]")
      .def("resample", &PhdFilter::resample)
      .def_property_readonly("particles", [](const PhdFilter& self) { return to_rows(self.particles()); })
      .def_property_readonly("persistent", [](const PhdFilter& self) { return to_rows(self.persistent()); })
      .def_property_readonly("measurement_mass",
                             [](const PhdFilter& self) {
                               py::array_t<float> mass(static_cast<py::ssize_t>(self.seeds().size()));
                               for (std::size_t i = 0; i < self.seeds().size(); ++i)
                                 mass.mutable_data()[i] = self.seeds()[i].mass;
                               return mass;
                             })
      .def_property_readonly("mass", &PhdFilter::mass)
      .def_property_readonly("number", &PhdFilter::number)
      .def_property_readonly("peak_seed", &PhdFilter::peak_seed);
}

void bind_track_manager_config(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(Track, id, state, frames_since_update, x_m, y_m, z_m, vx_mps, vy_mps, vz_mps,
                       covariance_xx_m2, covariance_xy_m2, covariance_yy_m2, covariance_xz_m2,
                       covariance_yz_m2, covariance_zz_m2);
  py::enum_<TrackState>(m, "TrackState")
      .value("unconfirmed", TrackState::kUnconfirmed)
      .value("confirmed", TrackState::kConfirmed)
      .value("silent", TrackState::kSilent)
      .value("dead", TrackState::kDead);
  py::enum_<AssociationRule>(m, "AssociationRule", "Which pairs of track and point hold.")
      .value("per_pair", AssociationRule::kPerPair)
      .value("hypothesis_cost", AssociationRule::kHypothesisCost);
  py::enum_<TrackUpdate>(m, "TrackUpdate", "What a point does to its track.")
      .value("estimate", TrackUpdate::kEstimate)
      .value("kalman", TrackUpdate::kKalman);
  ConfigBinder<TrackManagerConfig>(m, "TrackManagerConfig", "Association, life and motion of tracks.")
      .field("association", &TrackManagerConfig::association)
      .field("update", &TrackManagerConfig::update)
      .field("gate_m", &TrackManagerConfig::gate_m, "[m]")
      .field("cost_max_m", &TrackManagerConfig::cost_max_m, "[m] of hypothesis_cost")
      .field("gate_sigma", &TrackManagerConfig::gate_sigma, "deviations, of kalman; 0: no test")
      .field("silent_gate_growth_mps", &TrackManagerConfig::silent_gate_growth_mps, "[m/s]")
      .field("silent_gate_max_m", &TrackManagerConfig::silent_gate_max_m, "[m]")
      .field("birth_exclusion_m", &TrackManagerConfig::birth_exclusion_m, "[m]")
      .field("confirm_updates", &TrackManagerConfig::confirm_updates, "the first point included")
      .field("silent_time_min_s", &TrackManagerConfig::silent_time_min_s, "[s]")
      .field("silent_time_per_confirmed", &TrackManagerConfig::silent_time_per_confirmed)
      .field("silent_time_max_s", &TrackManagerConfig::silent_time_max_s, "[s]")
      .field("silent_velocity_time_s", &TrackManagerConfig::silent_velocity_time_s, "[s]")
      .field("acceleration_density_m2ps3", &TrackManagerConfig::acceleration_density_m2ps3, "[m^2/s^3]")
      .field("measurement_std_m", &TrackManagerConfig::measurement_std_m, "[m] of kalman")
      .field("velocity_std_mps", &TrackManagerConfig::velocity_std_mps, "[m/s]");
}

/// From an array (n, 7) or (n, 12): position, velocity, the covariance's lower triangle row by row.
template <int kDimension>
std::vector<TrackEstimate<kDimension>> to_estimates(const FloatArray& points) {
  constexpr std::size_t kColumns = 2 * kDimension + kDimension * (kDimension + 1) / 2;
  const auto values = as_span_of_rows(points, kColumns, "points");
  std::vector<TrackEstimate<kDimension>> estimates;
  for (const float* value = values.begin(); value != values.end();) {
    TrackEstimate<kDimension>& estimate = estimates.emplace_back();
    for (float& coordinate : estimate.position_m) coordinate = *value++;
    for (float& coordinate : estimate.velocity_mps) coordinate = *value++;
    for (int r = 0; r < kDimension; ++r)
      for (int c = 0; c <= r; ++c) estimate.covariance_m2(r, c) = estimate.covariance_m2(c, r) = *value++;
  }
  return estimates;
}

template <int kDimension>
void bind_track_manager(py::module_& m, const char* name, const char* layout) {
  using Manager = TrackManager<kDimension>;
  py::class_<Manager>(m, name, "Tracks from the points of each frame.")
      .def(py::init<>())
      .def("configure", &Manager::configure, py::arg("config"))
      .def("reset", &Manager::reset)
      .def(
          "process",
          [](Manager& self, const FloatArray& points, float dt_s) {
            const auto estimates = to_estimates<kDimension>(points);
            link::Tracks tracks;
            const Status status = self.process(view(estimates), dt_s, tracks);
            return py::make_tuple(status, to_array(tracks));
          },
          py::arg("points").noconvert(), py::arg("dt_s"),
          (std::string("(status, structured array of Track) of points ") + layout).c_str())
      .def_property_readonly("point_of_track",
                             [](const Manager& self) { return to_array(self.point_of_track()); })
      .def_property_readonly("dropped_births", &Manager::dropped_births);
}

void bind_phd_tracker(py::module_& m) {
  py::class_<PhdTracker>(m, "PhdTracker", "Particle PHD filter, its peaks, tracks.")
      .def(py::init<>())
      .def("configure", &PhdTracker::configure, py::arg("phd"), py::arg("em"), py::arg("tracks"))
      .def("reset", &PhdTracker::reset)
      .def("process", &run<2, PhdTracker>, py::arg("measurements").noconvert(), py::arg("dt_s"),
           "(status, structured array of Track) of measurements (m, 2) [m].")
      .def("process_with_taps", &run_with_taps<2, PhdTracker>, py::arg("measurements").noconvert(),
           py::arg("dt_s"), "(status, tracks, taps): taps by TapId, each (n, columns).")
      .def_property_readonly("mass", [](const PhdTracker& self) { return self.phd().mass(); })
      .def_property_readonly("dropped_births",
                             [](const PhdTracker& self) { return self.manager().dropped_births(); });
}

template <int kDimension>
void bind_kalman_tracker(py::module_& m, const char* name) {
  using Tracker = KalmanTracker<kDimension>;
  const std::string shape = "(m, " + std::to_string(kDimension) + ")";
  py::class_<Tracker>(m, name, "A Kalman filter a track and global nearest neighbour.")
      .def(py::init<>())
      .def("configure", &Tracker::configure, py::arg("config"))
      .def("reset", &Tracker::reset)
      .def("process", &run<kDimension, Tracker>, py::arg("measurements").noconvert(), py::arg("dt_s"),
           ("(status, structured array of Track) of measurements " + shape + " [m].").c_str())
      .def("process_with_taps", &run_with_taps<kDimension, Tracker>, py::arg("measurements").noconvert(),
           py::arg("dt_s"), "(status, tracks, taps): taps by TapId, each (n, columns).")
      .def_property_readonly("dropped_births",
                             [](const Tracker& self) { return self.manager().dropped_births(); });
}

void bind_range_tracker(py::module_& m) {
  using hub::RangeTracker;
  using hub::RangeTrackerConfig;
  ConfigBinder<RangeTrackerConfig>(m, "RangeTrackerConfig", "Tracks from the nodes' paths; scores are logs.")
      .field("detection_probability", &RangeTrackerConfig::detection_probability, "in the clear")
      .field("far_detection_probability", &RangeTrackerConfig::far_detection_probability,
             "in the clear, more than far_m behind the first")
      .field("shadowed_detection_probability", &RangeTrackerConfig::shadowed_detection_probability,
             "with somebody in the way")
      .field("far_shadowed_detection_probability", &RangeTrackerConfig::far_shadowed_detection_probability,
             "with somebody in the way, far")
      .field("shadow_radius_m", &RangeTrackerConfig::shadow_radius_m,
             "[m] nearer to a leg, somebody is in the way")
      .field("penumbra_m", &RangeTrackerConfig::penumbra_m, "[m] nearer, half in the way")
      .field("path_scale_m", &RangeTrackerConfig::path_scale_m, "[m] mean deviation")
      .field("path_std_m", &RangeTrackerConfig::path_std_m, "[m] of the filters")
      .field("visible_path_m", &RangeTrackerConfig::visible_path_m,
             "[m] behind the direct path; nobody is seen nearer")
      .field("nearest_path_m", &RangeTrackerConfig::nearest_path_m,
             "[m] behind the direct path the nearest detections are")
      .field("shared_path_m", &RangeTrackerConfig::shared_path_m,
             "[m] two people nearer in path may be one detection")
      .field("shared_score", &RangeTrackerConfig::shared_score, "of the one without")
      .field("gate_m", &RangeTrackerConfig::gate_m, "[m] of path")
      .field("clutter_ahead_per_m", &RangeTrackerConfig::clutter_ahead_per_m, "[1/m] behind nobody")
      .field("clutter_near_per_m", &RangeTrackerConfig::clutter_near_per_m,
             "[1/m] up to far_m behind somebody")
      .field("clutter_far_per_m", &RangeTrackerConfig::clutter_far_per_m, "[1/m] further")
      .field("far_m", &RangeTrackerConfig::far_m, "[m]")
      .field("ahead_m", &RangeTrackerConfig::ahead_m,
             "[m] a detection so far ahead of a person is behind him yet")
      .field("window_frames", &RangeTrackerConfig::window_frames, "that a set of people is judged by")
      .field("newcomer_cost", &RangeTrackerConfig::newcomer_cost, "by which one more has to explain better")
      .field("lasting_score", &RangeTrackerConfig::lasting_score, "for as many people as before")
      .field("identity_score", &RangeTrackerConfig::identity_score, "for each who was there before")
      .field("confirm_frames", &RangeTrackerConfig::confirm_frames, "least age")
      .field("silent_nodes", &RangeTrackerConfig::silent_nodes, "fewer with a detection: silent")
      .field("acceleration_density_m2ps3", &RangeTrackerConfig::acceleration_density_m2ps3, "[m^2/s^3]")
      .field("newborn_position_std_m", &RangeTrackerConfig::newborn_position_std_m, "[m] per coordinate")
      .field("newborn_velocity_std_mps", &RangeTrackerConfig::newborn_velocity_std_mps,
             "[m/s] per coordinate")
      .field("max_speed_mps", &RangeTrackerConfig::max_speed_mps, "[m/s] of an unconfirmed track")
      .field("candidate_detection_probability", &RangeTrackerConfig::candidate_detection_probability)
      .field("candidate_clutter_per_m", &RangeTrackerConfig::candidate_clutter_per_m, "[1/m]")
      .field("candidate_memory", &RangeTrackerConfig::candidate_memory, "of a score, per frame")
      .field("drop_score", &RangeTrackerConfig::drop_score, "an unconfirmed track below dies")
      .field("merge_distance_m", &RangeTrackerConfig::merge_distance_m, "[m]")
      .field("birth_step_m", &RangeTrackerConfig::birth_step_m, "[m] of the grid")
      .field("birth_score", &RangeTrackerConfig::birth_score, "least")
      .field("max_births", &RangeTrackerConfig::max_births, "per frame")
      .field("birth_exclusion_m", &RangeTrackerConfig::birth_exclusion_m, "[m]");
  py::class_<RangeTracker>(m, "RangeTracker", "Tracks people by the nodes' paths themselves.")
      .def(py::init<>())
      .def(
          "configure",
          [](RangeTracker& self, const RangeTrackerConfig& config, float body_radius_m,
             const std::vector<hub::NodeSite>& nodes, const hub::Area& area) {
            return self.configure(config, body_radius_m, {nodes.data(), nodes.size()}, area);
          },
          py::arg("config"), py::arg("body_radius_m"), py::arg("nodes"), py::arg("area"))
      .def("reset", &RangeTracker::reset)
      .def(
          "process",
          [](RangeTracker& self, const ArrayOf<int>& node_index, const FloatArray& path, float dt_s) {
            const auto nodes = as_span(node_index, "node_index");
            const auto paths = as_span(path, "path_m");
            if (nodes.size() != paths.size())
              throw py::value_error("node_index and path_m must have the same length");
            std::vector<hub::FrameDetection> detections;
            for (std::size_t i = 0; i < nodes.size(); ++i) detections.push_back({nodes[i], paths[i], 1.0f});
            link::Tracks tracks;
            const Status status = self.process({detections.data(), detections.size()}, dt_s, tracks);
            return py::make_tuple(status, to_array(tracks));
          },
          py::arg("node_index").noconvert(), py::arg("path_m").noconvert(), py::arg("dt_s"),
          "(status, structured array of Track) of detections by ascending node, then path (n,).")
      .def_property_readonly("dropped_births", &RangeTracker::dropped_births);
}

}  // namespace

void bind_hub_track(py::module_& m) {
  bind_phd_filter(m);
  bind_track_manager_config(m);
  bind_track_manager<2>(m, "TrackManager", "(n, 7): x, y, vx, vy, covariance xx, xy, yy.");
  bind_track_manager<3>(m, "TrackManager3d",
                        "(n, 12): x, y, z, vx, vy, vz, covariance xx, xy, yy, xz, yz, zz.");
  bind_phd_tracker(m);
  bind_kalman_tracker<2>(m, "KalmanTracker");
  bind_kalman_tracker<3>(m, "KalmanTracker3d");
  bind_range_tracker(m);
}

}  // namespace echofuse::bindings
