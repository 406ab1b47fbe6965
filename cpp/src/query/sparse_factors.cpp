// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/sparse_factors.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <stdexcept>

namespace remanifold {

struct SparseFactors::Factors {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double, Eigen::ColMajor, Index>> solver;
};

SparseFactors::SparseFactors(const std::vector<Index>& offsets,
                             const std::vector<Index>& rows,
                             const std::vector<double>& values)
    : factors_(std::make_unique<Factors>()) {
  const auto size = static_cast<Index>(offsets.size()) - 1;
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::ColMajor, Index>> matrix(
      size, size, static_cast<Eigen::Index>(rows.size()), offsets.data(), rows.data(),
      values.data());
  factors_->solver.compute(matrix);
  if (factors_->solver.info() != Eigen::Success) {
    throw std::invalid_argument("the matrix of a sparse system is singular");
  }
}

SparseFactors::SparseFactors(SparseFactors&&) noexcept = default;
SparseFactors& SparseFactors::operator=(SparseFactors&&) noexcept = default;
SparseFactors::~SparseFactors() = default;

Index SparseFactors::size() const {
  return static_cast<Index>(factors_->solver.rows());
}

Offset SparseFactors::entries() const {
  return factors_->solver.matrixL().nestedExpression().nonZeros();
}

std::vector<double> SparseFactors::solve(const std::vector<double>& right) const {
  const Eigen::Map<const Eigen::VectorXd> given(
      right.data(), static_cast<Eigen::Index>(right.size()));
  std::vector<double> result(right.size());
  Eigen::Map<Eigen::VectorXd>(result.data(), given.size()) =
      factors_->solver.solve(given);
  return result;
}

}  // namespace remanifold
