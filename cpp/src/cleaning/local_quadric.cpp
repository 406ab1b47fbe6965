// SPDX-License-Identifier: GPL-3.0-or-later
#include "cleaning/local_quadric.hpp"

#include "base/tolerance.hpp"
#include "local/quadratic_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace remanifold::detail {
namespace {

/// Rows this many times the scatter off the first quadric count nothing in the second
/// (Tukey's biweight; of normal noise in one direction it wastes 2 %).
constexpr double kRobust = 6;
constexpr Eigen::Index kRobustRows = 5;
/// A ball around a point off the manifold shows it, without taking sides, as far as the
/// ball is wider than this many times the scatter farther off; never less than that share
/// of the ball.
constexpr double kTwoSided = 2;
constexpr double kLeastShare = 0.85;

/// The first fit tilts the frame; it need not be found to the last digit before.
constexpr int kIterations = 5;

/// Directions of less than this share of the spread in the first are none that the
/// samples fill.
constexpr double kThin = 0.3;

double tricube(double ratio) {
  const double rest = std::max(0.0, 1 - ratio * ratio * ratio);
  return rest * rest * rest;
}

}  // namespace

bool LocalQuadric::fit(const Eigen::MatrixXd& all, const Eigen::VectorXd& distances,
                       Eigen::Index count, bool off) {
  const auto rows = all.topRows(count);
  const double radius = distances[count - 1] * (1 + 1e-6);
  if (!(radius > 0) || rows.cols() < dim_) {
    return false;
  }
  weights_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    weights_[i] = tricube(distances[i] / radius);
  }
  if (!find_frame(rows)) {
    return false;
  }
  reach_ = radius;
  solve(rows, radius);
  if (design_.num_unknowns() > 1) {
    RowMatrix tilted = coefficients_.middleRows(1, dim_);
    if (orthonormalize(tilted)) {
      frame_ = tilted;
    }
  }
  const double first = scatter();
  const Eigen::VectorXd shift =
      coefficients_.row(0).transpose() -
      frame_.transpose() * (frame_ * coefficients_.row(0).transpose());
  if (off) {
    const double side = shift.norm() + kTwoSided * std::sqrt(first);
    reach_ = std::sqrt(std::max(kLeastShare * kLeastShare * radius * radius,
                                radius * radius - side * side));
  }
  // A few rows say too little about the scatter.
  const bool robust = count >= kRobustRows * unknowns(dim_);
  const double widest = kRobust * kRobust * first;
  tangent_.noalias() = rows * frame_.transpose();
  for (Eigen::Index i = 0; i < count; ++i) {
    const double rest =
        robust && widest > 0 ? std::max(0.0, 1 - squared_residuals_[i] / widest) : 1.0;
    weights_[i] = tricube(tangent_.row(i).norm() / reach_) * rest * rest;
  }
  solve(rows, reach_);

  // Against the scatter that the fit leaves, its own unknowns are taken off.
  const Eigen::MatrixXd squares = design_.weighted().transpose() * design_.weighted();
  const double taken = design_.factors().solve(squares).trace();
  const double freedom = weights_.sum() - taken;
  const double sum = weights_.dot(squared_residuals_);
  variance_ = freedom > 0 ? sum / freedom : std::numeric_limits<double>::quiet_NaN();

  spread_ = weights_.dot(tangent_.rowwise().squaredNorm()) * reach_ * reach_ /
            (weights_.sum() * dim_);

  Eigen::VectorXd terms = Eigen::VectorXd::Zero(design_.num_unknowns());
  terms[0] = 1;
  influence_.noalias() = design_.weighted() * design_.factors().solve(terms);

  curvature_ = 0;
  // Noise along the manifold draws what is bent towards the inside, by half the variance
  // in each direction times the mean curvature.
  // Coordinates without extent have no noise.
  const auto codim = (rows.array() != 0).colwise().any().count() - dim_;
  if (design_.num_unknowns() == unknowns(dim_) && codim > 0 && variance_ > 0) {
    Eigen::MatrixXd second =
        coefficients_.bottomRows(design_.num_unknowns() - 1 - dim_);
    second -= (second * frame_.transpose()) * frame_;
    Eigen::VectorXd bend = Eigen::VectorXd::Zero(rows.cols());
    double squares_of_all = 0;
    int row = 0;
    for (int i = 0; i < dim_; ++i) {
      for (int j = 0; j <= i; ++j, ++row) {
        // Of a square the second derivative is twice the coefficient; what is mixed
        // counts twice.
        squares_of_all += (i == j ? 4 : 2) * second.row(row).squaredNorm();
      }
      bend += second.row(row - 1).transpose();
    }
    curvature_ = std::sqrt(squares_of_all / dim_) / (reach_ * reach_);
    bend *= variance_ / static_cast<double>(codim) / (reach_ * reach_);
    coefficients_.row(0) -= bend.transpose();
    residuals_.rowwise() += bend.transpose();
    squared_residuals_ = residuals_.rowwise().squaredNorm();
  }
  foot_ = coefficients_.row(0).transpose() -
          frame_.transpose() * (frame_ * coefficients_.row(0).transpose());
  return true;
}

bool LocalQuadric::find_frame(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  const Eigen::RowVectorXd mean = weights_.transpose() * rows / weights_.sum();
  const Eigen::MatrixXd centered =
      weights_.cwiseSqrt().asDiagonal() * (rows.rowwise() - mean);
  Eigen::VectorXd squares;
  const Eigen::MatrixXd directions =
      leading_directions(centered, dim_, squares, kIterations);
  if (!(squares[0] > kDependentSquaredSine * squares[dim_ - 1])) {
    return false;
  }
  wide_directions_ =
      static_cast<int>((squares.array() > kThin * kThin * squares[dim_ - 1]).count());
  frame_ = directions.transpose();
  return true;
}

void LocalQuadric::solve(const Eigen::Ref<const Eigen::MatrixXd>& rows, double unit) {
  tangent_.noalias() = rows * frame_.transpose();
  tangent_ /= unit;
  design_.set(tangent_, weights_);
  coefficients_ = design_.fit(rows);
  residuals_ = rows - design_.terms() * coefficients_;
  residuals_ -= (residuals_ * frame_.transpose()) * frame_;
  squared_residuals_ = residuals_.rowwise().squaredNorm();
}

double LocalQuadric::scatter() const {
  const double fitted = static_cast<double>((weights_.array() > 0).count());
  const double freedom = weights_.sum() * (1 - design_.num_unknowns() / fitted);
  return freedom > 0 ? weights_.dot(squared_residuals_) / freedom : 0;
}

}  // namespace remanifold::detail
