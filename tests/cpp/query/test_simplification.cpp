// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace remanifold {
namespace {

using testing::Cloud;

/// Corners of a simplex, where no two edges are alike for what surrounds them.
Cloud corners(Index count) {
  Cloud cloud{{}, static_cast<int>(count)};
  for (Index i = 0; i < count; ++i) {
    for (Index a = 0; a < count; ++a) {
      cloud.points.push_back(a == i ? 1 + 0.01 * i : 0);
    }
  }
  return cloud;
}

SimplexArray simplified(const Cloud& cloud, const SimplexArray& simplices, Index left,
                        double max_error = 1e9) {
  const std::vector<std::uint8_t> fixed(cloud.size(), 0);
  return simplify(cloud.view(), simplices, fixed, {left, max_error, false}).simplices;
}

TEST(Simplification, LeavesTheSmallestManifoldsAlone) {
  EXPECT_EQ(simplified(corners(6), testing::kProjectivePlane, 1).vertices,
            testing::kProjectivePlane.vertices);
  for (const int dim : {1, 2, 3, 4, 5}) {
    const SimplexArray sphere = testing::simplex_boundary(dim);
    EXPECT_EQ(simplified(corners(dim + 2), sphere, 1).vertices, sphere.vertices);
  }
  // A single simplex: its boundary is closed by a cone.
  EXPECT_EQ(simplified(corners(3), {3, {0, 1, 2}}, 1).size(), 1);
}

TEST(Simplification, TakesOutWhatIsOnALine) {
  const Cloud line{{0, 1, 2.5, 3, 7}, 1};
  const SimplexArray edges{2, {0, 1, 1, 2, 2, 3, 3, 4}};
  EXPECT_EQ(simplified(line, edges, 1).vertices, (std::vector<Index>{0, 4}));
  EXPECT_EQ(simplified(line, edges, 4).size(), 3);
}

TEST(Simplification, KeepsWhatWouldBeTooFar) {
  const Cloud bend{{0, 0, 1, 0.1, 2, 0}, 2};
  const SimplexArray edges{2, {0, 1, 1, 2}};
  EXPECT_EQ(simplified(bend, edges, 1, 0.09).size(), 2);
  EXPECT_EQ(simplified(bend, edges, 1, 0.11).size(), 1);
  const Simplification found =
      simplify(bend.view(), edges, std::vector<std::uint8_t>(3, 0), {1, 1.0, false});
  EXPECT_NEAR(found.errors[1], 0.1, 1e-15);
}

TEST(Simplification, EndsWhenCancelled) {
  const Cloud line{{0, 1, 2}, 1};
  Progress progress;
  progress.cancel = true;
  EXPECT_THROW(simplify(line.view(), {2, {0, 1, 1, 2}}, {0, 0, 0}, {}, {1, &progress}),
               Cancelled);
}

}  // namespace
}  // namespace remanifold
