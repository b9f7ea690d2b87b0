#include "echofuse/hub/through_wall.hpp"

#include "hub_pipeline.hpp"

namespace echofuse::bindings {
namespace {

using hub::PathTrackerConfig;
using hub::ThroughWallHub;
using hub::ThroughWallHubConfig;

py::dict counters(const ThroughWallHub& self) { return path_hub_counters(self.counters()); }

template <int kDimension>
Eigen::Matrix<float, kDimension, 1> as_vector(const FloatArray& array, const char* name) {
  const auto values = as_span(array, name);
  if (values.size() != kDimension)
    throw py::value_error(std::string(name) + " must have shape (" + std::to_string(kDimension) + ",)");
  return Eigen::Map<const Eigen::Matrix<float, kDimension, 1>>(values.data());
}

/// Paths of each receiver (n_r,) [m], as a frame holds them.
void fill_paths(const std::vector<FloatArray>& paths, BoundedVector<hub::FrameDetection>& frame) {
  for (std::size_t r = 0; r < paths.size(); ++r)
    for (const float path_m : as_span(paths[r], "paths_m"))
      if (!frame.try_push_back({static_cast<int>(r), path_m, 1.0f}))
        throw py::value_error("paths_m: more than a frame holds");
}

void bind_path_tracker_config(py::module_& m) {
  ConfigBinder<PathTrackerConfig>(m, "PathTrackerConfig", "Tracks that choose among the receivers' traces.")
      .field("acceleration_density_m2ps3", &PathTrackerConfig::acceleration_density_m2ps3, "[m^2/s^3], > 0")
      .field("velocity_std_mps", &PathTrackerConfig::velocity_std_mps, "[m/s] at birth, > 0")
      .field("path_std_m", &PathTrackerConfig::path_std_m, "[m] of one receiver's path for itself, > 0")
      .field("common_path_std_m", &PathTrackerConfig::common_path_std_m, "[m] of what all share, >= 0")
      .field("gate", &PathTrackerConfig::gate, "squared distance of a combination, > 0")
      .field("missing_cost", &PathTrackerConfig::missing_cost, "for each receiver without a trace, >= 0")
      .field("lone_gate", &PathTrackerConfig::lone_gate, "squared distance of a single trace, >= 0")
      .field("lone_limit", &PathTrackerConfig::lone_limit, "responses in a row, >= 0")
      .field("cut_off", &PathTrackerConfig::cut_off, "deviations of a difference of paths, > 0")
      .field("confirm_updates", &PathTrackerConfig::confirm_updates, "of the last responses, >= 1")
      .field("confirm_window", &PathTrackerConfig::confirm_window, "responses, at most 32")
      .field("silent_time_s", &PathTrackerConfig::silent_time_s, "[s] for which a track may be silent, >= 0")
      .field("silent_velocity_time_s", &PathTrackerConfig::silent_velocity_time_s, "[s] fades with it, >= 0")
      .field("birth_exclusion_m", &PathTrackerConfig::birth_exclusion_m, "[m] from other tracks, >= 0")
      .field("merge_distance_m", &PathTrackerConfig::merge_distance_m, "[m] two that are one person, >= 0")
      .field("merge_speed_mps", &PathTrackerConfig::merge_speed_mps, "[m/s] and as fast, >= 0")
      .field("max_tracks", &PathTrackerConfig::max_tracks)
      .field("turn_density_m2ps3", &PathTrackerConfig::turn_density_m2ps3,
             "[m^2/s^3] velocity variance gained by one who turns, >= 0; 0: nobody does")
      .field("turn_begin_probability", &PathTrackerConfig::turn_begin_probability,
             "[1] that somebody begins to turn in one response, in (0, 1)")
      .field("turn_end_probability", &PathTrackerConfig::turn_end_probability,
             "[1] that somebody who turns walks straight on in the next, in (0, 1)")
      .field("path_std_growth", &PathTrackerConfig::path_std_growth,
             "[1/m] of both path deviations beyond 4 m, >= 0")
      .field("body_half_height_m", &PathTrackerConfig::body_half_height_m, "[m] in space, >= 0; 0: a ball");
}

template <int kDimension>
void bind_path_tracker(py::module_& m, const char* name) {
  using PathTracker = hub::PathTracker<kDimension>;
  using Vector = typename PathTracker::Vector;
  py::class_<PathTracker>(m, name)
      .def(py::init<>())
      .def(
          "configure",
          [](PathTracker& self, const PathTrackerConfig& config, const hub::WallConfig& wall,
             const FloatArray& rx, const FloatArray& least, const FloatArray& most, float body_radius_m) {
            const auto rows = as_span_of_rows(rx, kDimension, "rx_m");
            std::vector<Vector> receivers;
            for (std::size_t i = 0; i < rows.size(); i += kDimension)
              receivers.push_back(Eigen::Map<const Vector>(rows.data() + i));
            return self.configure(config, wall, {receivers.data(), receivers.size()},
                                  as_vector<kDimension>(least, "least_m"),
                                  as_vector<kDimension>(most, "most_m"), body_radius_m);
          },
          py::arg("config"), py::arg("wall"), py::arg("rx_m").noconvert(), py::arg("least_m").noconvert(),
          py::arg("most_m").noconvert(), py::arg("body_radius_m") = 0.0f,
          "rx_m (n, d) from the transmitter, corners least_m, most_m (d,) of where people can be [m].")
      .def("reset", &PathTracker::reset)
      .def(
          "update",
          [](PathTracker& self, const std::vector<FloatArray>& paths, float dt_s) {
            BoundedVector<hub::FrameDetection, hub::kMaxFrameDetections> frame;
            fill_paths(paths, frame);
            std::vector<std::int32_t> owners(frame.size());
            const Status status = self.update(frame.span(), dt_s, {owners.data(), owners.size()});
            return py::make_tuple(
                status, py::array_t<std::int32_t>(static_cast<py::ssize_t>(owners.size()), owners.data()));
          },
          py::arg("paths_m"), py::arg("dt_s"),
          "(status, owners): paths_m is a list of one array a receiver (n,) [m]; owners is the id of the "
          "track "
          "that took each, one after the other, 0 if none did.")
      .def(
          "begin",
          [](PathTracker& self, const FloatArray& position, const FloatArray& covariance) {
            const auto entries = as_span_of_rows(covariance, kDimension, "covariance_m2");
            if (entries.size() != kDimension * kDimension)
              throw py::value_error("covariance_m2 must be a square matrix");
            return self.begin(as_vector<kDimension>(position, "position_m"),
                              Eigen::Map<const typename PathTracker::PositionCovariance>(entries.data()));
          },
          py::arg("position_m").noconvert(), py::arg("covariance_m2").noconvert(),
          "At a fix (d,) [m] of covariance (d, d) [m^2].")
      .def(
          "tracks",
          [](const PathTracker& self) {
            link::Tracks tracks;
            self.report(tracks);
            return to_array(tracks);
          },
          "Structured array of Track.")
      .def("dropped_births", &PathTracker::dropped_births);
}

}  // namespace

void bind_hub_through_wall(py::module_& m) {
  bind_path_tracker_config(m);
  bind_path_tracker<2>(m, "PathTracker");
  bind_path_tracker<3>(m, "PathTracker3d");
  using Config = ThroughWallHubConfig;
  ConfigBinder<Config> config(m, "ThroughWallHubConfig", "The hub of the pipeline through_wall_2d.");
  config.field("nodes", &Config::nodes, "the first n_nodes")
      .field("n_nodes", &Config::n_nodes, "at least 2, on a line with their one transmitter")
      .field("area", &Config::area, "the room behind the wall")
      .field("frame_period_s", &Config::frame_period_s, "[s] taken for the first frame, > 0")
      .field("body_radius_m", &Config::body_radius_m,
             "[m] from an echo's beginning to a person's middle, >= 0")
      .field("track_aided", &Config::track_aided, "tracks take part in the pairing")
      .field("frame_assembler", &Config::frame_assembler)
      .field("trace_pairing", &Config::trace_pairing)
      .field("line_locator", &Config::line_locator)
      .field("path_tracker", &Config::path_tracker)
      .field("tracks", &Config::tracks);
  bind_site(config.type());
  bind_hub_pipeline_of<ThroughWallHub>(m, "ThroughWallHub", &counters);
  m.attr("THROUGH_WALL_HUB_BYTES") = sizeof(ThroughWallHub);
}

}  // namespace echofuse::bindings
