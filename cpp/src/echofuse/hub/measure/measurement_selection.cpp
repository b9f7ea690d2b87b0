#include "echofuse/hub/measure/measurement_selection.hpp"

#include <algorithm>
#include <cmath>

namespace echofuse::hub {
namespace {

static_assert(kMaxDetectionsPerNode <= 16, "a node's detections are the bits of 16");
static_assert(kMaxNodes * kMaxDetectionsPerNode < 65536, "a detection's index has 16 bits");

constexpr std::uint64_t kManyTuples = std::uint64_t{1} << 40;  ///< counts saturate here
constexpr std::uint64_t kDepthSlack = 8;  ///< this many times too many tuples: detections are cut first

bool bit(std::uint16_t set, int index) { return ((set >> index) & 1) != 0; }
std::uint16_t with_bit(std::uint16_t set, int index) {
  return static_cast<std::uint16_t>(set | (1u << index));
}

int count_bits(std::uint16_t set) {
  int n = 0;
  for (; set != 0; set = static_cast<std::uint16_t>(set & (set - 1u))) ++n;
  return n;
}

/// Number of tuples: over all choices of `order` nodes, the product of their counts, each at most `depth`.
std::uint64_t count_tuples(const std::array<int, kMaxNodes>& counts, int depth, int order) {
  std::array<std::uint64_t, kMaxNodes + 1> sums{};
  sums[0] = 1;
  for (const int count : counts) {
    const auto kept = static_cast<std::uint64_t>(std::min(count, depth));
    for (auto k = static_cast<std::size_t>(order); k > 0; --k)
      sums[k] = std::min(kManyTuples, sums[k] + sums[k - 1] * kept);
  }
  return sums[static_cast<std::size_t>(order)];
}

bool positive(float value) { return value > 0.0f && std::isfinite(value); }

}  // namespace

const char* invalid_field(const SelectionConfig& config) {
  if (config.method > SelectionMethod::kAllTuples) return "method";
  if (config.residual > SelectionResidual::kEquationResidual) return "residual";
  if (config.method == SelectionMethod::kConsensus && config.residual != SelectionResidual::kRangeResidual)
    return "residual";
  const int most = static_cast<int>(kMaxNodes);
  if (config.nodes_per_tuple < 3 || config.nodes_per_tuple > most) return "nodes_per_tuple";
  if (!(config.min_weight >= 0.0f && std::isfinite(config.min_weight))) return "min_weight";
  if (!positive(config.max_range_residual_m)) return "max_range_residual_m";
  if (!(config.max_equation_residual_m3 >= 0.0f && std::isfinite(config.max_equation_residual_m3)))
    return "max_equation_residual_m3";
  if (!positive(config.coarse_residual_m)) return "coarse_residual_m";
  if (!positive(config.support_gate_m)) return "support_gate_m";
  if (config.min_support < 3 || config.min_support > most) return "min_support";
  if (!(config.min_support_fraction >= 0.0f && config.min_support_fraction <= 1.0f))
    return "min_support_fraction";
  if (config.min_own_support < 1 || config.min_own_support > most) return "min_own_support";
  if (!(config.echo_tail_m >= 0.0f && std::isfinite(config.echo_tail_m))) return "echo_tail_m";
  if (!positive(config.track_gate_m)) return "track_gate_m";
  if (config.track_min_support < 2 || config.track_min_support > most) return "track_min_support";
  if (config.track_min_own_support < 1 || config.track_min_own_support > most) return "track_min_own_support";
  return nullptr;
}

bool suits(const SelectionConfig& config, Span<const NodeSite> nodes) {
  if (config.nodes_per_tuple > static_cast<int>(nodes.size())) return false;
  if (config.residual == SelectionResidual::kRangeResidual) return true;
  for (const NodeSite& node : nodes)
    if (node.tx.x_m != nodes[0].tx.x_m || node.tx.y_m != nodes[0].tx.y_m) return false;
  return true;
}

Status MeasurementSelection::configure(const SelectionConfig& config, const EllipseConfig& ellipse,
                                       Span<const NodeSite> nodes, const Area& area) {
  if (invalid_field(config) != nullptr || invalid_field(ellipse) != nullptr) return Status::kInvalidConfig;
  if (invalid_site(nodes, area) != nullptr) return Status::kInvalidConfig;
  if (!suits(config, nodes)) return Status::kInvalidConfig;
  const Status status = ellipse_.configure(ellipse);
  if (status != Status::kOk) return status;
  config_ = config;
  n_nodes_ = nodes.size();
  std::copy(nodes.begin(), nodes.end(), nodes_.begin());
  area_ = area;
  reset();
  return Status::kOk;
}

void MeasurementSelection::reset() { counters_ = SelectionCounters{}; }

Status MeasurementSelection::process(Span<const FrameDetection> detections, int n_reported,
                                     Span<const Point> predictions,
                                     BoundedVector<Measurement>& measurements) {
  measurements.clear();
  if (n_nodes_ == 0) return Status::kNotConfigured;
  if (!index_frame(detections)) return Status::kInvalidInput;
  ++counters_.frames;
  cut_ = false;
  const float part = config_.min_support_fraction * static_cast<float>(n_reported);
  needed_ = {std::max(config_.min_support, static_cast<int>(std::ceil(part - 1e-4f))),
             config_.min_own_support};

  const bool consensus = config_.method == SelectionMethod::kConsensus;
  if (consensus && config_.track_aided) aid(predictions, measurements);
  choose_depth();
  candidates_.clear();
  for_each_tuple(consensus ? &MeasurementSelection::visit_consensus : &MeasurementSelection::visit_all,
                 measurements);
  if (consensus) take(needed_, measurements);
  return cut_ ? Status::kTruncated : Status::kOk;
}

/// Notes where each node's detections begin; false: not in order, not finite, or too many.
bool MeasurementSelection::index_frame(Span<const FrameDetection> detections) {
  if (detections.size() > kMaxFrameDetections) return false;
  first_.fill(0);
  taken_.fill(0);
  int previous_node = 0;
  float previous_path = 0.0f;
  for (const FrameDetection& detection : detections) {
    if (detection.node_index < previous_node || detection.node_index >= static_cast<int>(n_nodes_))
      return false;
    if (detection.node_index > previous_node) previous_path = 0.0f;
    if (!(detection.path_m >= previous_path && std::isfinite(detection.path_m))) return false;
    if (!(detection.weight >= 0.0f && std::isfinite(detection.weight))) return false;
    previous_node = detection.node_index;
    previous_path = detection.path_m;
    ++first_[static_cast<std::size_t>(previous_node) + 1];
  }
  for (std::size_t node = 0; node < kMaxNodes; ++node) {
    if (first_[node + 1] > kMaxDetectionsPerNode) return false;
    first_[node + 1] = static_cast<std::uint16_t>(first_[node + 1] + first_[node]);
  }
  detections_ = detections;
  return true;
}

/// Which detections make tuples, and every how manieth choice of nodes is taken.
void MeasurementSelection::choose_depth() {
  std::array<int, kMaxNodes> counts{};
  int deepest = 0;
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    counts[node] = first_[node + 1] - first_[node] - count_bits(taken_[node]);
    deepest = std::max(deepest, counts[node]);
  }
  int depth = deepest;
  while (depth > 1 && count_tuples(counts, depth, config_.nodes_per_tuple) > kDepthSlack * kMaxTuplesPerFrame)
    --depth;
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    in_tuples_[node] = 0;
    for (int kept = std::min(counts[node], depth); kept > 0; --kept) {
      int heaviest = -1;
      for (int d = 0; d < first_[node + 1] - first_[node]; ++d) {
        if (bit(taken_[node], d) || bit(in_tuples_[node], d)) continue;
        const auto weight_of = [&](int i) {
          return detections_[static_cast<std::size_t>(first_[node] + i)].weight;
        };
        if (heaviest < 0 || weight_of(d) > weight_of(heaviest)) heaviest = d;
      }
      in_tuples_[node] = with_bit(in_tuples_[node], heaviest);
    }
    counters_.dropped_detections += static_cast<std::uint64_t>(std::max(0, counts[node] - depth));
  }
  const std::uint64_t total = count_tuples(counts, deepest, config_.nodes_per_tuple);
  const std::uint64_t fitting = count_tuples(counts, depth, config_.nodes_per_tuple);
  stride_ = static_cast<std::size_t>(
      std::max<std::uint64_t>(1, (fitting + kMaxTuplesPerFrame - 1) / kMaxTuplesPerFrame));
  counters_.dropped_tuples += total;  // those that are visited are taken off again
  cut_ = cut_ || depth < deepest;
}

