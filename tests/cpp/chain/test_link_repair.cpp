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

/// Hexagons at two heights with a sample in the middle between them.
Cloud two_hexagons() {
  Cloud cloud{{0, 0, 0.1}, 3};
  for (const double height : {0.0, 1.0}) {
    for (int i = 0; i < 6; ++i) {
      const double angle = std::acos(-1.0) * i / 3;
      cloud.points.insert(cloud.points.end(),
                          {std::cos(angle), std::sin(angle), height});
    }
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

TEST(LinkRepair, OneOfTwoSheetsLetsGoOfACommonVertex) {
  const Numbered given(two_hexagons());
  SimplexArray simplices = fan(0, 7, fan(0, 1, {3, {}}));
  ASSERT_EQ(singular(simplices, 13), std::vector<Index>{0});
  repair_links(
      given.samples, std::vector<double>(13, 1.0), std::vector<std::uint8_t>(13, 1),
      [](const Index*) { return 20.0; }, simplices);
  EXPECT_TRUE(singular(simplices, 13).empty());
  const Topology topology = compute_topology(simplices, 13);
  EXPECT_EQ(topology.components, 2);
  // A hexagon with the sample has six triangles, one without it four.
  EXPECT_EQ(simplices.size(), 10);
}

TEST(LinkRepair, LeavesWhatIsRightAlone) {
  const Numbered given(two_hexagons());
  const SimplexArray simplices = fan(0, 1, {3, {}});
  SimplexArray repaired = simplices;
  repair_links(
      given.samples, std::vector<double>(13, 1.0), std::vector<std::uint8_t>(13, 1),
      [](const Index*) { return 20.0; }, repaired);
  EXPECT_EQ(repaired.size(), simplices.size());
  EXPECT_TRUE(singular(repaired, 13).empty());
}

}  // namespace
}  // namespace remanifold
