// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace remanifold {
namespace {

using testing::Cloud;

TangentSpaces tangents_of(const Samples& samples, TangentOptions options) {
  const NeighborSearch search(samples);
  const Neighborhoods neighborhoods =
      find_neighborhoods(samples, search, std::max(options.num_neighbors, 1));
  return compute_tangent_spaces(samples, neighborhoods, options);
}

Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
basis_of(const TangentSpaces& tangents, const Samples& samples, Index i) {
  const Offset size = static_cast<Offset>(tangents.dim) * samples.ambient_dim();
  return {tangents.bases.data() + i * size, tangents.dim, samples.ambient_dim()};
}

class EveryEstimator : public ::testing::TestWithParam<Estimator> {};

TEST_P(EveryEstimator, RowsAreOrthonormal) {
  for (int dim = 1; dim <= 5; ++dim) {
    for (const int ambient_dim : {dim, dim + 1, 80}) {
      const Cloud cloud = testing::gaussian(60, ambient_dim, dim);
      const Samples samples = Samples::from_points(cloud.view());
      const Index count = dim < 4 ? 10 * dim : 15;
      const TangentSpaces tangents = tangents_of(samples, {dim, count, GetParam()});
      for (Index i = 0; i < samples.size(); ++i) {
        const auto basis = basis_of(tangents, samples, i);
        if (tangents.boundary[i] != 0) {
          EXPECT_TRUE(std::isnan(basis(0, 0)));
          continue;
        }
        const Eigen::MatrixXd product = basis * basis.transpose();
        EXPECT_LT((product - Eigen::MatrixXd::Identity(dim, dim)).norm(), 1e-12);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Estimators, EveryEstimator,
                         ::testing::Values(Estimator::kEnclosure, Estimator::kPca,
                                           Estimator::kJet));

/// Largest sine of an angle between a basis of a sphere's tangent space and the truth.
double sphere_error(Estimator estimator, Offset n) {
  const Cloud cloud = testing::sphere(n, 2, 1);
  const Samples samples = Samples::from_points(cloud.view());
  const TangentSpaces tangents = tangents_of(samples, {2, 20, estimator});
  std::vector<double> sines;
  for (Index i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d normal =
        Eigen::Map<const Eigen::Vector3d>(samples.point(i)).normalized();
    sines.push_back((basis_of(tangents, samples, i) * normal).norm());
  }
  std::nth_element(sines.begin(), sines.begin() + sines.size() / 2, sines.end());
  return sines[sines.size() / 2];
}

TEST(TangentSpaces, JetIsOfSecondOrder) {
  // Four times the samples is half the spacing.
  EXPECT_LT(sphere_error(Estimator::kJet, 4000),
            sphere_error(Estimator::kPca, 4000) / 4);
  const double ratio =
      sphere_error(Estimator::kJet, 1000) / sphere_error(Estimator::kJet, 16000);
  EXPECT_GT(ratio, 10);  // 16 in the limit, 4 for an estimator of first order
  const double pca =
      sphere_error(Estimator::kPca, 1000) / sphere_error(Estimator::kPca, 16000);
  EXPECT_LT(pca, 7);
}

TEST(TangentSpaces, FirstEnclosingPairOnALine) {
  // From 2: ranks 3, 0, 6, 7. {3, 0} encloses 2 and nothing else.
  const Cloud cloud{{0, 2, 3, 6, 7}, 1};
  const Samples samples = Samples::from_points(cloud.view());
  const TangentSpaces tangents = tangents_of(samples, {1, 4, Estimator::kEnclosure});
  const std::vector<Index> canonical = samples.canonical_indices();
  const auto tuple = [&](Index i, int k) {
    const Index vertex = tangents.simplices[canonical[i] * 2 + k];
    return vertex < 0 ? -1 : samples.input_index(vertex);
  };
  EXPECT_EQ(tuple(1, 0), 2);
  EXPECT_EQ(tuple(1, 1), 0);
  EXPECT_EQ(tuple(0, 0), -1);  // an end of the line has none
  EXPECT_EQ(tangents.boundary[canonical[0]], 1);
  EXPECT_EQ(tangents.boundary[canonical[4]], 1);
  EXPECT_EQ(tangents.boundary[canonical[2]], 0);
}

TEST(TangentSpaces, DependentTuplesAreSkipped) {
  // All neighbors on one line through x: no triple spans a plane.
  const Cloud line{{0, 0, 1, 0, -1, 0, 2, 0, -2, 0, 3, 0}, 2};
  const Samples samples = Samples::from_points(line.view());
  const TangentSpaces tangents = tangents_of(samples, {2, 5, Estimator::kEnclosure});
  EXPECT_EQ(std::count(tangents.boundary.begin(), tangents.boundary.end(), 1), 6);
  const TangentSpaces fitted = tangents_of(samples, {2, 5, Estimator::kPca});
  EXPECT_EQ(std::count(fitted.boundary.begin(), fitted.boundary.end(), 1), 6);
}

TEST(TangentSpaces, SameTuplesFromProducts) {
  const Cloud cloud = testing::gaussian(60, 12, 4);
  const std::vector<double> gram = testing::gram_of(cloud);
  const Samples points = Samples::from_points(cloud.view());
  const Samples products = Samples::from_gram({gram.data(), 60, 60});
  for (int dim = 1; dim <= 3; ++dim) {
    const TangentOptions options{dim, 10 * dim, Estimator::kEnclosure};
    const TangentSpaces a = to_input(points, tangents_of(points, options));
    const TangentSpaces b = to_input(products, tangents_of(products, options));
    EXPECT_EQ(a.simplices, b.simplices);
    EXPECT_EQ(a.boundary, b.boundary);
  }
}

TEST(TangentSpaces, RefusesImpossibleOptions) {
  const Cloud cloud = testing::gaussian(20, 3, 1);
  const Samples samples = Samples::from_points(cloud.view());
  EXPECT_THROW(tangents_of(samples, {0, 10}), std::invalid_argument);
  EXPECT_THROW(tangents_of(samples, {4, 10}), std::invalid_argument);
  EXPECT_THROW(tangents_of(samples, {2, 2}), std::invalid_argument);
}

}  // namespace
}  // namespace remanifold
