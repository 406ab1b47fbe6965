// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace remanifold {
namespace {

using testing::Cloud;

/// A sphere of radius one, displaced by noise, and far points after it.
Cloud noisy_sphere(Offset n, double noise, Offset num_outliers) {
  Cloud cloud = testing::sphere(n, 2, 1);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(1.0, noise);
  for (Offset i = 0; i < n; ++i) {
    const double radius = normal(random);
    for (int axis = 0; axis < 3; ++axis) {
      cloud.points[3 * i + axis] *= radius;
    }
  }
  std::uniform_real_distribution<double> box(-2, 2);
  while (cloud.size() < n + num_outliers) {
    const double p[3] = {box(random), box(random), box(random)};
    if (std::abs(std::hypot(p[0], p[1], p[2]) - 1) > 0.6) {
      cloud.points.insert(cloud.points.end(), p, p + 3);
    }
  }
  return cloud;
}

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
  const Cloud cloud = noisy_sphere(800, 0.0, 40);
  const std::vector<Index> found = outliers_of(Samples::from_points(cloud.view()));
  ASSERT_EQ(found.size(), 40U);
  EXPECT_EQ(found.front(), 800);
}

TEST(Outliers, AreNoneOnACleanSphere) {
  EXPECT_TRUE(
      outliers_of(Samples::from_points(noisy_sphere(800, 0.0, 0).view())).empty());
}

TEST(Outliers, RefuseNonsense) {
  const Samples samples = Samples::from_points(noisy_sphere(50, 0.0, 0).view());
  EXPECT_THROW(outliers_of(samples, 0), std::invalid_argument);
  EXPECT_THROW(outliers_of(samples, std::nan("")), std::invalid_argument);
}

TEST(Samples, WithoutSomeKeepTheirInputNumbers) {
  const Cloud cloud{{5, 5, 1, 2, 5, 5, 7, 8, 0, 0}, 2};
  const Samples samples = Samples::from_points(cloud.view());
  const Index left_out = samples.canonical_indices()[2];
  const Samples rest = samples.without({left_out});
  EXPECT_EQ(rest.size(), 3);
  EXPECT_EQ(rest.input_size(), 5);
  const std::vector<Index> canonical = rest.canonical_indices();
  EXPECT_EQ(canonical[0], -1);
  EXPECT_EQ(canonical[2], -1);
  for (const Index i : {1, 3, 4}) {
    EXPECT_EQ(rest.input_index(canonical[i]), i);
    EXPECT_EQ(rest.point(canonical[i])[0] * rest.scale(), cloud[i][0]);
  }
}

TEST(Samples, MovedTogetherAreMerged) {
  const Cloud cloud{{0, 0, 3, 1, 3, 1, 8, 0, 9, 5}, 2};
  const Samples samples = Samples::from_points(cloud.view());
  ASSERT_EQ(samples.size(), 4);
  const std::vector<Index> before = samples.canonical_indices();
  std::vector<double> points(8);
  for (Index i = 0; i < 4; ++i) {
    const Index input = samples.input_index(i);
    // Sample 3 goes to where samples 1 and 2 are.
    const double* to = cloud[input == 3 ? 1 : input];
    points[2 * i] = to[0] / samples.scale();
    points[2 * i + 1] = to[1] / samples.scale();
  }
  const Samples moved = samples.moved_to({points.data(), 4, 2});
  EXPECT_EQ(moved.size(), 3);
  EXPECT_EQ(moved.representatives(), (std::vector<Index>{0, 1, 1, 1, 4}));
  const std::vector<Index> canonical = moved.canonical_indices();
  EXPECT_EQ(moved.input_index(canonical[3]), 1);
  EXPECT_EQ(moved.point(canonical[4])[1] * moved.scale(), 5);
}

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
  const Cloud cloud = noisy_sphere(2000, 0.02, 0);
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
  const Samples samples = Samples::from_points(noisy_sphere(2000, 0.0, 0).view());
  SmoothingOptions options;
  options.dim = 2;
  const Smoothing smoothed = smooth(samples, NeighborSearch(samples), options);
  EXPECT_TRUE(smoothed.points.empty());
  EXPECT_EQ(smoothed.num_neighbors, 0);
  EXPECT_LT(smoothed.noise * samples.scale(), 1e-4);
}

TEST(Smoothing, RefusesNonsense) {
  const Cloud cloud = noisy_sphere(50, 0.0, 0);
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

TEST(Reconstruct, CleansFirst) {
  const Cloud cloud = noisy_sphere(1000, 0.03, 30);
  const Samples samples = Samples::from_points(cloud.view());
  ReconstructOptions options;
  options.dim = 2;
  options.outlier_distance = 2;
  options.smooth = true;
  const Reconstruction result = reconstruct(samples, options);
  ASSERT_EQ(result.cleaning.outliers.size(), 30U);
  EXPECT_EQ(result.cleaning.outliers.front(), 1000);
  ASSERT_EQ(result.cleaning.displacements.size(), 3 * 1030U);
  EXPECT_EQ(result.cleaning.displacements[3 * 1010], 0);
  EXPECT_EQ(result.simplices.size(), 2 * 1000 - 4);
  EXPECT_EQ(result.report.open_facets.size(), 0);
  // Alone it is the same.
  const Cleaning alone = clean(samples, options);
  EXPECT_EQ(alone.outliers, result.cleaning.outliers);
  EXPECT_EQ(alone.displacements, result.cleaning.displacements);
}

}  // namespace
}  // namespace remanifold