/// Choices of nodes in lexicographic order, and for each its tuples, the last node's detection running first.
void MeasurementSelection::for_each_tuple(Visit visit, BoundedVector<Measurement>& measurements) {
  std::array<std::uint8_t, kMaxNodes> heard;
  int n_heard = 0;
  for (std::size_t node = 0; node < n_nodes_; ++node)
    if (in_tuples_[node] != 0) heard[static_cast<std::size_t>(n_heard++)] = static_cast<std::uint8_t>(node);
  const int order = config_.nodes_per_tuple;
  if (n_heard < order) return;

  std::array<int, kMaxNodes> choice{};
  for (int i = 0; i < order; ++i) choice[static_cast<std::size_t>(i)] = i;
  std::size_t visited = 0;
  std::size_t until_next = 0;
  while (true) {
    if (until_next == 0) {
      until_next = stride_;
      Tuple tuple;
      tuple.size = order;
      for (std::size_t i = 0; i < static_cast<std::size_t>(order); ++i)
        tuple.node[i] = heard[static_cast<std::size_t>(choice[i])];
      visited += visit_choice(tuple, kMaxTuplesPerFrame - visited, visit, measurements);
    }
    --until_next;
    int i = order - 1;
    while (i >= 0 && choice[static_cast<std::size_t>(i)] == n_heard - order + i) --i;
    if (i < 0) break;
    ++choice[static_cast<std::size_t>(i)];
    for (int j = i + 1; j < order; ++j)
      choice[static_cast<std::size_t>(j)] = choice[static_cast<std::size_t>(j - 1)] + 1;
  }
  counters_.tuples += visited;
  counters_.dropped_tuples -= visited;
}

