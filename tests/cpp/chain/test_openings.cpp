// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/opening_finder.hpp"
#include "complex/simplex_rows.hpp"
#include "remanifold/simplex_measures.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace remanifold {
namespace {

using detail::OpeningLevels;
using detail::weigh_openings;
using detail::WeighedOpenings;

/// Samples, and a complex on them in canonical numbers.
struct Given {
  Samples samples;
  SimplexArray simplices;
  Neighborhoods near;
  std::vector<double> scales;

  Given(const std::vector<double>& points, int columns, SimplexArray given)
      : samples(Samples::from_points(
            {points.data(), static_cast<Offset>(points.size()) / columns, columns})),
        simplices(std::move(given)) {
    const std::vector<Index> canonical = samples.canonical_indices();
    for (Index& v : simplices.vertices) {
      v = canonical[v];
    }
    for (Offset s = 0; s < simplices.size(); ++s) {
      std::sort(simplices.vertices.begin() + s * simplices.arity,
                simplices.vertices.begin() + (s + 1) * simplices.arity);
    }
    simplices = detail::sorted_unique(simplices);
    const NeighborSearch search(samples);
    near = find_neighborhoods(samples, search, std::min<Index>(30, samples.size() - 1));
    scales = local_scales(samples, near, simplices.arity - 1);
  }

  WeighedOpenings weigh(double significance, int threads = 1) const {
    Execution execution;
    execution.num_threads = threads;
    return weigh_openings(samples, near, scales, {}, simplices, {significance, 1.0, {}},
                          execution);
  }
};

/// A closed curve through points on the unit circle, a gap among them.
Given circle(int count, double gap, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<double> angles(count);
  for (double& angle : angles) {
    angle = gap + (2 * 3.14159265358979 - gap) *
                      (static_cast<double>(random()) / 4294967296.0);
  }
  std::sort(angles.begin(), angles.end());
  std::vector<double> points;
  SimplexArray edges{2, {}};
  for (int i = 0; i < count; ++i) {
    points.push_back(std::cos(angles[i]));
    points.push_back(std::sin(angles[i]));
    edges.vertices.push_back(i);
    edges.vertices.push_back((i + 1) % count);
  }
  return Given(points, 2, std::move(edges));
}

/// A grid of unit squares, cut into triangles, with a square of samples taken out of its
/// middle and two triangles in their place.
Given grid(int width, int hole) {
  std::vector<double> points;
  std::vector<std::vector<Index>> number(width, std::vector<Index>(width, -1));
  const int low = (width - hole) / 2;
  const int high = low + hole;
  const auto inside = [&](int i) { return low <= i && i < high; };
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < width; ++j) {
      if (!inside(i) || !inside(j)) {
        number[i][j] = static_cast<Index>(points.size() / 3);
        points.insert(points.end(), {double(i), double(j), 0.0});
      }
    }
  }
  SimplexArray triangles{3, {}};
  const auto add = [&](Index a, Index b, Index c) {
    triangles.vertices.insert(triangles.vertices.end(), {a, b, c});
  };
  for (int i = 0; i + 1 < width; ++i) {
    for (int j = 0; j + 1 < width; ++j) {
      const Index a = number[i][j], b = number[i + 1][j];
      const Index c = number[i][j + 1], d = number[i + 1][j + 1];
      if (a >= 0 && b >= 0 && c >= 0 && d >= 0) {
        add(a, b, d);
        add(a, c, d);
      }
    }
  }
  if (hole > 0) {
    // A fan over the rim of the hole.
    std::vector<Index> rim;
    for (int i = low - 1; i < high; ++i) rim.push_back(number[i][low - 1]);
    for (int j = low - 1; j < high; ++j) rim.push_back(number[high][j]);
    for (int i = high; i > low - 1; --i) rim.push_back(number[i][high]);
    for (int j = high; j > low - 1; --j) rim.push_back(number[low - 1][j]);
    for (std::size_t i = 1; i + 1 < rim.size(); ++i) {
      add(rim[0], rim[i], rim[i + 1]);
    }
  }
  return Given(points, 3, std::move(triangles));
}

