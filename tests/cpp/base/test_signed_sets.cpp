// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/signed_sets.hpp"

#include <gtest/gtest.h>

namespace remanifold {
namespace {

TEST(SignedSets, SignsMultiplyAlongTheWay) {
  detail::SignedSets<Offset> sets(4);
  EXPECT_TRUE(sets.join(0, 1, -1));
  EXPECT_TRUE(sets.join(2, 3, -1));
  EXPECT_TRUE(sets.join(1, 3, 1));
  // 0 is -1 times 1, which is 3, which is -1 times 2.
  EXPECT_TRUE(sets.join(0, 2, 1));
  EXPECT_FALSE(sets.join(0, 2, -1));
}

TEST(SignedSets, AnOddWayAroundContradicts) {
  detail::SignedSets<Offset> sets(3);
  EXPECT_TRUE(sets.join(0, 1, -1));
  EXPECT_TRUE(sets.join(1, 2, -1));
  EXPECT_FALSE(sets.join(2, 0, -1));
}

}  // namespace
}  // namespace remanifold
