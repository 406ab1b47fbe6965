// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/quadratic_fit.hpp"

#include "base/decompositions.hpp"
#include "base/tolerance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace remanifold::detail {
namespace {

/// Coordinates from which on the leading directions are iterated for instead of all.
constexpr Eigen::Index kIteratedCoordinates = 24;
/// Directions beyond the K wanted ones that are carried along: what mixes with them does
/// not matter.
constexpr Eigen::Index kSpareDirections = 4;
/// How far beyond the fitted rows, in units of their radius, the quadric is followed.
constexpr double kFarthest = 1.5;
/// A row that alone determines the quadric there says nothing about itself.
constexpr double kLeastFreedom = 1e-3;

}  // namespace

Eigen::MatrixXd leading_directions(const Eigen::MatrixXd& rows, Eigen::Index count,
                                   Eigen::VectorXd& squares, int iterations) {
  const Eigen::Index size = rows.cols();
  if (size < kIteratedCoordinates) {
    Eigen::MatrixXd products(size, size);  // its lower triangle is read
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        products(i, j) = rows.col(i).dot(rows.col(j));
      }
    }
    const SymmetricEigen eigen(products);
    squares = eigen.eigenvalues().tail(count);
    return eigen.eigenvectors().rightCols(count);
  }
  // Starts from the axes that vary most.
  const Eigen::Index carried = std::min(size, count + kSpareDirections);
  const Eigen::VectorXd variation = rows.colwise().squaredNorm();
  std::vector<Eigen::Index> axes(size);
  std::iota(axes.begin(), axes.end(), 0);
  std::partial_sort(axes.begin(), axes.begin() + carried, axes.end(),
                    [&](Eigen::Index a, Eigen::Index b) {
                      return variation[a] != variation[b] ? variation[a] > variation[b]
                                                          : a < b;
                    });
  Eigen::MatrixXd images(rows.rows(), carried);
  for (Eigen::Index i = 0; i < carried; ++i) {
    images.col(i) = rows.col(axes[i]);
  }
  Eigen::MatrixXd directions;
  for (int step = 0; step < iterations; ++step) {
    directions = orthonormal_columns(rows.transpose() * images);
    images.noalias() = rows * directions;
  }
  const Eigen::MatrixXd products = images.transpose() * images;
  const SymmetricEigen eigen(products);
  squares = eigen.eigenvalues().tail(count);
  return directions * eigen.eigenvectors().rightCols(count);
}

bool QuadraticFit::fit(const RowMatrix& vectors, const Eigen::VectorXd& weights) {
  vectors_ = &vectors;
  weights_ = &weights;
  if (!find_principal()) {
    return false;
  }
  solve_design();
  if (design_.num_unknowns() > 1) {
    RowMatrix tilted = coefficients_.middleRows(1, dim_);
    if (orthonormalize(tilted)) {
      frame_ = tilted;
      solve_design();
    }
  }
  return true;
}

bool QuadraticFit::find_principal() {
  const RowMatrix& vectors = *vectors_;
  const Eigen::VectorXd& weights = *weights_;
  if (vectors.cols() < dim_) {
    return false;
  }
  const double total = weights.sum();
  const Eigen::RowVectorXd mean = weights.transpose() * vectors / total;
  const Eigen::MatrixXd centered =
      weights.cwiseSqrt().asDiagonal() * (vectors.rowwise() - mean);
  Eigen::VectorXd squares;
  const Eigen::MatrixXd directions = leading_directions(centered, dim_, squares);
  if (!(squares[0] > kDependentSquaredSine * squares[dim_ - 1])) {
    return false;
  }
  frame_ = directions.transpose();
  return true;
}

void QuadraticFit::solve_design() {
  fill_design();
  coefficients_ = design_.fit(*vectors_);
}

void QuadraticFit::fill_design() {
  const Eigen::Index rows = vectors_->rows();
  tangent_.noalias() = vectors_->lazyProduct(frame_.transpose());
  radius_ = 0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    if ((*weights_)[i] > 0) {
      radius_ = std::max(radius_, tangent_.row(i).squaredNorm());
    }
  }
  radius_ = radius_ > 0 ? std::sqrt(radius_) : 1;
  tangent_ /= radius_;
  design_.set(tangent_, *weights_);
}

void QuadraticFit::predict(Eigen::Index row, Eigen::VectorXd& combination) {
  terms_ = design_.factors().solve(design_.terms().row(row).transpose());
  combination.noalias() = design_.weighted() * terms_;
}

void QuadraticFit::tangent_terms(Eigen::Index row, double most,
                                 Eigen::VectorXd& terms) const {
  terms = design_.terms().row(row).transpose();
  const double length = tangent_.row(row).norm();
  if (length > most) {
    const double factor = most / length;
    for (Eigen::Index i = 1; i < terms.size(); ++i) {
      terms[i] *= i <= dim_ ? factor : factor * factor;
    }
  }
}

double QuadraticFit::distance_without(Eigen::Index row) {
  Eigen::VectorXd terms;
  tangent_terms(row, kFarthest, terms);
  residual_ = vectors_->row(row).transpose() - coefficients_.transpose() * terms;
  residual_ -= frame_.transpose() * (frame_ * residual_);
  terms_ = design_.factors().solve(terms);
  const double leverage = (*weights_)[row] * terms.dot(terms_);
  return residual_.norm() / std::max(1 - leverage, kLeastFreedom);
}

double QuadraticFit::variance() const {
  Eigen::MatrixXd residuals = *vectors_ - design_.terms() * coefficients_;
  residuals -= (residuals * frame_.transpose()) * frame_;
  const double sum =
      (weights_->transpose() * residuals.rowwise().squaredNorm()).value();
  const auto fitted = static_cast<double>((weights_->array() > 0).count());
  const double freedom = weights_->sum() * (1 - design_.num_unknowns() / fitted);
  return freedom > 0 ? sum / freedom : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace remanifold::detail
