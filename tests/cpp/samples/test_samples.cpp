// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/samples.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

namespace remanifold {
namespace {

using testing::Cloud;

TEST(Samples, MergesCoincidingPointsIntoTheFirst) {
  const Cloud cloud{{5, 5, 1, 2, 5, 5, 1, 2, 0, 0}, 2};
  const Samples samples = Samples::from_points(cloud.view());
  EXPECT_EQ(samples.size(), 3);
  EXPECT_EQ(samples.input_size(), 5);
  EXPECT_EQ(samples.representatives(), (std::vector<Index>{0, 1, 0, 1, 4}));
  const std::vector<Index> canonical = samples.canonical_indices();
  for (Index i = 0; i < samples.input_size(); ++i) {
    EXPECT_EQ(samples.input_index(canonical[i]), samples.representatives()[i]);
  }
}

TEST(Samples, MergesTheEndsOfAClosedCurve) {
  Cloud cloud{{}, 2};
  for (int i = 0; i <= 100; ++i) {
    const double angle = 2 * 3.141592653589793 * i / 100;
    cloud.points.push_back(std::cos(angle));
    cloud.points.push_back(std::sin(angle));
  }
  const Samples samples = Samples::from_points(cloud.view());
  EXPECT_EQ(samples.size(), 100);
  EXPECT_EQ(samples.representatives()[100], 0);
  // What differs by more than rounding stays.
  cloud.points[201] += 1e-13;
  EXPECT_EQ(Samples::from_points(cloud.view()).size(), 101);
}

TEST(Samples, NumbersEveryDistinctPointOnce) {
  const Cloud cloud = testing::gaussian(500, 4, 1);
  const Samples samples = Samples::from_points(cloud.view());
  std::set<Index> seen;
  for (Index i = 0; i < samples.size(); ++i) {
    seen.insert(samples.input_index(i));
    for (int j = 0; j < cloud.dim; ++j) {
      EXPECT_EQ(samples.point(i)[j] * samples.scale(),
                cloud[samples.input_index(i)][j]);
    }
  }
  EXPECT_EQ(seen.size(), 500U);
}

TEST(Samples, ScalesExactly) {
  const Cloud cloud = testing::gaussian(50, 3, 2);
  const Samples reference = Samples::from_points(cloud.view());
  for (const int exponent : {-900, -20, 20, 900}) {
    Cloud scaled = cloud;
    for (double& x : scaled.points) {
      x = std::ldexp(x, exponent);
    }
    const Samples samples = Samples::from_points(scaled.view());
    EXPECT_EQ(samples.scale(), std::ldexp(reference.scale(), exponent));
    for (Index i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(samples.squared_distance(0, i), reference.squared_distance(0, i));
    }
  }
}

TEST(Samples, SurvivesTheWholeRangeOfDoubles) {
  const Cloud offset{{1e308, 0, 1e308, 1e-10, 1e308, 2e-10}, 2};
  EXPECT_EQ(Samples::from_points(offset.view()).size(), 3);
  const double huge = std::numeric_limits<double>::max();
  const Cloud wide{{-huge, huge, 0.0, 1e-300}, 1};
  const Samples samples = Samples::from_points(wide.view());
  for (Index i = 1; i < samples.size(); ++i) {
    EXPECT_TRUE(std::isfinite(samples.squared_distance(0, i)));
    EXPECT_GT(samples.squared_distance(0, i), 0);
  }
  EXPECT_EQ(samples.size(), 3);  // 1e-300 is zero beside 1e308
  const double tiny = std::numeric_limits<double>::denorm_min();
  const Cloud narrow{{0.0, tiny, 2 * tiny}, 1};
  EXPECT_EQ(Samples::from_points(narrow.view()).size(), 3);
}

TEST(Samples, ProductsAgreeWhateverTheyComeFrom) {
  const Cloud cloud = testing::gaussian(20, 6, 3);
  const std::vector<double> gram = testing::gram_of(cloud);
  const std::vector<double> distances = testing::distances_of(cloud);
  const Samples points = Samples::from_points(cloud.view());
  const Samples by_gram = Samples::from_gram({gram.data(), 20, 20});
  const Samples by_distances = Samples::from_distances({distances.data(), 20, 20});
  const std::vector<Index> canonical = points.canonical_indices();
  const double unit = points.scale() * points.scale();
  for (Index x = 0; x < 5; ++x) {
    for (Index a = 0; a < 20; ++a) {
      for (Index b = 0; b < 20; ++b) {
        const double expected =
            unit * points.inner_product(canonical[x], canonical[a], canonical[b]);
        EXPECT_NEAR(by_gram.inner_product(x, a, b) * by_gram.scale() * by_gram.scale(),
                    expected, 1e-12);
        EXPECT_NEAR(by_distances.inner_product(x, a, b) * by_distances.scale() *
                        by_distances.scale(),
                    expected, 1e-12);
      }
    }
  }
}

TEST(Samples, MergesCoincidingRowsOfMatrices) {
  const Cloud cloud{{0, 0, 3, 4, 0, 0, 1, 1}, 2};
  const std::vector<double> gram = testing::gram_of(cloud);
  const std::vector<double> distances = testing::distances_of(cloud);
  const std::vector<Index> expected{0, 1, 0, 3};
  EXPECT_EQ(Samples::from_gram({gram.data(), 4, 4}).representatives(), expected);
  EXPECT_EQ(Samples::from_distances({distances.data(), 4, 4}).representatives(),
            expected);
}

TEST(Samples, RefusesBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> with_nan{0, 1, nan, 2};
  const std::vector<double> asymmetric{1, 2, 0, 1};
  const std::vector<double> negative{0, -1, -1, 0};
  const std::vector<double> diagonal{1, 1, 1, 0};
  EXPECT_THROW(Samples::from_points({nullptr, 0, 3}), std::invalid_argument);
  EXPECT_THROW(Samples::from_points({with_nan.data(), 2, 0}), std::invalid_argument);
  EXPECT_THROW(Samples::from_gram({with_nan.data(), 1, 4}), std::invalid_argument);
  EXPECT_THROW(Samples::from_gram({asymmetric.data(), 2, 2}), std::invalid_argument);
  EXPECT_THROW(Samples::from_distances({negative.data(), 2, 2}), std::invalid_argument);
  EXPECT_THROW(Samples::from_distances({diagonal.data(), 2, 2}), std::invalid_argument);
  try {
    Samples::from_points({with_nan.data(), 2, 2});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "points[1, 0] is not finite");
  }
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

}  // namespace
}  // namespace remanifold
