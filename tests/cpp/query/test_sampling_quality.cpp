// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace remanifold {
namespace {

using testing::Cloud;

SimplexArray result_of(const Samples& samples, int dim) {
  ReconstructOptions options;
  options.dim = dim;
  options.outlier_distance = 0;
  return reconstruct(samples, options).simplices;
}

SamplingQuality quality_of(const Cloud& cloud, int dim, int num_threads = 1) {
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  Execution execution;
  execution.num_threads = num_threads;
  return measure_quality(samples, search, result_of(samples, dim), {dim, 0}, execution);
}

TEST(SamplingQuality, SphereHasItsReach) {
  for (int dim = 1; dim <= 3; ++dim) {
    const SamplingQuality quality = quality_of(testing::sphere(1000, dim, 1), dim);
    for (std::size_t i = 0; i < quality.reach.size(); ++i) {
      EXPECT_NEAR(quality.reach[i], 1, 0.2);
      EXPECT_GT(quality.tangent_share[i], 0.7);
      EXPECT_EQ(quality.rim[i], 0);
      EXPECT_EQ(quality.nearest_strange[i], std::numeric_limits<double>::infinity());
    }
  }
}

TEST(SamplingQuality, NarrowFitsScatterLess) {
  const SamplingQuality quality = quality_of(testing::sphere(1000, 2, 1), 2);
  double narrow = 0;
  double wide = 0;
  for (std::size_t i = 0; i < quality.scatter.size(); ++i) {
    narrow += quality.scatter[i];
    wide += quality.wide_scatter[i];
  }
  // Of even order on a sphere: the fourth power of the width, over twice the samples.
  EXPECT_GT(wide, 3 * narrow);
}

TEST(SamplingQuality, AllThreadsGiveTheSame) {
  const Cloud cloud = testing::sphere(3000, 2, 2);
  const SamplingQuality one = quality_of(cloud, 2, 1);
  const SamplingQuality four = quality_of(cloud, 2, 4);
  EXPECT_EQ(one.reach, four.reach);
  EXPECT_EQ(one.scatter, four.scatter);
  EXPECT_EQ(one.tangent_share, four.tangent_share);
  EXPECT_EQ(one.fold, four.fold);
  EXPECT_EQ(one.gap, four.gap);
}

TEST(SamplingQuality, TwoPatchesOfNeighborsAreStrangers) {
  // Two triangles above each other, further than three edges apart in the result.
  const Cloud cloud{{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, .1, 1, 0, .1, 0, 1, .1}, 3};
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  const SamplingQuality quality =
      measure_quality(samples, search, {3, {0, 1, 2, 3, 4, 5}}, {2, 0});
  for (const double distance : quality.nearest_strange) {
    EXPECT_NEAR(distance, 0.1, 1e-12);
  }
  EXPECT_EQ(quality.rim, std::vector<std::uint8_t>(6, 2));
}

TEST(SamplingQuality, SharpFoldsCountAwayFromTheRim) {
  // An octahedron: its faces meet at 109.5 degrees.
  const Cloud cloud{{1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1}, 3};
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  const SimplexArray faces{
      3, {0, 2, 4, 0, 2, 5, 0, 3, 4, 0, 3, 5, 1, 2, 4, 1, 2, 5, 1, 3, 4, 1, 3, 5}};
  for (const double fold : measure_quality(samples, search, faces, {2, 0}).fold) {
    EXPECT_NEAR(fold, 70.5288, 1e-3);
  }
  SimplexArray open = faces;
  open.vertices.resize(3);
  for (const double fold : measure_quality(samples, search, open, {2, 0}).fold) {
    EXPECT_EQ(fold, 0);
  }
}

}  // namespace
}  // namespace remanifold