/// All tuples of one choice of nodes, at most `room`; how many there were.
std::size_t MeasurementSelection::visit_choice(Tuple& tuple, std::size_t room, Visit visit,
                                               BoundedVector<Measurement>& measurements) {
  const auto next = [&](std::size_t i, int from) {  // the node's next detection in tuples, or -1
    for (int d = from; d < static_cast<int>(kMaxDetectionsPerNode); ++d)
      if (bit(in_tuples_[tuple.node[i]], d)) return d;
    return -1;
  };
  const auto size = static_cast<std::size_t>(tuple.size);
  for (std::size_t i = 0; i < size; ++i) tuple.detection[i] = static_cast<std::uint8_t>(next(i, 0));
  std::size_t visited = 0;
  while (visited < room) {
    (this->*visit)(tuple, measurements);
    ++visited;
    std::size_t i = size;
    while (i > 0) {
      const int following = next(i - 1, tuple.detection[i - 1] + 1);
      if (following >= 0) {
        tuple.detection[i - 1] = static_cast<std::uint8_t>(following);
        break;
      }
      tuple.detection[i - 1] = static_cast<std::uint8_t>(next(i - 1, 0));
      --i;
    }
    if (i == 0) return visited;
  }
  cut_ = true;
  return visited;
}

std::size_t MeasurementSelection::gather(const Tuple& tuple,
                                         std::array<RangeEllipse, kMaxNodes>& ellipses) const {
  const auto size = static_cast<std::size_t>(tuple.size);
  for (std::size_t i = 0; i < size; ++i) {
    const NodeSite& node = nodes_[tuple.node[i]];
    const auto index = static_cast<std::size_t>(first_[tuple.node[i]] + tuple.detection[i]);
    ellipses[i] = {node.tx, node.rx, detections_[index].path_m, 1.0f};
  }
  return size;
}

