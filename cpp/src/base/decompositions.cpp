// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/decompositions.hpp"

#include <Eigen/QR>

template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& Eigen::SelfAdjointEigenSolver<
    Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&, int);

namespace remanifold::detail {

Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> factors(columns);
  return factors.householderQ() *
         Eigen::MatrixXd::Identity(columns.rows(), columns.cols());
}

}  // namespace remanifold::detail
