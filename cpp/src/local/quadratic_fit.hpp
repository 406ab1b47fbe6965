// SPDX-License-Identifier: GPL-3.0-or-later
// A quadric through weighted vectors by least squares: their normal coordinates as
// polynomials of degree two in the tangent ones, or of a lower one (quadratic_design.hpp).
#pragma once

#include "local/local_coordinates.hpp"
#include "local/quadratic_design.hpp"

#include <Eigen/Core>

namespace remanifold::detail {

/// The leading right singular vectors, in columns, the largest last, and the squares of
/// their singular values. Of many coordinates by so many iterations.
Eigen::MatrixXd leading_directions(const Eigen::MatrixXd& rows, Eigen::Index count,
                                   Eigen::VectorXd& squares, int iterations = 12);

class QuadraticFit {
 public:
  explicit QuadraticFit(int dim) : dim_(dim) {}

  static constexpr int unknowns(int dim) { return QuadraticDesign::unknowns(dim); }

  /// \param vectors  rows; their tangent space is that of the K leading principal
  ///                 directions, tilted by the linear part of a first fit
  /// \param weights  of the rows, at least one positive; rows of weight zero may be
  ///                 asked about
  /// \returns false where the vectors span fewer than K dimensions
  bool fit(const RowMatrix& vectors, const Eigen::VectorXd& weights);

  /// Where the quadric is over the tangent coordinates of a row, as a combination of the
  /// rows.
  void predict(Eigen::Index row, Eigen::VectorXd& combination);
  /// Normal distance of a row from the quadric that the other rows show. Beyond the reach
  /// of the fitted rows the quadric is taken where it is nearest to the row.
  double distance_without(Eigen::Index row);
  /// Variance of the normal distance from the quadric, less what the fit itself takes up.
  double variance() const;

 private:
  bool find_principal();
  void solve_design();
  void fill_design();
  void tangent_terms(Eigen::Index row, double most, Eigen::VectorXd& terms) const;

  int dim_;
  const RowMatrix* vectors_ = nullptr;
  const Eigen::VectorXd* weights_ = nullptr;
  double radius_ = 0;  // of the tangent coordinates of fitted rows
  RowMatrix frame_;    // K x r, orthonormal
  RowMatrix tangent_;  // rows x K, in units of the radius
  QuadraticDesign design_;
  Eigen::MatrixXd coefficients_;  // unknowns x r
  Eigen::VectorXd terms_;
  Eigen::VectorXd residual_;
};

}  // namespace remanifold::detail
