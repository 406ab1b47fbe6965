// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace remanifold {
namespace {

using testing::Cloud;

/// By sorting all samples, ties by number.
std::vector<Index> sorted_others(const Samples& samples, Index x) {
  std::vector<Index> others;
  for (Index q = 0; q < samples.size(); ++q) {
    if (q != x) {
      others.push_back(q);
    }
  }
  std::sort(others.begin(), others.end(), [&](Index a, Index b) {
    const double da = samples.squared_distance(x, a);
    const double db = samples.squared_distance(x, b);
    return da != db ? da < db : a < b;
  });
  return others;
}

void expect_exact(const Cloud& cloud, SearchMethod method, Index count) {
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples, {method});
  const Neighborhoods found = find_neighborhoods(samples, search, count, {2, nullptr});
  ASSERT_EQ(found.count, std::min(count, samples.size() - 1));
  for (Index x = 0; x < samples.size(); ++x) {
    const std::vector<Index> expected = sorted_others(samples, x);
    for (Index k = 0; k < found.count; ++k) {
      ASSERT_EQ(found.of(x)[k], expected[k]) << "sample " << x << ", neighbor " << k;
    }
  }
}

class ExactSearch : public ::testing::TestWithParam<SearchMethod> {};

TEST_P(ExactSearch, RandomPoints) {
  for (const int dim : {1, 2, 3, 7, 30}) {
    expect_exact(testing::gaussian(400, dim, dim), GetParam(), 20);
  }
}

TEST_P(ExactSearch, ManyNeighbors) {
  expect_exact(testing::gaussian(300, 3, 5), GetParam(), 150);
  expect_exact(testing::gaussian(10, 3, 5), GetParam(), 50);
}

TEST_P(ExactSearch, TiesOfGrids) {
  expect_exact(testing::grid(15, 2), GetParam(), 20);
  expect_exact(testing::grid(6, 3), GetParam(), 30);
  expect_exact(testing::grid(3, 4), GetParam(), 70);
}

TEST_P(ExactSearch, SurfacesUnevenlySampled) {
  expect_exact(testing::sphere(1500, 2, 10), GetParam(), 20);
  // Densities a million to one, and samples in between that have their neighbors in both.
  Cloud cloud = testing::gaussian(900, 3, 11);
  for (Offset i = 0; i < 600; ++i) {
    for (int j = 0; j < 3; ++j) {
      cloud.points[i * 3 + j] *= i < 300 ? 1e-3 : 1e-2;
    }
  }
  expect_exact(cloud, GetParam(), 16);
}

TEST_P(ExactSearch, FarFromTheOrigin) {
  Cloud cloud = testing::gaussian(300, 3, 6);
  for (double& x : cloud.points) {
    x += 1e7;
  }
  expect_exact(cloud, GetParam(), 20);
}

TEST_P(ExactSearch, OneSample) {
  const Cloud cloud{{1, 2}, 2};
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples, {GetParam()});
  EXPECT_EQ(find_neighborhoods(samples, search, 5).count, 0);
}

TEST_P(ExactSearch, CutsAtTheRadiusInclusively) {
  const Cloud cloud = testing::grid(5, 1);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples, {GetParam()});
  const auto query = search.query();
  const Index middle = samples.canonical_indices()[2];
  std::vector<Neighbor> found;
  query->nearest(middle, 4, samples.squared_distance(middle, middle + 1), found);
  EXPECT_EQ(found.size(), 2U);
}

INSTANTIATE_TEST_SUITE_P(Methods, ExactSearch,
                         ::testing::Values(SearchMethod::kKdTree,
                                           SearchMethod::kBruteForce));

/// Neighbors and distances of every `step`-th sample, to the last bit.
void expect_exact_distances(const Cloud& cloud, Index count, Index step) {
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples, {SearchMethod::kBruteForce});
  const Neighborhoods found = find_neighborhoods(samples, search, count, {2, nullptr});
  ASSERT_EQ(found.squared_distances.size(), found.indices.size());
  for (Index x = 0; x < samples.size(); x += step) {
    const std::vector<Index> expected = sorted_others(samples, x);
    for (Index k = 0; k < found.count; ++k) {
      ASSERT_EQ(found.of(x)[k], expected[k]) << "sample " << x << ", neighbor " << k;
      ASSERT_EQ(found.squared_distances[Offset{x} * found.count + k],
                samples.squared_distance(x, expected[k]));
    }
  }
}

TEST(Neighborhoods, DistancesOfBruteForce) {
  for (const int dim : {3, 8, 255, 256, 259, 1030}) {
    expect_exact_distances(testing::gaussian(261, dim, dim), 20, 1);
  }
  expect_exact_distances(testing::grid(6, 3), 30, 1);
}

