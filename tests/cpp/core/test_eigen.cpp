#include <doctest/doctest.h>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/eigen.hpp"

namespace echofuse {

TEST_CASE("Eigen's fixed types pack without padding, so a struct has one layout on every machine") {
  CHECK(sizeof(Eigen::Matrix<float, 4, 4>) == 16 * sizeof(float));
  CHECK(alignof(Eigen::Matrix<float, 4, 4>) == alignof(float));
  CHECK(alignof(Eigen::Vector4f) == alignof(float));
}

TEST_CASE("Eigen's fixed types live in bounded vectors") {
  BoundedVector<Eigen::Vector2f, 2> points;
  CHECK(points.try_push_back({1.0f, 2.0f}));
  CHECK(points.try_push_back({3.0f, 4.0f}));
  points.erase_at(0);
  CHECK(points[0].y() == 4.0f);
}

}  // namespace echofuse
