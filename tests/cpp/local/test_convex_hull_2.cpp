// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/convex_hull_2.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace remanifold::detail {
namespace {

__extension__ using Wide = __int128;

// Points next to the line through (12, 12) and (24, 24): Kettner et al., Classroom
// Examples of Robustness Problems in Geometric Computations (2008), figure 2.
TEST(ConvexHull2, OrientationIsExact) {
  constexpr double unit = 0x1p-53;
  const PlanePoint b{12, 12};
  const PlanePoint c{24, 24};
  const auto exact = [](PlanePoint p, PlanePoint q, PlanePoint r) {
    const auto whole = [](double x) { return static_cast<Wide>(x * 0x1p53); };
    const Wide determinant = (whole(q.x) - whole(p.x)) * (whole(r.y) - whole(p.y)) -
                             (whole(q.y) - whole(p.y)) * (whole(r.x) - whole(p.x));
    return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
  };
  int zeros = 0;
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const PlanePoint a{0.5 + i * unit, 0.5 + j * unit};
      const int expected = exact(a, b, c);
      zeros += expected == 0 ? 1 : 0;
      ASSERT_EQ(orientation(a, b, c), expected) << i << ", " << j;
    }
  }
  EXPECT_GT(zeros, 0);
}

TEST(ConvexHull2, KeepsExtremePointsOnly) {
  std::vector<PlanePoint> points;
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) {
      points.push_back({0.1 * i, 0.1 * j});
      points.push_back({0.1 * i, 0.1 * j});  // repeated
    }
  }
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    HullPolygon polygon;
    polygon.restart(1e-9, 0);
    for (const Index id : order) {
      polygon.insert(points[id], id, [](Index, Index) { return 0.0; });
    }
    ASSERT_EQ(polygon.vertices().size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      const PlanePoint a = polygon.vertices()[i].point;
      const PlanePoint b = polygon.vertices()[(i + 1) % 4].point;
      EXPECT_EQ(std::abs(a.x) + std::abs(a.y), 0.8);
      EXPECT_GT(a.x * b.y - a.y * b.x, 0);
    }
  }
}

TEST(ConvexHull2, TellsTheEdgesThatChange) {
  HullPolygon polygon;
  polygon.restart(1e-3, -1);
  const std::vector<PlanePoint> square{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (Index id = 0; id < 4; ++id) {
    EXPECT_TRUE(
        polygon.insert(square[id], id, [](Index a, Index b) { return 10.0 * a + b; }));
  }
  EXPECT_FALSE(polygon.insert({0.5, 0.5}, 4, [](Index, Index) { return 0.0; }));
  for (const HullPolygon::Vertex& vertex : polygon.vertices()) {
    EXPECT_EQ(vertex.value, 10.0 * vertex.id + (vertex.id + 1) % 4);
  }
}

}  // namespace
}  // namespace remanifold::detail
