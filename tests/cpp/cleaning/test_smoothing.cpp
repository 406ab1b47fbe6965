// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/smoothing.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <tuple>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

/// From the unit sphere, the root of the mean square.
double distance_to_sphere(const Samples& samples, const std::vector<double>& points) {
  const auto dim = static_cast<std::size_t>(samples.ambient_dim());
  double sum = 0;
  for (Index i = 0; i < samples.size(); ++i) {
    double square = 0;
    for (std::size_t axis = 0; axis < dim; ++axis) {
      square += points[i * dim + axis] * points[i * dim + axis];
    }
    const double away = std::sqrt(square) * samples.scale() - 1;
    sum += away * away;
  }
  return std::sqrt(sum / samples.size());
}

/// Normal noise in each coordinate.
Cloud noisy(Cloud cloud, double noise) {
  const Cloud moves = testing::gaussian(cloud.size(), cloud.dim, 3);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    cloud.points[i] += noise * moves.points[i];
  }
  return cloud;
}

Smoothing smoothed(const Cloud& cloud, int dim, Index num_neighbors = 0) {
  const Samples samples = Samples::from_points(cloud.view());
  SmoothingOptions options;
  options.dim = dim;
  options.num_neighbors = num_neighbors;
  options.only_noise = num_neighbors == 0;
  return smooth(samples, NeighborSearch(samples), options);
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

class SmoothingOfSpheres : public ::testing::TestWithParam<std::tuple<int, Offset>> {};

// Noise of about two spacings.
TEST_P(SmoothingOfSpheres, TakesNearlyTheBestSize) {
  const auto [dim, size] = GetParam();
  const double spacing = dim == 1 ? 0.0016 : dim == 2 ? 0.028 : 0.09;
  const Cloud cloud = noisy(testing::sphere(size, dim, 1), 2 * spacing);
  const Samples samples = Samples::from_points(cloud.view());
  const Smoothing own = smoothed(cloud, dim);
  ASSERT_FALSE(own.points.empty());
  // Balls of the size where scatter grows least hold less of what is far off.
  EXPECT_NEAR(own.noise * samples.scale(), 2 * spacing, 0.2 * 2 * spacing);
  double best = 1;
  for (Index count = 20; count < samples.size() / 2; count *= 2) {
    const Smoothing one = smoothed(cloud, dim, count);
    EXPECT_EQ(one.num_neighbors, count);
    best = std::min(best, distance_to_sphere(samples, one.points));
  }
  const double error = distance_to_sphere(samples, own.points);
  EXPECT_LT(error, 1.5 * best);
  // What is said to remain does.
  EXPECT_LT(error, 1.5 * own.remaining_error * samples.scale());
  EXPECT_GT(error, 0.5 * own.remaining_error * samples.scale());
  EXPECT_GE(own.resolution, own.remaining_error);
  EXPECT_FALSE(own.drowned);
  EXPECT_EQ(own.fitting_dim, dim);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, SmoothingOfSpheres,
                         ::testing::Values(std::tuple(1, 2000), std::tuple(2, 4000),
                                           std::tuple(3, 6000)));

/// Independent samples of two segments so many of their spacings apart.
Cloud two_segments(double spacings, double noise) {
  const Cloud draws = testing::gaussian(800, 2, 7);
  Cloud cloud{{}, 2};
  for (Index i = 0; i < draws.size(); ++i) {
    // Uniform: the normal distribution function of a normal.
    const double x = 0.5 * std::erfc(-draws[i][0] / std::sqrt(2.0));
    cloud.points.push_back(x);
    cloud.points.push_back((i % 2 * spacings + noise * draws[i][1]) / 400);
  }
  return cloud;
}

TEST(Smoothing, KeepsToOneSheet) {
  for (const double spacings : {12.5, 25.0}) {
    const double noise = 0.3;
    const Cloud cloud = two_segments(spacings, noise);
    const Samples samples = Samples::from_points(cloud.view());
    const Smoothing one = smoothed(cloud, 1);
    ASSERT_FALSE(one.points.empty());
    // Neighborhoods are wider than the two are apart.
    EXPECT_GT(one.num_neighbors, spacings);
    EXPECT_NEAR(one.noise * samples.scale() * 400, noise, 0.2 * noise);
    double farthest = 0;
    for (Index i = 0; i < samples.size(); ++i) {
      const double from = samples.point(i)[1];
      const double move = (one.points[2 * i + 1] - from) * samples.scale() * 400;
      farthest = std::max(farthest, std::abs(move));
    }
    EXPECT_LT(farthest, 5 * noise);
  }
}

TEST(Smoothing, TakesTwoLayersForNoNoise) {
  const Cloud cloud = two_segments(3, 0);
  const Smoothing one = smoothed(cloud, 1);
  EXPECT_TRUE(one.layers);
  EXPECT_TRUE(one.points.empty());
  EXPECT_EQ(one.num_neighbors, 0);
  // Asked for, they are joined.
  EXPECT_FALSE(smoothed(cloud, 1, 60).points.empty());
}

TEST(Smoothing, KnowsNoiseThatDrownsTheShape) {
  const Smoothing drowned = smoothed(noisy(testing::sphere(3000, 2, 1), 0.35), 2);
  EXPECT_TRUE(drowned.drowned || drowned.fitting_dim == 3);
}

TEST(Smoothing, SaysWhichDimensionFits) {
  Cloud ball = testing::sphere(2000, 2, 1);
  for (Offset i = 0; i < ball.size(); ++i) {
    // Radii of a uniform ball.
    const double radius = std::cbrt((static_cast<double>(i) + 0.5) / 2000);
    for (int axis = 0; axis < 3; ++axis) {
      ball.points[3 * i + axis] *= radius;
    }
  }
  const Cloud sphere = testing::sphere(2000, 2, 1);
  EXPECT_EQ(smoothed(ball, 3).fitting_dim, 3);
  EXPECT_EQ(smoothed(ball, 2).fitting_dim, 3);
  EXPECT_EQ(smoothed(sphere, 3).fitting_dim, 2);
  EXPECT_EQ(smoothed(sphere, 2).fitting_dim, 2);
  EXPECT_EQ(smoothed(sphere, 1).fitting_dim, 2);
  EXPECT_EQ(smoothed(testing::sphere(1000, 1, 1), 2).fitting_dim, 1);
  // Too few samples to tell.
  EXPECT_EQ(smoothed(testing::sphere(100, 2, 1), 1).fitting_dim, 1);
}

TEST(Smoothing, LeavesALatticeAlone) {
  Cloud plane = testing::grid(40, 2);
  const Smoothing one = smoothed(plane, 2);
  EXPECT_TRUE(one.points.empty());
  EXPECT_EQ(one.fitting_dim, 2);
}

TEST(Smoothing, FewSamplesAreNoNoise) {
  for (Offset size = 1; size < 12; ++size) {
    const Smoothing one = smoothed(testing::sphere(size, 2, 1), 2);
    EXPECT_TRUE(one.points.empty()) << size;
    EXPECT_EQ(one.fitting_dim, 2) << size;
  }
}

// Of samples nearer to each other than what remains of the noise some are vertices.
TEST(Smoothing, IsThinnedToTheResolution) {
  const Cloud cloud = noisy(testing::sphere(3000, 2, 1), 0.1);
  const Samples samples = Samples::from_points(cloud.view());
  ReconstructOptions options;
  options.dim = 2;
  options.smooth = true;
  const Reconstruction result = reconstruct(samples, options);
  const Cleaning& cleaning = result.cleaning;
  ASSERT_GT(cleaning.attached.size(), 1000U);
  ASSERT_LT(cleaning.attached.size(), 2900U);
  EXPECT_EQ(cleaning.displacements.size(), 9000U);
  std::vector<std::uint8_t> left_out(3000, 0);
  for (const Index i : cleaning.attached) {
    left_out[i] = 1;
  }
  for (const Index i : result.simplices.vertices) {
    EXPECT_EQ(left_out[i], 0);
  }
  const auto squared = [&](Index a, Index b) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double away = cloud[a][axis] + cleaning.displacements[3 * a + axis] -
                          cloud[b][axis] - cleaning.displacements[3 * b + axis];
      sum += away * away;
    }
    return sum;
  };
  const double least = cleaning.resolution * cleaning.resolution;
  for (Index i = 0; i < 3000; ++i) {
    double nearest = 9;
    for (Index k = 0; k < 3000; ++k) {
      if (k != i && left_out[k] == 0) {
        nearest = std::min(nearest, squared(i, k));
      }
    }
    EXPECT_EQ(nearest <= least * (1 + 1e-9), left_out[i] == 1) << i;
  }
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