TEST(Openings, AGapHasItsMissingSamples) {
  const double gap = 1.0;
  const Given given = circle(400, gap, 1);
  const WeighedOpenings found = given.weigh(1e-3);
  ASSERT_FALSE(found.openings.empty());
  const Opening& opening = found.openings.front();
  EXPECT_EQ(opening.kind, OpeningKind::kGap);
  EXPECT_TRUE(opening.open);
  EXPECT_EQ(opening.simplices.size(), 1);
  ASSERT_EQ(opening.samples.size(), 2U);
  EXPECT_NEAR(opening.volume, 2 * std::sin(gap / 2), 0.1);
  EXPECT_NEAR(opening.missing, gap / (2 * 3.14159 - gap) * 400, 25);
  EXPECT_LT(opening.significance(), 1e-6);
  ASSERT_EQ(found.bridges.size(), 1U);
  const Index* edge = given.simplices[found.bridges[0]];
  EXPECT_EQ(opening.samples, (std::vector<Index>{edge[0], edge[1]}));
}

TEST(Openings, NothingIsOpenedWithoutAGap) {
  int listed = 0;
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    const WeighedOpenings found = circle(200, 0, seed).weigh(1e-4);
    EXPECT_TRUE(found.bridges.empty()) << seed;
    for (const Opening& opening : found.openings) {
      EXPECT_FALSE(opening.open) << seed;
      listed += opening.significance() <= 0.1 ? 1 : 0;
    }
  }
  // One in ten of these, give or take three standard errors.
  EXPECT_GE(listed, 2);
  EXPECT_LE(listed, 20);
}

TEST(Openings, SignificanceIsTheLevelOfTheDecision) {
  const Given given = circle(300, 0.15, 3);
  const WeighedOpenings listed = given.weigh(0);
  EXPECT_TRUE(listed.bridges.empty());
  ASSERT_FALSE(listed.openings.empty());
  const double level = listed.openings.front().significance();
  ASSERT_GT(level, 1e-12);
  ASSERT_LT(level, 0.9);
  EXPECT_TRUE(given.weigh(0.99 * level).bridges.empty());
  EXPECT_FALSE(given.weigh(1.01 * level).bridges.empty());
}

TEST(Openings, TheLeastExpectedComeFirst) {
  const WeighedOpenings found = circle(500, 0, 5).weigh(0);
  for (std::size_t i = 1; i < found.openings.size(); ++i) {
    EXPECT_LE(found.openings[i - 1].expected, found.openings[i].expected);
  }
}

TEST(Openings, AHoleOfALatticeIsSeen) {
  const WeighedOpenings none = grid(24, 0).weigh(1e-3);
  EXPECT_TRUE(none.bridges.empty());
  const Given given = grid(24, 5);
  const WeighedOpenings found = given.weigh(1e-3);
  ASSERT_EQ(found.openings.size(), 1U);
  const Opening& hole = found.openings.front();
  EXPECT_EQ(hole.kind, OpeningKind::kHole);
  EXPECT_TRUE(hole.open);
  // 36 units of area instead of the 11 samples' worth of the triangles that fill it.
  const double unit = given.samples.scale();
  EXPECT_NEAR(hole.volume * unit * unit, 36, 4);
  EXPECT_NEAR(hole.missing, 25, 4);
  EXPECT_NEAR(hole.spacing * unit, 1, 0.05);
  EXPECT_LT(hole.dispersion, 0.5);
  // Bridges are rows, ascending.
  EXPECT_TRUE(std::is_sorted(found.bridges.begin(), found.bridges.end()));
  for (const Offset row : found.bridges) {
    EXPECT_LT(row, given.simplices.size());
  }
}

TEST(Openings, ThreadsDoNotMatter) {
  const Given given = grid(40, 6);
  const WeighedOpenings one = given.weigh(1e-3, 1);
  const WeighedOpenings more = given.weigh(1e-3, 3);
  EXPECT_EQ(one.bridges, more.bridges);
  ASSERT_EQ(one.openings.size(), more.openings.size());
  for (std::size_t i = 0; i < one.openings.size(); ++i) {
    EXPECT_EQ(one.openings[i].samples, more.openings[i].samples);
    EXPECT_EQ(one.openings[i].expected, more.openings[i].expected);
  }
}

TEST(Openings, NoTestBeyondItsDimensionsAndForNothing) {
  Given given = grid(6, 0);
  given.simplices = SimplexArray{3, {}};
  EXPECT_TRUE(given.weigh(0.5).openings.empty());
  given.simplices = SimplexArray{kMaxOpeningDim + 2, {0, 1, 2, 3, 4}};
  EXPECT_TRUE(given.weigh(0.5).openings.empty());
  given = grid(6, 0);
  given.near.count = 0;
  EXPECT_TRUE(given.weigh(0.5).openings.empty());
}

}  // namespace
}  // namespace remanifold
