// SPDX-License-Identifier: GPL-3.0-or-later
// What several steps want of Eigen and what takes the compiler longest, compiled once: the
// eigenvectors of a symmetric matrix of any size, orthonormal bases of the span of columns.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

extern template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>&
Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(
    const Eigen::EigenBase<Eigen::MatrixXd>&, int);

namespace remanifold::detail {

/// Reads the lower triangle; eigenvalues ascend. Give compute() a matrix, not a product: an
/// expression has code of its own.
using SymmetricEigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

/// By Householder reflections, completed where columns are dependent.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& columns);

}  // namespace remanifold::detail