void MeasurementSelection::visit_all(const Tuple& tuple, BoundedVector<Measurement>& measurements) {
  float weight = 0.0f;
  for (std::size_t i = 0; i < static_cast<std::size_t>(tuple.size); ++i)
    weight += detections_[static_cast<std::size_t>(first_[tuple.node[i]] + tuple.detection[i])].weight;
  if (!(weight >= config_.min_weight)) return;

  std::array<RangeEllipse, kMaxNodes> ellipses;
  const std::size_t n = gather(tuple, ellipses);
  EllipseFix fix;
  if (ellipse_.process({ellipses.data(), n}, area_, fix) != Status::kOk || !fix.converged) return;
  const bool passed = config_.residual == SelectionResidual::kEquationResidual
                          ? fix.equation_residual_m3 <= config_.max_equation_residual_m3
                          : fix.range_residual_m <= config_.max_range_residual_m;
  if (!passed || !contains(area_, fix.position)) return;
  Candidate candidate{};
  candidate.position = fix.position;
  candidate.residual_m = fix.range_residual_m;
  candidate.weight = weight;
  candidate.support = static_cast<std::uint8_t>(n);
  emit(candidate, measurements);
}

void MeasurementSelection::visit_consensus(const Tuple& tuple, BoundedVector<Measurement>& /*measurements*/) {
  if (candidates_.full() || explained(tuple)) return;
  std::array<RangeEllipse, kMaxNodes> ellipses;
  const std::size_t n = gather(tuple, ellipses);
  const Span<const RangeEllipse> of_tuple{ellipses.data(), n};
  EllipseFix fix;
  if (ellipse_.start(of_tuple, area_, fix) != Status::kOk) return;
  if (!(fix.range_residual_m <= config_.coarse_residual_m)) return;
  if (ellipse_.refine(of_tuple, false, fix) != Status::kOk || !fix.converged) return;
  if (!(fix.range_residual_m <= config_.max_range_residual_m)) return;
  Candidate candidate{};
  candidate.position = fix.position;
  if (support(candidate, config_.support_gate_m, needed_) && candidates_.try_push_back(candidate)) return;
}

/// Does a candidate rest on all of the tuple's detections already.
bool MeasurementSelection::explained(const Tuple& tuple) const {
  for (const Candidate& candidate : candidates_) {
    bool all = true;
    for (std::size_t i = 0; i < static_cast<std::size_t>(tuple.size) && all; ++i)
      all = candidate.chosen[tuple.node[i]] == tuple.detection[i];
    if (all) return true;
  }
  return false;
}

/// Of each node the detection nearest to the predicted path, if within the gate.
void MeasurementSelection::choose_supporters(Candidate& candidate, float gate_m) const {
  candidate.weight = 0.0f;
  candidate.support = 0;
  candidate.own = 0;
  candidate.chosen.fill(kNoDetection);
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    const int count = first_[node + 1] - first_[node];
    if (count == 0) continue;
    const float path =
        path_length(candidate.position, nodes_[node].tx, nodes_[node].rx, ellipse_.config().body_radius_m);
    float least = gate_m;
    for (int d = 0; d < count; ++d) {
      const float gap = std::fabs(detections_[static_cast<std::size_t>(first_[node] + d)].path_m - path);
      if (!(gap <= least) || (gap == least && candidate.chosen[node] != kNoDetection)) continue;
      least = gap;
      candidate.chosen[node] = static_cast<std::uint8_t>(d);
    }
    if (candidate.chosen[node] == kNoDetection) continue;
    candidate.weight += detections_[static_cast<std::size_t>(first_[node] + candidate.chosen[node])].weight;
    ++candidate.support;
    if (!bit(taken_[node], candidate.chosen[node])) ++candidate.own;
  }
}

