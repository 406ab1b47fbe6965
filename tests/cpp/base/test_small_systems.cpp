// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/decompositions.hpp"
#include "base/small_systems.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace remanifold::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRounding = 1e-11;

MatrixXd random_matrix(int rows, int columns, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST(SmallSystems, SolveSquareSystems) {
  std::mt19937 random(1);
  for (int size = 1; size <= 8; ++size) {
    for (int trial = 0; trial < 20; ++trial) {
      const MatrixXd given = random_matrix(size, size, random);
      const VectorXd solution = random_matrix(size, 1, random);
      MatrixXd matrix = given;
      VectorXd right = given * solution;
      const double determinant = solve_square(matrix, right);
      EXPECT_LT((given * right - given * solution).norm(), kRounding * given.norm());
      // By Laplace's expansion along the first row.
      double expected = size == 1 ? given(0, 0) : 0;
      for (int j = 0; size > 1 && j < size; ++j) {
        MatrixXd minor(size - 1, size - 1);
        for (int k = 0; k < size - 1; ++k) {
          minor.col(k) = given.col(k < j ? k : k + 1).tail(size - 1);
        }
        expected += (j % 2 == 0 ? 1 : -1) * given(0, j) * determinant_of(minor);
      }
      EXPECT_NEAR(determinant, expected, kRounding * (1 + std::abs(expected)));
    }
  }
}

TEST(SmallSystems, RowsAreExchangedWhereThePivotIsZero) {
  MatrixXd matrix(3, 3);
  matrix << 0, 2, 0, 0, 0, 4, 1, 0, 0;
  VectorXd right(3);
  right << 2, 12, 7;
  EXPECT_EQ(solve_square(matrix, right), 8);
  EXPECT_EQ(right, VectorXd(Eigen::Vector3d(7, 1, 3)));
}

TEST(SmallSystems, SingularMatricesHaveNoDeterminant) {
  MatrixXd matrix(3, 3);
  matrix << 1, 2, 3, 2, 4, 6, 1, 1, 1;
  EXPECT_EQ(determinant_of(matrix), 0);
}

TEST(SmallSystems, FactorsOfFixedAndOfDynamicSizeSolveAlike) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const MatrixXd rows = random_matrix(4, 6, random);
    const MatrixXd gram = rows * rows.transpose();
    const VectorXd solution = random_matrix(4, 1, random);
    VectorXd right = gram * solution;
    Eigen::Vector4d fixed_right = right;
    SymmetricFactors<Eigen::Dynamic> factors;
    SymmetricFactors<4> fixed;
    factors.compute(gram);
    fixed.compute(gram);
    factors.solve(right);
    fixed.solve(fixed_right);
    EXPECT_EQ(right, VectorXd(fixed_right));
    EXPECT_LT((gram * (right - solution)).norm(), kRounding * gram.norm());
    MatrixXd copy = gram;
    EXPECT_NEAR(factors.determinant() / determinant_of(copy), 1, 1e-8);
    for (int i = 0; i < 4; ++i) {
      EXPECT_GT(factors.pivot(i), 0);
    }
    EXPECT_EQ(factors.pivot(0), gram.diagonal().maxCoeff());
  }
}

TEST(SmallSystems, DirectionsWithoutAPivotAreLeftOut) {
  MatrixXd gram = MatrixXd::Zero(3, 3);
  gram(0, 0) = 2;
  gram(2, 2) = 8;
  SymmetricFactors<Eigen::Dynamic> factors;
  factors.compute(gram);
  Eigen::Vector3d right(4, 5, 8);
  factors.solve(right);
  EXPECT_EQ(right, Eigen::Vector3d(2, 0, 1));
  EXPECT_EQ(factors.determinant(), 0);
}

TEST(Decompositions, ColumnsAreMadeOrthonormal) {
  std::mt19937 random(3);
  const MatrixXd columns = random_matrix(9, 4, random);
  const MatrixXd basis = orthonormal_columns(columns);
  EXPECT_LT((basis.transpose() * basis - MatrixXd::Identity(4, 4)).norm(), kRounding);
  EXPECT_LT((basis * (basis.transpose() * columns) - columns).norm(), kRounding * 10);
}

TEST(Decompositions, DependentColumnsAreCompleted) {
  MatrixXd columns = MatrixXd::Zero(5, 3);
  columns.col(0).setOnes();
  columns.col(1).setOnes();
  const MatrixXd basis = orthonormal_columns(columns);
  EXPECT_LT((basis.transpose() * basis - MatrixXd::Identity(3, 3)).norm(), kRounding);
}

}  // namespace
}  // namespace remanifold::detail
