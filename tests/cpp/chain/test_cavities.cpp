// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/cavities.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace remanifold {
namespace {

using testing::SquareHole;

TEST(Cavities, SquareHole) {
  SquareHole hole;
  const Cavities cavities = hole.find(7);
  EXPECT_EQ(
      testing::rows(cavities.candidates),
      (std::vector<std::vector<Index>>{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(cavities.count(), 1);
  EXPECT_EQ(cavities.candidates_in.size(0), 4);
  EXPECT_EQ(testing::rows(cavities.facets),
            (std::vector<std::vector<Index>>{
                {0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
  // 4 is the third vertex of the first fixed triangle, and so on.
  EXPECT_EQ(cavities.rims, (std::vector<FacetNumber>{2, kOpen, 11, 5, kOpen, 8}));
  EXPECT_EQ(cavities.prices, std::vector<double>(6, 7.0));
  EXPECT_TRUE(cavities.dead_ends.empty());
  EXPECT_EQ(cavities.facets_of[0], 3);  // 12 is opposite to 0 in 012
  for (Index c = 0; c < 4; ++c) {
    EXPECT_DOUBLE_EQ(cavities.energies[c],
                     hole.ruler.energy(cavities.candidates[c], 3));
  }
}

TEST(Cavities, NoRoomBehindAFacetWithBothCofaces) {
  SquareHole hole;
  hole.fixed.vertices.insert(hole.fixed.vertices.end(), {0, 1, 6});
  const Cavities cavities = hole.find(7);
  EXPECT_EQ(testing::rows(cavities.candidates),
            (std::vector<std::vector<Index>>{{0, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(cavities.count(), 1);
  // Nothing continues a fixed triangle without candidates.
  hole.candidates.vertices = {0, 2, 3};
  EXPECT_EQ(hole.find(7).dead_ends, (std::vector<FacetNumber>{5}));
}

TEST(Cavities, ApartWhereNoFacetIsShared) {
  SquareHole hole;
  hole.candidates.vertices = {0, 1, 2, 0, 1, 3, 4, 5, 6};
  hole.inside.assign(8, 1);
  const Cavities cavities = hole.find(7);
  EXPECT_EQ(cavities.count(), 2);
  EXPECT_EQ(cavities.candidates_in.size(0), 2);
  EXPECT_EQ(cavities.candidates_in.size(1), 1);
  EXPECT_EQ(cavities.facets_in.size(0), 5);
}

TEST(Cavities, WhatCostsMoreThanItsFacetsIsNoCandidate) {
  SquareHole hole;
  const std::vector<double> energies = hole.find(1000).energies;
  const double most = *std::max_element(energies.begin(), energies.end());
  // Three facets of price one each: the candidate of most energy is just worth it.
  EXPECT_EQ(hole.find(most / 3 * 1.001).candidates.size(), 4);
  const Cavities fewer = hole.find(most / 3 * 0.999);
  EXPECT_EQ(fewer.candidates.size(), 3);
  const Cavities none = hole.find(0.01);
  EXPECT_EQ(none.count(), 0);
  EXPECT_EQ(none.dead_ends.size(), 4U);
}

}  // namespace
}  // namespace remanifold