TEST(Neighborhoods, MoreProductsThanAreKept) {
  expect_exact_distances(testing::gaussian(8300, 9, 1), 20, 83);
}

// Two clusters so far apart that single precision sees one point in each, and copies that
// no product tells apart.
TEST(Neighborhoods, ProductsOfFewDigits) {
  Cloud cloud = testing::gaussian(400, 200, 4);
  for (Offset i = 0; i < cloud.size(); ++i) {
    double* p = cloud.points.data() + i * cloud.dim;
    if (i % 4 == 3) {
      std::copy_n(p - cloud.dim, cloud.dim, p);
    }
    for (int j = 0; j < cloud.dim; ++j) {
      p[j] = p[j] * (i % 4 == 3 ? 1 + 1e-9 : 1) + (i < 200 ? 0.0 : 1e5);
    }
  }
  expect_exact_distances(cloud, 20, 1);
}

// A lattice, where many are equally far, less a part of which all neighbors are gone.
TEST(Neighborhoods, WhatIsKeptIsWhatWouldBeFound) {
  Cloud cloud{{}, 3};
  for (int i = 0; i < 1000; ++i) {
    cloud.points.insert(cloud.points.end(),
                        {i % 10 + 0.0, i / 10 % 10 + 0.0, i / 100 + 0.0});
  }
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples, {SearchMethod::kKdTree});
  std::vector<Index> left_out;
  for (Index x = 0; x < samples.size(); ++x) {
    const double* p = samples.point(x);
    if (x % 50 == 0 || (p[0] != p[1] && p[2] == samples.point(0)[2])) {
      left_out.push_back(x);
    }
  }
  const Samples kept = samples.without(left_out);
  const NeighborSearch again(kept, {SearchMethod::kKdTree});
  for (const Index known : {12, 20}) {
    const Neighborhoods found = keep_neighborhoods(
        find_neighborhoods(samples, search, known), left_out, kept, again, 12);
    EXPECT_EQ(found.count, 12);
    EXPECT_EQ(found.indices, find_neighborhoods(kept, again, 12).indices);
  }
}

TEST(Neighborhoods, TheFirstOfEach) {
  const Cloud cloud = testing::gaussian(50, 3, 7);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples, {SearchMethod::kBruteForce});
  const Neighborhoods all = find_neighborhoods(samples, search, 20);
  for (const Index count : {1, 7, 20, 30}) {
    const Neighborhoods first = nearest_of(all, count);
    const Neighborhoods found =
        find_neighborhoods(samples, search, std::min(count, 20));
    EXPECT_EQ(first.count, found.count);
    EXPECT_EQ(first.indices, found.indices);
    EXPECT_EQ(first.squared_distances, found.squared_distances);
  }
}

TEST(Neighborhoods, AnyPositionByTheKdTree) {
  const Cloud cloud = testing::gaussian(200, 3, 7);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples, {SearchMethod::kKdTree});
  const auto query = search.query();
  std::vector<Neighbor> found;
  ASSERT_TRUE(query->nearest_to(samples.point(17), 1,
                                std::numeric_limits<double>::infinity(), found));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].index, 17);
}

TEST(Neighborhoods, ApproximateSearchReportsItsRecall) {
  const Cloud cloud = testing::gaussian(3000, 20, 8);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch exact(samples, {SearchMethod::kBruteForce});
  EXPECT_EQ(measure_recall(samples, exact, 20, 50), 1.0);
  const NeighborSearch rough(samples, {SearchMethod::kApproximate, 32});
  const NeighborSearch careful(samples, {SearchMethod::kApproximate, 2000});
  const double low = measure_recall(samples, rough, 20, 50);
  const double high = measure_recall(samples, careful, 20, 50);
  EXPECT_LT(low, 1.0);
  EXPECT_GT(high, low);
}

TEST(Neighborhoods, RefusesTreesWithoutPoints) {
  const std::vector<double> gram{1, 0, 0, 1};
  const Samples samples = Samples::from_gram({gram.data(), 2, 2});
  EXPECT_THROW(NeighborSearch(samples, {SearchMethod::kKdTree}), std::invalid_argument);
  EXPECT_EQ(NeighborSearch(samples).method(), SearchMethod::kBruteForce);
}

TEST(Neighborhoods, StopsWhenCancelled) {
  const Cloud cloud = testing::gaussian(2000, 3, 9);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  Progress progress;
  progress.cancel = true;
  for (const int threads : {1, 2}) {
    EXPECT_THROW(find_neighborhoods(samples, search, 20, {threads, &progress}),
                 Cancelled);
  }
}

}  // namespace
}  // namespace remanifold
