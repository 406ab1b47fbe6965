// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/outliers.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

std::vector<Index> outliers_of(const Samples& samples, double distance = 2) {
  const NeighborSearch search(samples);
  const Neighborhoods neighborhoods = find_neighborhoods(samples, search, 15);
  std::vector<Index> found;
  for (const Index x :
       find_outliers(samples, search, neighborhoods, {2, distance}).samples) {
    found.push_back(samples.input_index(x));
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Outliers, AreThoseFarFromTheSphere) {
  const Cloud cloud = testing::noisy_sphere(800, 0.0, 40);
  const std::vector<Index> found = outliers_of(Samples::from_points(cloud.view()));
  ASSERT_EQ(found.size(), 40U);
  EXPECT_EQ(found.front(), 800);
}

TEST(Outliers, AreNoneOnACleanSphere) {
  EXPECT_TRUE(
      outliers_of(Samples::from_points(testing::noisy_sphere(800, 0.0, 0).view()))
          .empty());
}

TEST(Outliers, AreClutterWhereTheyLieAnywhere) {
  const auto are_clutter = [](const Cloud& cloud) {
    const Samples samples = Samples::from_points(cloud.view());
    const NeighborSearch search(samples);
    const Outliers found = find_outliers(
        samples, search, find_neighborhoods(samples, search, 15), {2, 2.0});
    EXPECT_GE(found.samples.size(), 20U);
    return found.are_clutter;
  };
  EXPECT_TRUE(are_clutter(testing::noisy_sphere(800, 0.0, 40)));
  // A sphere with spikes of a sample each, all of them 3 local scales high.
  Cloud spiky = testing::noisy_sphere(2000, 0.0, 0);
  for (std::size_t i = 0; i < 3 * 2000; i += 3 * 80) {
    for (int axis = 0; axis < 3; ++axis) {
      spiky.points.push_back(1.32 * spiky.points[i + axis]);
    }
  }
  EXPECT_FALSE(are_clutter(spiky));
}

TEST(Outliers, RefuseNonsense) {
  const Samples samples =
      Samples::from_points(testing::noisy_sphere(50, 0.0, 0).view());
  EXPECT_THROW(outliers_of(samples, 0), std::invalid_argument);
  EXPECT_THROW(outliers_of(samples, std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace remanifold
