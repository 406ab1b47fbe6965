// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/smoothing.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

double distance_to_sphere(const Samples& samples, const std::vector<double>& points) {
  double sum = 0;
  for (Index i = 0; i < samples.size(); ++i) {
    const double* p = points.data() + 3 * static_cast<std::size_t>(i);
    const double away = std::hypot(p[0], p[1], p[2]) * samples.scale() - 1;
    sum += away * away;
  }
  return std::sqrt(sum / samples.size());
}

TEST(Smoothing, BringsNoisySamplesToTheSphere) {
  const Cloud cloud = testing::noisy_sphere(2000, 0.02, 0);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  SmoothingOptions options;
  options.dim = 2;
  const Smoothing smoothed = smooth(samples, search, options);
  EXPECT_GE(smoothed.num_neighbors, 40);
  EXPECT_NEAR(smoothed.noise * samples.scale(), 0.02, 0.002);
  ASSERT_EQ(smoothed.points.size(), 6000U);
  EXPECT_LT(distance_to_sphere(samples, smoothed.points), 0.006);
  for (const int threads : {1, 3}) {
    EXPECT_EQ(smooth(samples, search, options, {threads, nullptr}).points,
              smoothed.points);
  }
}

TEST(Smoothing, LeavesACleanSphereAlone) {
  const Samples samples =
      Samples::from_points(testing::noisy_sphere(2000, 0.0, 0).view());
  SmoothingOptions options;
  options.dim = 2;
  const Smoothing smoothed = smooth(samples, NeighborSearch(samples), options);
  EXPECT_TRUE(smoothed.points.empty());
  EXPECT_EQ(smoothed.num_neighbors, 0);
  EXPECT_LT(smoothed.noise * samples.scale(), 1e-4);
}

TEST(Smoothing, RefusesNonsense) {
  const Cloud cloud = testing::noisy_sphere(50, 0.0, 0);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  SmoothingOptions options;
  EXPECT_THROW(smooth(samples, search, options), std::invalid_argument);
  options.dim = 4;
  EXPECT_THROW(smooth(samples, search, options), std::invalid_argument);
  options.dim = 2;
  options.num_neighbors = 2;
  EXPECT_THROW(smooth(samples, search, options), std::invalid_argument);
  const std::vector<double> gram = testing::gram_of(cloud);
  const Samples products = Samples::from_gram({gram.data(), 50, 50});
  options.num_neighbors = 0;
  EXPECT_THROW(smooth(products, NeighborSearch(products), options),
               std::invalid_argument);
}

}  // namespace
}  // namespace remanifold
