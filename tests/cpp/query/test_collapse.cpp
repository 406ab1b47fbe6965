// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "query/collapse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace remanifold::detail {
namespace {

using testing::kProjectivePlane;
using testing::simplex_boundary;

/// The simplices of two complexes on vertices of their own, joined pairwise.
SimplexArray join(const SimplexArray& a, const SimplexArray& b) {
  const Index shift = 1 + *std::max_element(a.vertices.begin(), a.vertices.end());
  SimplexArray result{a.arity + b.arity, {}};
  for (Offset s = 0; s < a.size(); ++s) {
    for (Offset t = 0; t < b.size(); ++t) {
      result.vertices.insert(result.vertices.end(), a[s], a[s] + a.arity);
      for (int i = 0; i < b.arity; ++i) {
        result.vertices.push_back(b[t][i] + shift);
      }
    }
  }
  return result;
}

SimplexArray polygon(Index corners) {
  SimplexArray result{2, {}};
  for (Index i = 0; i < corners; ++i) {
    const Index next = (i + 1) % corners;
    result.vertices.insert(result.vertices.end(),
                           {std::min(i, next), std::max(i, next)});
  }
  return result;
}

TEST(Collapse, SpheresWithoutASimplex) {
  for (int dim = 1; dim <= 6; ++dim) {
    EXPECT_TRUE(collapses_to_point(simplex_boundary(dim), true)) << dim;
    EXPECT_FALSE(collapses_to_point(simplex_boundary(dim), false)) << dim;
  }
  EXPECT_TRUE(collapses_to_point(join(polygon(9), polygon(20)), true));
  EXPECT_TRUE(collapses_to_point(join(polygon(30), simplex_boundary(2)), true));
}

TEST(Collapse, Balls) {
  for (int dim = 1; dim <= 5; ++dim) {
    SimplexArray ball = simplex_boundary(dim);
    ball.vertices.resize(ball.vertices.size() - ball.arity);
    EXPECT_TRUE(collapses_to_point(ball, false)) << dim;
  }
}

TEST(Collapse, NothingElse) {
  EXPECT_FALSE(collapses_to_point(kProjectivePlane, true));
  // Its suspension has the homology of a sphere over Z3.
  const SimplexArray two_points{1, {0, 1}};
  EXPECT_FALSE(collapses_to_point(join(kProjectivePlane, two_points), true));
  SimplexArray two = simplex_boundary(3);
  for (const Index v : simplex_boundary(3).vertices) {
    two.vertices.push_back(v + 5);
  }
  EXPECT_FALSE(collapses_to_point(two, true));
  EXPECT_FALSE(collapses_to_point(SimplexArray{3, {}}, true));
  // More vertices than it is made for.
  EXPECT_FALSE(collapses_to_point(polygon(500), true));
}

}  // namespace
}  // namespace remanifold::detail
