// SPDX-License-Identifier: GPL-3.0-or-later
#include "query/surface_fits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace remanifold {
namespace {

using Point = std::array<double, 3>;
constexpr Index kNarrow = 15;
constexpr Index kWide = 30;
constexpr double kFrame[6] = {1, 0, 0, 0, 1, 0};

/// Points of z = (a x^2 + b y^2) / 2, nearest first.
std::vector<Point> paraboloid(double a, double b, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Point> points;
  for (Index i = 0; i < kWide; ++i) {
    const double x = uniform(random);
    const double y = uniform(random);
    points.push_back({x, y, (a * x * x + b * y * y) / 2});
  }
  const auto length = [](const Point& p) {
    return p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
  };
  std::sort(points.begin(), points.end(),
            [&](const Point& p, const Point& q) { return length(p) < length(q); });
  return points;
}

void place(detail::SurfaceFits& fits, int lane, const std::vector<Point>& points) {
  const Point origin{};
  fits.set_sample(lane, origin.data(), 0.5, kFrame);
  for (Index i = 0; i < kWide; ++i) {
    fits.set_neighbor(lane, i, points[static_cast<std::size_t>(i)].data());
  }
}

TEST(SurfaceFits, FindsTheCurvatureOfQuadrics) {
  detail::SurfaceFits fits(kNarrow, kWide);
  const double largest[4] = {0.5, 2, 1, 0.25};
  for (int lane = 0; lane < 4; ++lane) {
    place(fits, lane,
          paraboloid(largest[lane], -largest[lane] / 2,
                     1U + static_cast<unsigned>(lane)));
  }
  fits.fit();
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_NEAR(fits.curvature(lane), largest[lane], 1e-9);
    EXPECT_LT(fits.scatter(lane), 1e-12);
    EXPECT_LT(fits.wide_scatter(lane), 1e-12);
    // No more than curvature allows, and more than half of it at these distances.
    EXPECT_GE(fits.reach(lane), 1 / largest[lane]);
    EXPECT_LT(fits.reach(lane), 4 / largest[lane]);
  }
}

TEST(SurfaceFits, LanesDoNotDependOnEachOther) {
  const std::vector<Point> points = paraboloid(1.5, 0.3, 7);
  detail::SurfaceFits alone(kNarrow, kWide);
  place(alone, 0, points);
  for (int lane = 1; lane < 4; ++lane) {
    alone.leave_out(lane);
  }
  alone.fit();
  detail::SurfaceFits among(kNarrow, kWide);
  for (int lane = 0; lane < 3; ++lane) {
    place(among, lane, paraboloid(0.1 * lane, 3, 20U + static_cast<unsigned>(lane)));
  }
  place(among, 3, points);
  among.fit();
  EXPECT_EQ(alone.scatter(0), among.scatter(3));
  EXPECT_EQ(alone.wide_scatter(0), among.wide_scatter(3));
  EXPECT_EQ(alone.curvature(0), among.curvature(3));
  EXPECT_EQ(alone.reach(0), among.reach(3));
}

TEST(SurfaceFits, SaysNothingWhereNeighborsLieOnALine) {
  std::vector<Point> points;
  for (Index i = 0; i < kWide; ++i) {
    points.push_back({0.1 * (i + 1), 0, 0});
  }
  detail::SurfaceFits fits(kNarrow, kWide);
  for (int lane = 0; lane < 4; ++lane) {
    place(fits, lane, points);
  }
  fits.fit();
  EXPECT_TRUE(std::isnan(fits.scatter(1)));
  EXPECT_TRUE(std::isnan(fits.wide_scatter(1)));
  EXPECT_TRUE(std::isnan(fits.curvature(1)));
  EXPECT_TRUE(std::isinf(fits.reach(1)));  // flat
}

}  // namespace
}  // namespace remanifold
