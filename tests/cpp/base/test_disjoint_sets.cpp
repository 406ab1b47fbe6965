// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/disjoint_sets.hpp"

#include <gtest/gtest.h>

namespace remanifold {
namespace {

TEST(DisjointSets, TheLowestMemberStandsForEachSet) {
  detail::DisjointSets sets(6);
  sets.join(4, 5);
  sets.join(2, 5);
  sets.join(1, 0);
  EXPECT_EQ(sets.find(5), 2);
  EXPECT_EQ(sets.find(4), 2);
  EXPECT_EQ(sets.find(1), 0);
  EXPECT_EQ(sets.find(3), 3);
}

}  // namespace
}  // namespace remanifold
