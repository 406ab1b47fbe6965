// SPDX-License-Identifier: GPL-3.0-or-later
// What a weighted fit of a quadric asks of tangent coordinates: all their products up to
// degree two and the factors of the normal matrix. Where there are too few rows, or they lie
// so that some coefficients are not determined, the degree is one or zero.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace remanifold::detail {

class QuadraticDesign {
 public:
  /// By row or by column.
  using Coordinates = Eigen::Ref<const Eigen::MatrixXd, 0,
                                 Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

  static constexpr int unknowns(int dim) { return 1 + dim + dim * (dim + 1) / 2; }

  /// \param tangent  rows x K, of the size of one
  /// \param weights  of the rows, at least one positive
  void set(const Coordinates& tangent, const Eigen::VectorXd& weights);

  /// Of those that the rows determine: all, 1 + K or one.
  int num_unknowns() const { return num_unknowns_; }
  /// rows x unknowns: one, the coordinates, the products of two.
  auto terms() const { return terms_.leftCols(num_unknowns_); }
  /// The same times the weights.
  auto weighted() const { return weighted_.leftCols(num_unknowns_); }
  /// Of the normal matrix, weighted().transpose() * terms().
  const Eigen::LLT<Eigen::MatrixXd>& factors() const { return factors_; }

  /// Of the polynomials that are nearest to values at the rows, one a column, by weighted
  /// least squares: unknowns x columns.
  Eigen::MatrixXd fit(const Coordinates& values) const;

 private:
  bool decompose(int num_unknowns, Eigen::Index num_fitted);

  int num_unknowns_ = 0;
  Eigen::MatrixXd terms_;
  Eigen::MatrixXd weighted_;
  Eigen::MatrixXd normal_;  // lower triangle, of all terms
  Eigen::LLT<Eigen::MatrixXd> factors_;
};

}  // namespace remanifold::detail