/// Refines the position with all that support it, twice; false when too few do, or they contradict.
bool MeasurementSelection::support(Candidate& candidate, float gate_m, const Needed& needed) const {
  for (const float gate : {gate_m, config_.support_gate_m}) {
    choose_supporters(candidate, gate);
    if (candidate.support < needed.support || candidate.own < needed.own) return false;
    std::array<RangeEllipse, kMaxNodes> ellipses;
    Tuple supporters;
    for (std::size_t node = 0; node < n_nodes_; ++node) {
      if (candidate.chosen[node] == kNoDetection) continue;
      const auto i = static_cast<std::size_t>(supporters.size++);
      supporters.node[i] = static_cast<std::uint8_t>(node);
      supporters.detection[i] = candidate.chosen[node];
    }
    EllipseFix fix;
    fix.position = candidate.position;
    if (ellipse_.refine({ellipses.data(), gather(supporters, ellipses)}, true, fix) != Status::kOk)
      return false;
    candidate.position = fix.position;
    candidate.residual_m = fix.range_residual_m;
  }
  return candidate.weight >= config_.min_weight && contains(area_, candidate.position) &&
         candidate.residual_m <= config_.max_range_residual_m;
}

/// Known people choose first, with a lower need of support.
void MeasurementSelection::aid(Span<const Point> predictions, BoundedVector<Measurement>& measurements) {
  candidates_.clear();
  const Needed needed{config_.track_min_support, config_.track_min_own_support};
  for (const Point& prediction : predictions) {
    Candidate candidate{};
    candidate.position = prediction;
    if (!support(candidate, config_.track_gate_m, needed)) continue;
    const float x = candidate.position.x_m - prediction.x_m;
    const float y = candidate.position.y_m - prediction.y_m;
    if (!(std::sqrt(x * x + y * y) <= config_.track_gate_m)) continue;
    if (!candidates_.try_push_back(candidate)) cut_ = true;
  }
  take(needed, measurements);
}

/// The best candidate takes its detections; those that shared them are looked at again.
void MeasurementSelection::take(const Needed& needed, BoundedVector<Measurement>& measurements) {
  while (!candidates_.empty()) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < candidates_.size(); ++i) {
      const Candidate& a = candidates_[i];
      const Candidate& b = candidates_[best];
      const bool better = a.own != b.own           ? a.own > b.own
                          : a.support != b.support ? a.support > b.support
                                                   : a.residual_m < b.residual_m;
      if (better) best = i;
    }
    const Candidate winner = candidates_[best];
    emit(winner, measurements);
    mark_taken(winner);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      Candidate candidate = candidates_[i];
      if (shares_taken(candidate) && !support(candidate, config_.support_gate_m, needed)) continue;
      candidates_[kept++] = candidate;
    }
    while (candidates_.size() > kept) candidates_.pop_back();
  }
}

/// The detections that it rests on, and those in the tail of its echoes.
void MeasurementSelection::mark_taken(const Candidate& winner) {
  for (std::size_t node = 0; node < n_nodes_; ++node) {
    if (winner.chosen[node] != kNoDetection) taken_[node] = with_bit(taken_[node], winner.chosen[node]);
    if (config_.echo_tail_m == 0.0f) continue;
    const float path =
        path_length(winner.position, nodes_[node].tx, nodes_[node].rx, ellipse_.config().body_radius_m);
    for (int d = 0; d < first_[node + 1] - first_[node]; ++d) {
      const float behind = detections_[static_cast<std::size_t>(first_[node] + d)].path_m - path;
      if (behind >= -config_.support_gate_m && behind <= config_.echo_tail_m)
        taken_[node] = with_bit(taken_[node], d);
    }
  }
}

bool MeasurementSelection::shares_taken(const Candidate& candidate) const {
  for (std::size_t node = 0; node < n_nodes_; ++node)
    if (candidate.chosen[node] != kNoDetection && bit(taken_[node], candidate.chosen[node])) return true;
  return false;
}

void MeasurementSelection::emit(const Candidate& candidate, BoundedVector<Measurement>& measurements) {
  if (measurements.size() < kMaxMeasurementsPerFrame &&
      measurements.try_push_back({candidate.position.x_m, candidate.position.y_m, candidate.weight,
                                  candidate.residual_m, candidate.support}))
    return;
  ++counters_.dropped_measurements;
  cut_ = true;
}

}  // namespace echofuse::hub
