#include "echofuse/hub/locate/site.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "echofuse/core/limits.hpp"

namespace echofuse::hub {
namespace {

constexpr float kSamePlace_m = 0.01f;  ///< antennas nearer than a centimetre are in one place
constexpr float kMinBisector = 1e-3f;  ///< |u + v| below which a person stands on the baseline

float distance(const Point& a, const Point& b) {
  const float x = a.x_m - b.x_m;
  const float y = a.y_m - b.y_m;
  return std::sqrt(x * x + y * y);
}

bool same_foci(const NodeSite& a, const NodeSite& b) {
  const float alike = std::max(distance(a.tx, b.tx), distance(a.rx, b.rx));
  const float swapped = std::max(distance(a.tx, b.rx), distance(a.rx, b.tx));
  return std::min(alike, swapped) <= kSamePlace_m;
}

/// Twice the signed area of the triangle origin, along, point [m^2].
float side(const Point& origin, const Point& along, const Point& point) {
  return (along.x_m - origin.x_m) * (point.y_m - origin.y_m) -
         (along.y_m - origin.y_m) * (point.x_m - origin.x_m);
}

/// The two antennas that are farthest apart, if all the others lie on the line through them.
bool on_a_line(Span<const Point> antennas, Point& first, Point& last) {
  float longest = -1.0f;
  for (std::size_t i = 0; i < antennas.size(); ++i) {
    for (std::size_t j = i + 1; j < antennas.size(); ++j) {
      const float length = distance(antennas[i], antennas[j]);
      if (length <= longest) continue;
      longest = length;
      first = antennas[i];
      last = antennas[j];
    }
  }
  if (longest <= kSamePlace_m) return true;
  for (const Point& antenna : antennas)
    if (std::fabs(side(first, last, antenna)) > kSamePlace_m * longest) return false;
  return true;
}

bool mirrored(Span<const NodeSite> nodes, const Area& area) {
  std::array<Point, 2 * kMaxNodes> antennas;
  std::size_t n = 0;
  for (const NodeSite& node : nodes) {
    antennas[n++] = node.tx;
    antennas[n++] = node.rx;
  }
  Point first;
  Point last;
  if (!on_a_line({antennas.data(), n}, first, last)) return false;
  const float a = side(first, last, {area.min_x_m, area.min_y_m});
  const float b = side(first, last, {area.min_x_m, area.max_y_m});
  const float c = side(first, last, {area.max_x_m, area.min_y_m});
  const float d = side(first, last, {area.max_x_m, area.max_y_m});
  return std::min({a, b, c, d}) < 0.0f && std::max({a, b, c, d}) > 0.0f;
}

}  // namespace

const char* invalid_field(const Point& point) {
  if (!std::isfinite(point.x_m)) return "x_m";
  if (!std::isfinite(point.y_m)) return "y_m";
  return nullptr;
}

const char* invalid_field(const Area& area) {
  if (!std::isfinite(area.min_x_m)) return "min_x_m";
  if (!std::isfinite(area.min_y_m)) return "min_y_m";
  if (!(area.max_x_m > area.min_x_m && std::isfinite(area.max_x_m))) return "max_x_m";
  if (!(area.max_y_m > area.min_y_m && std::isfinite(area.max_y_m))) return "max_y_m";
  return nullptr;
}

const char* invalid_field(const NodeSite& node) {
  if (invalid_field(node.tx) != nullptr) return "tx";
  if (invalid_field(node.rx) != nullptr) return "rx";
  return nullptr;
}

bool contains(const Area& area, const Point& position) {
  return position.x_m >= area.min_x_m && position.x_m <= area.max_x_m && position.y_m >= area.min_y_m &&
         position.y_m <= area.max_y_m;
}

float path_length(const Point& position, const Point& tx, const Point& rx, float body_radius_m,
                  Point* gradient) {
  const float to_tx = distance(position, tx);
  const float to_rx = distance(position, rx);
  const float path = to_tx + to_rx;
  if (gradient == nullptr && body_radius_m == 0.0f) return path;

  const float per_tx = to_tx > 0.0f ? 1.0f / to_tx : 0.0f;
  const float per_rx = to_rx > 0.0f ? 1.0f / to_rx : 0.0f;
  const Point u{(position.x_m - tx.x_m) * per_tx, (position.y_m - tx.y_m) * per_tx};
  const Point v{(position.x_m - rx.x_m) * per_rx, (position.y_m - rx.y_m) * per_rx};
  const Point sum{u.x_m + v.x_m, u.y_m + v.y_m};
  if (gradient != nullptr) *gradient = sum;
  if (body_radius_m == 0.0f) return path;

  const float bisector = std::sqrt(sum.x_m * sum.x_m + sum.y_m * sum.y_m);  // 2 cos(beta / 2)
  if (gradient != nullptr && bisector > kMinBisector) {
    const float cosine = u.x_m * v.x_m + u.y_m * v.y_m;
    const float turn_x = (v.x_m - cosine * u.x_m) * per_tx + (u.x_m - cosine * v.x_m) * per_rx;
    const float turn_y = (v.y_m - cosine * u.y_m) * per_tx + (u.y_m - cosine * v.y_m) * per_rx;
    gradient->x_m -= body_radius_m * turn_x / bisector;
    gradient->y_m -= body_radius_m * turn_y / bisector;
  }
  return path - body_radius_m * bisector;
}

const char* invalid_site(Span<const NodeSite> nodes, const Area& area) {
  if (nodes.size() < 3 || nodes.size() > kMaxNodes) return "n_nodes";
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (invalid_field(nodes[i]) != nullptr) return "nodes";
    for (std::size_t j = 0; j < i; ++j)
      if (nodes[i].node_id == nodes[j].node_id || same_foci(nodes[i], nodes[j])) return "nodes";
  }
  if (invalid_field(area) != nullptr) return "area";
  if (mirrored(nodes, area)) return "nodes";
  return nullptr;
}

}  // namespace echofuse::hub
