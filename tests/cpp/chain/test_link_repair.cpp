// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/link_repair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;
using testing::Numbered;

/// Polygons at two heights, a sample between them and one beyond each.
Cloud two_polygons(Index sides) {
  Cloud cloud{{0, 0, 0}, 3};
  for (const double height : {-0.5, 0.5}) {
    for (Index i = 0; i < sides; ++i) {
      const double angle = 2 * std::acos(-1.0) * i / sides;
      cloud.points.insert(cloud.points.end(),
                          {std::cos(angle), std::sin(angle), height});
    }
  }
  for (const double height : {-1.0, 1.0}) {
    cloud.points.insert(cloud.points.end(), {0, 0, height});
  }
  return cloud;
}

SimplexArray fan(Index apex, Index first, Index sides, SimplexArray simplices) {
  for (Index i = 0; i < sides; ++i) {
    std::vector<Index> row{apex, first + i, first + (i + 1) % sides};
    std::sort(row.begin(), row.end());
    simplices.vertices.insert(simplices.vertices.end(), row.begin(), row.end());
  }
  return simplices;
}

std::vector<Index> singular(const SimplexArray& simplices, Index count) {
  return singular_vertices(simplices, std::vector<std::uint8_t>(count, 1));
}

/// Over each polygon two pyramids; those that look at each other share their apex.
SimplexArray two_bipyramids(Index sides) {
  const Index below = 1;
  const Index above = 1 + sides;
  const Index last = 2 * sides + 1;
  return fan(
      last + 1, above, sides,
      fan(0, above, sides, fan(last, below, sides, fan(0, below, sides, {3, {}}))));
}

SimplexArray repaired(SimplexArray simplices, Index sides = 6,
                      const std::vector<Index>& cut = {}) {
  const Numbered given(two_polygons(sides));
  const Index count = given.samples.size();
  EXPECT_EQ(repair_links(
                given.samples, std::vector<double>(count, 1.0),
                std::vector<std::uint8_t>(count, 1), [](const Index*) { return 20.0; },
                simplices),
            cut);
  return simplices;
}

TEST(LinkRepair, OneOfTwoSheetsLetsGoOfACommonVertex) {
  ASSERT_EQ(singular(two_bipyramids(6), 15), std::vector<Index>{0});
  const SimplexArray simplices = repaired(two_bipyramids(6));
  EXPECT_TRUE(singular(simplices, 15).empty());
  const Topology topology = compute_topology(simplices, 15);
  EXPECT_EQ(topology.components, 2);
  EXPECT_TRUE(topology.closed);
  // A hexagon with the sample has six triangles, one without it four.
  EXPECT_EQ(simplices.size(), 6 + 6 + 6 + 4);
}

// With so many sides no hole around the common vertex is refilled.
TEST(LinkRepair, WhatNoMoveMendsIsCutAndTold) {
  const Index sides = 13;
  const Index count = 2 * sides + 3;
  ASSERT_EQ(singular(two_bipyramids(sides), count), std::vector<Index>{0});
  const SimplexArray simplices = repaired(two_bipyramids(sides), sides, {0});
  EXPECT_TRUE(singular(simplices, count).empty());
  const Topology topology = compute_topology(simplices, count);
  EXPECT_EQ(topology.components, 2);
  EXPECT_EQ(simplices.size(), 3 * sides);
}

TEST(LinkRepair, WhatThereIsNoWorkForIsCutAndTold) {
  const Numbered given(two_polygons(6));
  const Index count = given.samples.size();
  for (const auto& [work, cut] : {std::pair(Offset{0}, std::vector<Index>{0}),
                                  std::pair(Offset{100}, std::vector<Index>{})}) {
    SimplexArray simplices = two_bipyramids(6);
    EXPECT_EQ(repair_links(
                  given.samples, std::vector<double>(count, 1.0),
                  std::vector<std::uint8_t>(count, 1),
                  [](const Index*) { return 20.0; }, simplices, {}, work),
              cut);
    EXPECT_TRUE(singular(simplices, count).empty());
  }
}

TEST(LinkRepair, CutsWithoutLookingForMore) {
  const Numbered given(two_polygons(6));
  const Index count = given.samples.size();
  SimplexArray simplices = two_bipyramids(6);
  const std::vector<Index> bad = singular(simplices, count);
  ASSERT_EQ(bad.size(), 1U);
  EXPECT_TRUE(
      cut_links(given.samples, std::vector<std::uint8_t>(count, 0), simplices).empty());
  EXPECT_EQ(cut_links(given.samples, std::vector<std::uint8_t>(count, 1), simplices),
            bad);
  EXPECT_TRUE(singular(simplices, count).empty());
  EXPECT_EQ(simplices.size(), 24 - 6);
}

TEST(LinkRepair, LevelsSpikesAndLeavesHills) {
  // A hexagon with six triangles around its middle, and a ring of twelve outside.
  for (const auto& [height, spikes] : {std::pair(2.5, 1), std::pair(1.0, 0)}) {
    Cloud cloud{{0, 0, height}, 3};
    for (const auto& [sides, radius] : {std::pair(6, 1.0), std::pair(12, 2.0)}) {
      for (int i = 0; i < sides; ++i) {
        const double angle = 2 * std::acos(-1.0) * i / sides;
        cloud.points.insert(cloud.points.end(),
                            {radius * std::cos(angle), radius * std::sin(angle), 0});
      }
    }
    SimplexArray simplices = fan(0, 1, 6, {3, {}});
    for (Index i = 0; i < 6; ++i) {
      const Index next = (i + 1) % 6;
      for (std::vector<Index> row :
           {std::vector<Index>{1 + i, 7 + 2 * i, 8 + 2 * i},
            std::vector<Index>{1 + i, 1 + next, 8 + 2 * i},
            std::vector<Index>{1 + next, 8 + 2 * i, 7 + (2 * i + 2) % 12}}) {
        std::sort(row.begin(), row.end());
        simplices.vertices.insert(simplices.vertices.end(), row.begin(), row.end());
      }
    }
    const Numbered given(cloud);
    ASSERT_TRUE(singular(simplices, 19).empty());
    const std::vector<double> scales(19, 1 / given.samples.scale());
    const std::vector<Index> found = level_spikes(given.samples, scales, simplices);
    EXPECT_EQ(found, std::vector<Index>(spikes, 0)) << height;
    EXPECT_EQ(simplices.size(), 24 - 2 * spikes);
    EXPECT_TRUE(singular(simplices, 19).empty());
    EXPECT_EQ(compute_topology(simplices, 19).euler_characteristic, 1);
  }
}

TEST(LinkRepair, LeavesWhatIsRightAlone) {
  const SimplexArray simplices = fan(13, 1, 6, fan(0, 1, 6, {3, {}}));
  EXPECT_EQ(repaired(simplices).size(), simplices.size());
}

}  // namespace
}  // namespace remanifold
