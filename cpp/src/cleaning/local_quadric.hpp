// SPDX-License-Identifier: GPL-3.0-or-later
// A quadric through a noisy neighborhood of some hundred samples, robust and in the
// ambient coordinates: what smoothing fits at its centers. Fitted twice: by weights that
// fall with the distance, from which tangent space, foot point and scatter follow; then by
// weights that fall with the tangential distance from the foot point, since a ball around
// a point off the manifold holds more of what lies on that side, and with the distance
// from the first quadric, for outliers and other sheets.
#pragma once

#include "local/local_coordinates.hpp"
#include "local/quadratic_design.hpp"

#include <Eigen/Core>

namespace remanifold::detail {

class LocalQuadric {
 public:
  explicit LocalQuadric(int dim) : dim_(dim) {}

  static constexpr int unknowns(int dim) { return QuadraticDesign::unknowns(dim); }

  /// \param rows       positions less the center, nearest first; the first `count` count
  /// \param distances  of the rows from the center where they were looked for, ascending
  /// \param off        whether the center may lie off the manifold
  /// \returns false where the rows span fewer than K dimensions
  bool fit(const Eigen::MatrixXd& rows, const Eigen::VectorXd& distances,
           Eigen::Index count, bool off);

  /// From the center to the quadric along the normals.
  const Eigen::VectorXd& foot() const { return foot_; }
  /// How far the foot moves with each row; the variance of the foot in units of that of a
  /// row is the square of its norm.
  const Eigen::VectorXd& influence() const { return influence_; }
  double gain() const { return influence_.squaredNorm(); }
  /// Variance of the normal distance of a row, all normal directions together, less what
  /// the fit takes up.
  double variance() const { return variance_; }
  /// Root of the mean squared curvature over the K tangent directions.
  double curvature() const { return curvature_; }
  /// Variance along the manifold, the mean over its K directions, of the weighted rows.
  double spread() const { return spread_; }
  /// Of the K leading directions, those that the rows spread in, compared with the first.
  int wide_directions() const { return wide_directions_; }
  /// Tangential distance at which weights are zero.
  double reach() const { return reach_; }
  /// From the quadric along the normals to each row.
  const Eigen::MatrixXd& residuals() const { return residuals_; }
  /// Squares of their lengths.
  const Eigen::VectorXd& squared_residuals() const { return squared_residuals_; }
  /// Tangential distance of each row from the foot point, in units of the reach.
  double tangential(Eigen::Index row) const { return tangent_.row(row).norm(); }

 private:
  bool find_frame(const Eigen::Ref<const Eigen::MatrixXd>& rows);
  void solve(const Eigen::Ref<const Eigen::MatrixXd>& rows, double unit);
  double scatter() const;

  int dim_;
  RowMatrix frame_;  // K x D
  Eigen::VectorXd weights_;
  Eigen::MatrixXd tangent_;  // rows x K, in units of the reach
  QuadraticDesign design_;
  Eigen::MatrixXd coefficients_;  // unknowns x D
  Eigen::MatrixXd residuals_;
  Eigen::VectorXd squared_residuals_;
  Eigen::VectorXd foot_;
  Eigen::VectorXd influence_;
  double variance_ = 0;
  double reach_ = 0;
  double curvature_ = 0;
  double spread_ = 0;
  int wide_directions_ = 0;
};

}  // namespace remanifold::detail
