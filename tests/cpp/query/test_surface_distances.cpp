// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace remanifold {
namespace {

std::vector<double> sides(const testing::Cloud& cloud, const SimplexArray& triangles) {
  std::vector<double> lengths;
  for (Offset t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      double sum = 0;
      for (int a = 0; a < cloud.dim; ++a) {
        const double step =
            cloud[triangles[t][(i + 1) % 3]][a] - cloud[triangles[t][(i + 2) % 3]][a];
        sum += step * step;
      }
      lengths.push_back(std::sqrt(sum));
    }
  }
  return lengths;
}

TEST(SurfaceDistances, CrossTheTrianglesOfASquareAndEndWithIt) {
  const testing::Cloud cloud{{0, 0, 1, 0, 1, 1, 0, 1, 5, 5}, 2};
  // Of either orientation.
  for (const SimplexArray& square :
       {SimplexArray{3, {0, 1, 3, 1, 2, 3}}, SimplexArray{3, {0, 1, 3, 3, 2, 1}}}) {
    const std::vector<double> found =
        surface_distances(square, sides(cloud, square), 5, {0, 2});
    EXPECT_NEAR(found[2], std::sqrt(2.0), 1e-15);
    EXPECT_NEAR(found[5], std::sqrt(2.0), 1e-15);
    EXPECT_EQ(found[1], 1);
    EXPECT_EQ(found[0], 0);
    EXPECT_EQ(found[4], std::numeric_limits<double>::infinity());
  }
}

TEST(SurfaceDistances, GoAroundAPyramid) {
  // Over the edges of a high pyramid it is farther than around it.
  const testing::Cloud cloud{{1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0, 0, 0, 9}, 3};
  const SimplexArray pyramid{3, {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4}};
  const std::vector<double> found =
      surface_distances(pyramid, sides(cloud, pyramid), 5, {0});
  // Two triangles unfolded: an isosceles one with twice their angle at the apex.
  const double leg = std::sqrt(82.0);
  const double half = std::asin(std::sqrt(2.0) / 2 / leg);
  EXPECT_NEAR(found[2], 2 * leg * std::sin(2 * half), 1e-14);
}

}  // namespace
}  // namespace remanifold
