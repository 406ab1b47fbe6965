// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/quadratic_design.hpp"

namespace remanifold::detail {
namespace {

/// Pivots of the normal matrix below this are rounding.
constexpr double kSingular = 1e-10;

}  // namespace

void QuadraticDesign::set(const Coordinates& tangent, const Eigen::VectorXd& weights) {
  const auto dim = static_cast<int>(tangent.cols());
  terms_.resize(tangent.rows(), unknowns(dim));
  terms_.col(0).setOnes();
  terms_.middleCols(1, dim) = tangent;
  int column = 1 + dim;
  for (int i = 0; i < dim; ++i) {
    for (int j = 0; j <= i; ++j) {
      terms_.col(column++) = terms_.col(1 + i).cwiseProduct(terms_.col(1 + j));
    }
  }
  weighted_ = weights.asDiagonal() * terms_;
  // Product by product: blocks of larger ones would have to be packed first.
  normal_.resize(terms_.cols(), terms_.cols());
  for (Eigen::Index i = 0; i < normal_.rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      normal_(i, j) = terms_.col(i).dot(weighted_.col(j));
    }
  }
  const auto num_fitted = (weights.array() > 0).count();
  for (const int candidate : {unknowns(dim), 1 + dim, 1}) {
    if (decompose(candidate, num_fitted)) {
      break;
    }
  }
}

bool QuadraticDesign::decompose(int num_unknowns, Eigen::Index num_fitted) {
  num_unknowns_ = num_unknowns;
  if (num_unknowns > 1 && num_fitted < num_unknowns) {
    return false;
  }
  const Eigen::MatrixXd normal = normal_.topLeftCorner(num_unknowns, num_unknowns);
  factors_.compute(normal);
  if (factors_.info() != Eigen::Success) {
    return num_unknowns == 1;
  }
  const auto pivots = factors_.matrixLLT().diagonal().array();
  return num_unknowns == 1 ||
         pivots.minCoeff() * pivots.minCoeff() > kSingular * normal(0, 0);
}

Eigen::MatrixXd QuadraticDesign::fit(const Coordinates& values) const {
  Eigen::MatrixXd result(num_unknowns_, values.cols());
  const Eigen::MatrixXd& lower = factors_.matrixLLT();
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    auto unknowns = result.col(column);
    for (int i = 0; i < num_unknowns_; ++i) {
      unknowns[i] = weighted_.col(i).dot(values.col(column));
    }
    // A handful of unknowns: in place, without the library's blocks.
    for (int i = 0; i < num_unknowns_; ++i) {
      for (int j = 0; j < i; ++j) {
        unknowns[i] -= lower(i, j) * unknowns[j];
      }
      unknowns[i] /= lower(i, i);
    }
    for (int i = num_unknowns_ - 1; i >= 0; --i) {
      for (int j = i + 1; j < num_unknowns_; ++j) {
        unknowns[i] -= lower(j, i) * unknowns[j];
      }
      unknowns[i] /= lower(i, i);
    }
  }
  return result;
}

}  // namespace remanifold::detail
