#include "hub.hpp"

#include <vector>

#include "echofuse/hub/locate/coverage.hpp"
#include "echofuse/hub/locate/ellipse_least_squares.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame_assembler.hpp"
#include "echofuse/hub/measure/measurement_selection.hpp"
#include "echofuse/hub/measure/point_clusters.hpp"
#include "tracks.hpp"

namespace echofuse::bindings {

namespace {

using hub::Area;
using hub::NodeSite;
using hub::Point;

void bind_site(py::module_& m) {
  ConfigBinder<Point>(m, "Point", "A position in the plane.")
      .field("x_m", &Point::x_m, "[m]")
      .field("y_m", &Point::y_m, "[m]");
  ConfigBinder<Area>(m, "Area", "A rectangle along the axes, edges included.")
      .field("min_x_m", &Area::min_x_m, "[m]")
      .field("min_y_m", &Area::min_y_m, "[m]")
      .field("max_x_m", &Area::max_x_m, "[m]")
      .field("max_y_m", &Area::max_y_m, "[m]");
  ConfigBinder<NodeSite>(m, "NodeSite",
                         "The foci of one node's ellipses; monostatic when both are in one place.")
      .field("node_id", &NodeSite::node_id)
      .field("tx", &NodeSite::tx, "[m]")
      .field("rx", &NodeSite::rx, "[m]");
  m.def(
      "invalid_site",
      [](const std::vector<NodeSite>& nodes, const Area& area) -> py::object {
        const char* what = hub::invalid_site({nodes.data(), nodes.size()}, area);
        if (what == nullptr) return py::none();
        return py::str(what);
      },
      py::arg("nodes"), py::arg("area"),
      "\"n_nodes\", \"nodes\" or \"area\": what makes locating impossible; or None.");
  m.def(
      "path_length",
      [](const Point& position, const Point& tx, const Point& rx, float body_radius_m) {
        Point gradient;
        const float path = hub::path_length(position, tx, rx, body_radius_m, &gradient);
        return py::make_tuple(path, gradient.x_m, gradient.y_m);
      },
      py::arg("position"), py::arg("tx"), py::arg("rx"), py::arg("body_radius_m"),
      "(path [m], its derivatives with respect to x and y).");
}

void bind_ellipse(py::module_& m) {
  using hub::EllipseConfig;
  using hub::EllipseFix;
  using hub::EllipseLeastSquares;
  using hub::RangeEllipse;
  py::enum_<hub::EllipseRefinement>(m, "EllipseRefinement")
      .value("gauss_newton", hub::EllipseRefinement::kGaussNewton)
      .value("none", hub::EllipseRefinement::kNone);
  ConfigBinder<EllipseConfig>(m, "EllipseConfig", "Intersection of ellipses (eqs. 16-23).")
      .field("refinement", &EllipseConfig::refinement)
      .field("max_iterations", &EllipseConfig::max_iterations, "of Gauss-Newton")
      .field("max_step_m", &EllipseConfig::max_step_m, "[m]")
      .field("body_radius_m", &EllipseConfig::body_radius_m, "[m]")
      .field("robust_scale_m", &EllipseConfig::robust_scale_m, "[m] 0: all paths alike");
  py::class_<EllipseFix>(m, "EllipseFix")
      .def_property_readonly(
          "position_m",
          [](const EllipseFix& fix) { return py::make_tuple(fix.position.x_m, fix.position.y_m); })
      .def_readonly("range_residual_m", &EllipseFix::range_residual_m)
      .def_readonly("equation_residual_m3", &EllipseFix::equation_residual_m3)
      .def_readonly("iterations", &EllipseFix::iterations)
      .def_readonly("converged", &EllipseFix::converged);
  const auto ellipses_of = [](const std::vector<NodeSite>& nodes, const FloatArray& path,
                              const FloatArray& weight) {
    const auto paths = as_span(path, "path_m");
    const auto weights = as_span(weight, "weight");
    if (paths.size() != nodes.size() || weights.size() != nodes.size())
      throw py::value_error("nodes, path_m and weight must have the same length");
    std::vector<RangeEllipse> ellipses;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      ellipses.push_back({nodes[i].tx, nodes[i].rx, paths[i], weights[i]});
    return ellipses;
  };
  py::class_<EllipseLeastSquares>(m, "EllipseLeastSquares")
      .def(py::init<>())
      .def("configure", &EllipseLeastSquares::configure, py::arg("config"))
      .def(
          "process",
          [ellipses_of](const EllipseLeastSquares& self, const std::vector<NodeSite>& nodes,
                        const FloatArray& path, const FloatArray& weight, const Area& area) {
            const std::vector<RangeEllipse> ellipses = ellipses_of(nodes, path, weight);
            EllipseFix fix;
            const Status status = self.process({ellipses.data(), ellipses.size()}, area, fix);
            return py::make_tuple(status, fix);
          },
          py::arg("nodes"), py::arg("path_m").noconvert(), py::arg("weight").noconvert(), py::arg("area"),
          "(status, EllipseFix) from one path a node.")
      .def(
          "refine",
          [ellipses_of](const EllipseLeastSquares& self, const std::vector<NodeSite>& nodes,
                        const FloatArray& path, const FloatArray& weight, const Point& position,
                        bool robust) {
            const std::vector<RangeEllipse> ellipses = ellipses_of(nodes, path, weight);
            EllipseFix fix;
            fix.position = position;
            const Status status = self.refine({ellipses.data(), ellipses.size()}, robust, fix);
            return py::make_tuple(status, fix);
          },
          py::arg("nodes"), py::arg("path_m").noconvert(), py::arg("weight").noconvert(), py::arg("position"),
          py::arg("robust"), "(status, EllipseFix) by Gauss-Newton from a position.");
}

void bind_coverage(py::module_& m) {
  using hub::Coverage;
  using hub::CoverageConfig;
  using hub::CoveragePoint;
  PYBIND11_NUMPY_DTYPE(CoveragePoint, n_covering, n_blind, best_snr_db, third_snr_db, position_error_bound_m);
  ConfigBinder<CoverageConfig>(m, "CoverageConfig", "Link budget of a site (section III).")
      .field("transmit_power_dbm", &CoverageConfig::transmit_power_dbm)
      .field("noise_figure_db", &CoverageConfig::noise_figure_db)
      .field("antenna_gain_db", &CoverageConfig::antenna_gain_db)
      .field("centre_hz", &CoverageConfig::centre_hz)
      .field("bandwidth_hz", &CoverageConfig::bandwidth_hz)
      .field("pulse_interval_s", &CoverageConfig::pulse_interval_s)
      .field("pulses_per_scan", &CoverageConfig::pulses_per_scan)
      .field("radar_cross_section_m2", &CoverageConfig::radar_cross_section_m2)
      .field("noise_temperature_K", &CoverageConfig::noise_temperature_K)
      .field("path_loss_exponent", &CoverageConfig::path_loss_exponent)
      .field("frequency_exponent", &CoverageConfig::frequency_exponent)
      .field("excess_path_loss_1m_db", &CoverageConfig::excess_path_loss_1m_db)
      .field("min_snr_db", &CoverageConfig::min_snr_db)
      .field("blind_zone_s", &CoverageConfig::blind_zone_s)
      .field("path_sigma_m", &CoverageConfig::path_sigma_m)
      .field("body_radius_m", &CoverageConfig::body_radius_m);
  m.def("cassini_ratio", &hub::cassini_ratio, py::arg("to_tx_m"), py::arg("to_rx_m"), py::arg("baseline_m"));
  m.def("leg_product_m2", &hub::leg_product_m2, py::arg("sum_m"), py::arg("baseline_m"),
        py::arg("bistatic_angle_rad"));
  m.def("snr", &hub::snr, py::arg("bistatic_constant_m4"), py::arg("to_tx_m"), py::arg("to_rx_m"));
  m.def("snr_on_ellipse", &hub::snr_on_ellipse, py::arg("bistatic_constant_m4"), py::arg("sum_m"),
        py::arg("baseline_m"), py::arg("bistatic_angle_rad"));
  m.def("sum_on_cassini_m", &hub::sum_on_cassini_m, py::arg("bistatic_constant_m4"), py::arg("snr"),
        py::arg("baseline_m"), py::arg("bistatic_angle_rad"));
  m.def("max_leg_product_m2", &hub::max_leg_product_m2, py::arg("bistatic_constant_m4"), py::arg("min_snr"));
  m.def("time_of_arrival_s", &hub::time_of_arrival_s, py::arg("to_tx_m"), py::arg("to_rx_m"));
  py::class_<Coverage>(m, "Coverage")
      .def(py::init<>())
      .def(
          "configure",
          [](Coverage& self, const CoverageConfig& config, const std::vector<NodeSite>& nodes,
             const Area& area) {
            return self.configure(config, {nodes.data(), nodes.size()}, area);
          },
          py::arg("config"), py::arg("nodes"), py::arg("area"))
      .def_property_readonly("bistatic_constant", &Coverage::bistatic_constant)
      .def(
          "process",
          [](const Coverage& self, const FloatArray& positions) {
            const auto rows = as_span_of_rows(positions, 2, "positions_m");
            std::vector<CoveragePoint> results(rows.size() / 2);
            Status worst = Status::kOk;
            for (std::size_t i = 0; i < results.size(); ++i) {
              const Status status = self.process({rows[2 * i], rows[2 * i + 1]}, results[i]);
              if (status != Status::kOk) worst = status;
            }
            return py::make_tuple(worst, to_array(Span<const CoveragePoint>(results.data(), results.size())));
          },
          py::arg("positions_m").noconvert(),
          "(status, structured array of CoveragePoint) of places (n, 2).");
}

void bind_frame_assembler(py::module_& m) {
  using hub::FrameAssembler;
  using hub::FrameAssemblerConfig;
  using hub::FrameAssemblerCounters;
  PYBIND11_NUMPY_DTYPE(hub::FrameDetection, node_index, path_m, weight);
  ConfigBinder<FrameAssemblerConfig>(m, "FrameAssemblerConfig", "Lines up the nodes' reports.")
      .field("deadline_us", &FrameAssemblerConfig::deadline_us, "[us]")
      .field("dead_after_frames", &FrameAssemblerConfig::dead_after_frames)
      .field("resync_after_reports", &FrameAssemblerConfig::resync_after_reports)
      .field("max_delay_s", &FrameAssemblerConfig::max_delay_s, "[s]");
  py::class_<FrameAssemblerCounters>(m, "FrameAssemblerCounters")
      .def_readonly("accepted", &FrameAssemblerCounters::accepted)
      .def_readonly("late", &FrameAssemblerCounters::late)
      .def_readonly("early", &FrameAssemblerCounters::early)
      .def_readonly("doubled", &FrameAssemblerCounters::doubled)
      .def_readonly("malformed", &FrameAssemblerCounters::malformed)
      .def_readonly("unknown_node", &FrameAssemblerCounters::unknown_node)
      .def_readonly("lost", &FrameAssemblerCounters::lost)
      .def_readonly("resynchronised", &FrameAssemblerCounters::resynchronised)
      .def_readonly("frames", &FrameAssemblerCounters::frames)
      .def_readonly("absent", &FrameAssemblerCounters::absent)
      .def_readonly("slow", &FrameAssemblerCounters::slow);
  py::class_<FrameAssembler>(m, "FrameAssembler")
      .def(py::init<>())
      .def(
          "configure",
          [](FrameAssembler& self, const FrameAssemblerConfig& config, const std::vector<NodeSite>& nodes) {
            return self.configure(config, {nodes.data(), nodes.size()});
          },
          py::arg("config"), py::arg("nodes"))
      .def("reset", &FrameAssembler::reset)
      .def_property_readonly("counters", &FrameAssembler::counters)
      .def("receive", &receive_report<FrameAssembler>, py::arg("node_id"), py::arg("frame"),
           py::arg("delay_s").noconvert(), py::arg("weight").noconvert(), py::arg("now_us"),
           py::arg("time_us") = 0)
      .def(
          "poll",
          [](FrameAssembler& self, std::int64_t now_us) -> py::tuple {
            hub::Frame frame;
            bool closed = false;
            const Status status = self.poll(now_us, frame, closed);
            if (!closed) return py::make_tuple(status, py::none());
            return py::make_tuple(status, py::make_tuple(frame.time_us, frame.frame, frame.n_reported,
                                                         to_array(frame.detections)));
          },
          py::arg("now_us"),
          "(status, None or (time_us, frame, n_reported, structured array of FrameDetection)).");
}

void bind_selection(py::module_& m) {
  using hub::Measurement;
  using hub::MeasurementSelection;
  using hub::SelectionConfig;
  using hub::SelectionCounters;
  PYBIND11_NUMPY_DTYPE(Measurement, x_m, y_m, weight, range_residual_m, n_nodes);
  py::enum_<hub::SelectionMethod>(m, "SelectionMethod")
      .value("consensus", hub::SelectionMethod::kConsensus)
      .value("all_tuples", hub::SelectionMethod::kAllTuples);
  py::enum_<hub::SelectionResidual>(m, "SelectionResidual")
      .value("range_residual", hub::SelectionResidual::kRangeResidual)
      .value("equation_residual", hub::SelectionResidual::kEquationResidual);
  ConfigBinder<SelectionConfig>(m, "SelectionConfig", "Positions from a frame's detections.")
      .field("method", &SelectionConfig::method)
      .field("residual", &SelectionConfig::residual)
      .field("nodes_per_tuple", &SelectionConfig::nodes_per_tuple, "nu")
      .field("min_weight", &SelectionConfig::min_weight, "[1]")
      .field("max_range_residual_m", &SelectionConfig::max_range_residual_m, "[m]")
      .field("max_equation_residual_m3", &SelectionConfig::max_equation_residual_m3, "[m^3]")
      .field("coarse_residual_m", &SelectionConfig::coarse_residual_m, "[m]")
      .field("support_gate_m", &SelectionConfig::support_gate_m, "[m]")
      .field("min_support", &SelectionConfig::min_support, "nodes")
      .field("min_support_fraction", &SelectionConfig::min_support_fraction, "of the nodes that reported")
      .field("min_own_support", &SelectionConfig::min_own_support, "nodes")
      .field("echo_tail_m", &SelectionConfig::echo_tail_m, "[m]")
      .field("track_aided", &SelectionConfig::track_aided)
      .field("track_gate_m", &SelectionConfig::track_gate_m, "[m]")
      .field("track_min_support", &SelectionConfig::track_min_support, "nodes")
      .field("track_min_own_support", &SelectionConfig::track_min_own_support, "nodes");
  py::class_<SelectionCounters>(m, "SelectionCounters")
      .def_readonly("frames", &SelectionCounters::frames)
      .def_readonly("tuples", &SelectionCounters::tuples)
      .def_readonly("dropped_tuples", &SelectionCounters::dropped_tuples)
      .def_readonly("dropped_detections", &SelectionCounters::dropped_detections)
      .def_readonly("dropped_measurements", &SelectionCounters::dropped_measurements);
  py::class_<MeasurementSelection>(m, "MeasurementSelection")
      .def(py::init<>())
      .def(
          "configure",
          [](MeasurementSelection& self, const SelectionConfig& config, const hub::EllipseConfig& ellipse,
             const std::vector<NodeSite>& nodes, const Area& area) {
            return self.configure(config, ellipse, {nodes.data(), nodes.size()}, area);
          },
          py::arg("config"), py::arg("ellipse"), py::arg("nodes"), py::arg("area"))
      .def("reset", &MeasurementSelection::reset)
      .def_property_readonly("counters", &MeasurementSelection::counters)
      .def(
          "process",
          [](MeasurementSelection& self, const ArrayOf<int>& node_index, const FloatArray& path,
             const FloatArray& weight, int n_reported, const FloatArray& predictions) {
            const auto nodes = as_span(node_index, "node_index");
            const auto paths = as_span(path, "path_m");
            const auto weights = as_span(weight, "weight");
            if (paths.size() != nodes.size() || weights.size() != nodes.size())
              throw py::value_error("node_index, path_m and weight must have the same length");
            std::vector<hub::FrameDetection> detections;
            for (std::size_t i = 0; i < nodes.size(); ++i)
              detections.push_back({nodes[i], paths[i], weights[i]});
            const auto rows = as_span_of_rows(predictions, 2, "predictions_m");
            std::vector<Point> points;
            for (std::size_t i = 0; i < rows.size(); i += 2) points.push_back({rows[i], rows[i + 1]});
            BoundedVector<Measurement, kMaxMeasurementsPerFrame> measurements;
            const Status status = self.process({detections.data(), detections.size()}, n_reported,
                                               {points.data(), points.size()}, measurements);
            return py::make_tuple(status, to_array(measurements));
          },
          py::arg("node_index").noconvert(), py::arg("path_m").noconvert(), py::arg("weight").noconvert(),
          py::arg("n_reported"), py::arg("predictions_m").noconvert(),
          "(status, structured array of Measurement) of one frame; predictions_m (p, 2).");
}

void bind_point_clusters(py::module_& m) {
  using hub::PointCluster;
  using hub::PointClusterConfig;
  using hub::PointClusters;
  PYBIND11_NUMPY_DTYPE(PointCluster, x_m, y_m, members, weight);
  py::enum_<hub::ClusterDistance>(m, "ClusterDistance")
      .value("centroid", hub::ClusterDistance::kCentroid)
      .value("minimum", hub::ClusterDistance::kMinimum)
      .value("maximum", hub::ClusterDistance::kMaximum);
  ConfigBinder<PointClusterConfig>(m, "PointClusterConfig", "Hierarchical clustering (Algorithm 2, mended).")
      .field("distance", &PointClusterConfig::distance)
      .field("threshold_m", &PointClusterConfig::threshold_m, "[m]");
  py::class_<PointClusters>(m, "PointClusters")
      .def(py::init<>())
      .def("configure", &PointClusters::configure, py::arg("config"))
      .def_property_readonly("dropped", &PointClusters::dropped)
      .def(
          "process",
          [](PointClusters& self, const FloatArray& position, const FloatArray& weight) {
            const auto rows = as_span_of_rows(position, 2, "position_m");
            const auto weights = as_span(weight, "weight");
            if (rows.size() != 2 * weights.size())
              throw py::value_error("position_m must have one row a weight");
            std::vector<hub::Measurement> points;
            for (std::size_t i = 0; i < weights.size(); ++i)
              points.push_back({rows[2 * i], rows[2 * i + 1], weights[i], 0.0f, 0});
            BoundedVector<PointCluster, kMaxPointsPerFrame> clusters;
            const Status status = self.process({points.data(), points.size()}, clusters);
            return py::make_tuple(status, to_array(clusters));
          },
          py::arg("position_m").noconvert(), py::arg("weight").noconvert(),
          "(status, structured array of PointCluster) of positions (n, 2).");
}

}  // namespace

void bind_hub(py::module_& m) {
  bind_site(m);
  bind_ellipse(m);
  bind_coverage(m);
  bind_hub_line(m);
  bind_hub_array(m);
  bind_frame_assembler(m);
  bind_selection(m);
  bind_point_clusters(m);
  bind_hub_track(m);
  bind_hub_pipeline(m);
  bind_hub_through_wall(m);
  bind_hub_through_wall_3d(m);
}

}  // namespace echofuse::bindings
