// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/star_consensus.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace remanifold {
namespace {

TEST(StarConsensus, VotesAreCounted) {
  LocalRegions regions;
  regions.dim = 2;
  // 0 sees {0 1 2}; 1 and 2 see it and {1 2 3}; 3 sees {0 2 3} only.
  regions.star_offsets = {0, 1, 3, 5, 6};
  regions.star_starts = {0, 2, 6, 10, 12};
  regions.edge_sets = {{0, 2, 5, 8, 10}, {1, 2, 0, 2, 3, 0, 1, 3, 0, 2}};
  // {1 2}; {0 2} and {2 3}; {0 1} and {1 3}; {0 2}.
  regions.stars = {0, 1, 0, 1, 1, 2, 0, 1, 1, 2, 0, 1};
  StarSimplices found = count_votes(regions);
  ASSERT_EQ(found.simplices.size(), 3);
  std::vector<std::pair<std::vector<Index>, int>> votes;
  for (Offset s = 0; s < 3; ++s) {
    votes.emplace_back(testing::rows(found.simplices)[s], found.votes[s]);
    EXPECT_EQ(found.agreed(s), found.votes[s] == 3);
  }
  std::sort(votes.begin(), votes.end());
  EXPECT_EQ(votes, (std::vector<std::pair<std::vector<Index>, int>>{
                       {{0, 1, 2}, 3}, {{0, 2, 3}, 1}, {{1, 2, 3}, 2}}));
}

}  // namespace
}  // namespace remanifold
