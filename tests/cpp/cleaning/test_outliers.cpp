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
  for (const Index x : find_outliers(samples, search, neighborhoods, {2, distance})) {
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

TEST(Outliers, RefuseNonsense) {
  const Samples samples =
      Samples::from_points(testing::noisy_sphere(50, 0.0, 0).view());
  EXPECT_THROW(outliers_of(samples, 0), std::invalid_argument);
  EXPECT_THROW(outliers_of(samples, std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace remanifold
