// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/link_repair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;
using testing::Numbered;

/// Hexagons at two heights, a sample between them and one beyond each.
Cloud two_hexagons() {
  Cloud cloud{{0, 0, 0}, 3};
  for (const double height : {-0.5, 0.5}) {
    for (int i = 0; i < 6; ++i) {
      const double angle = std::acos(-1.0) * i / 3;
      cloud.points.insert(cloud.points.end(),
                          {std::cos(angle), std::sin(angle), height});
    }
  }
  for (const double height : {-1.0, 1.0}) {
    cloud.points.insert(cloud.points.end(), {0, 0, height});
  }
  return cloud;
}

SimplexArray fan(Index apex, Index first, SimplexArray simplices) {
  for (Index i = 0; i < 6; ++i) {
    std::vector<Index> row{apex, first + i, first + (i + 1) % 6};
    std::sort(row.begin(), row.end());
    simplices.vertices.insert(simplices.vertices.end(), row.begin(), row.end());
  }
  return simplices;
}

std::vector<Index> singular(const SimplexArray& simplices, Index count) {
  return singular_vertices(simplices, std::vector<std::uint8_t>(count, 1));
}

/// Over each hexagon two pyramids; those that look at each other share their apex.
SimplexArray two_bipyramids() {
  return fan(14, 7, fan(0, 7, fan(13, 1, fan(0, 1, {3, {}}))));
}

SimplexArray repaired(SimplexArray simplices) {
  const Numbered given(two_hexagons());
  repair_links(
      given.samples, std::vector<double>(15, 1.0), std::vector<std::uint8_t>(15, 1),
      [](const Index*) { return 20.0; }, simplices);
  return simplices;
}

TEST(LinkRepair, OneOfTwoSheetsLetsGoOfACommonVertex) {
  ASSERT_EQ(singular(two_bipyramids(), 15), std::vector<Index>{0});
  const SimplexArray simplices = repaired(two_bipyramids());
  EXPECT_TRUE(singular(simplices, 15).empty());
  const Topology topology = compute_topology(simplices, 15);
  EXPECT_EQ(topology.components, 2);
  EXPECT_TRUE(topology.closed);
  // A hexagon with the sample has six triangles, one without it four.
  EXPECT_EQ(simplices.size(), 6 + 6 + 6 + 4);
}

TEST(LinkRepair, LeavesWhatIsRightAlone) {
  const SimplexArray simplices = fan(13, 1, fan(0, 1, {3, {}}));
  EXPECT_EQ(repaired(simplices).size(), simplices.size());
}

}  // namespace
}  // namespace remanifold
