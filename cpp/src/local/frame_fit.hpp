// SPDX-License-Identifier: GPL-3.0-or-later
// Tangent frames by fitting the neighbor vectors q - x of one sample: the principal
// directions of the neighborhood, and the linear part of a quadratic fit over them. The
// vectors stand in columns, one a coordinate, filled up with zeros to a multiple of four:
// zeros change no sum, and sums of four lanes are the same on every machine.
#pragma once

#include "base/decompositions.hpp"
#include "local/local_coordinates.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace remanifold::detail {

/// K = 1, 2, ... or Eigen::Dynamic, D likewise: the pairs at the end of frame_fit.cpp.
template <int K, int D>
class FrameFit {
 public:
  using Frame = Eigen::Matrix<double, K, D, Eigen::RowMajor>;

  explicit FrameFit(int dim) : dim_(dim) {}

  /// Room for `count` vectors of `size` coordinates, to be written by coordinate().
  void resize(Index count, Eigen::Index size);
  double& coordinate(Index i, Eigen::Index axis) { return vectors_(i, axis); }

  /// The K leading principal directions of the vectors with x itself.
  /// \param jet  tilted twice by the linear part of a quadratic fit through x
  /// \returns false where there are fewer directions
  bool fit(bool jet);

  /// Orthonormal rows, K x D.
  const Frame& frame() const { return frame_; }

 private:
  static constexpr int kLanes = 4;
  static constexpr double kGap = 1e-3;
  static constexpr int kUnknowns =
      K == Eigen::Dynamic ? Eigen::Dynamic : K + K * (K + 1) / 2;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  /// \param rough  good enough to be refined
  /// \returns false where there are fewer than K directions
  bool find_principal(bool rough);

  /// Leaves the frame alone where there are fewer vectors than unknowns, or where the fit
  /// is degenerate.
  void refine();

  /// The closed form loses digits where eigenvalues are close to each other: it has to tell
  /// tangents from normals.
  void decompose_covariance(bool rough);

  template <class A, class B>
  double dot(const A& a, const B& b) const;

  template <class A>
  double sum(const A& a) const;

  /// The tangent coordinates, scaled to the farthest, and their products.
  void fill_design(int unknowns);

  /// The normal matrix of the fit as L diag(p) L^T.
  /// \returns false where it is singular
  bool decompose(int unknowns);

  /// The linear part of the fit of one coordinate.
  void solve(int unknowns, Eigen::Index axis);

  int dim_;
  Index count_ = 0;
  Index padded_ = 0;
  Eigen::Matrix<double, Eigen::Dynamic, D> vectors_;
  Eigen::Matrix<double, D, 1> mean_;
  Eigen::Matrix<double, D, D> covariance_;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>> eigen_;
  Columns design_;
  Eigen::VectorXd squared_lengths_;
  Eigen::Matrix<double, kUnknowns, kUnknowns> lower_;
  Eigen::Matrix<double, kUnknowns, 1> pivots_;
  Eigen::Matrix<double, kUnknowns, 1> solution_;
  Frame frame_;
  Frame tilted_;
};

}  // namespace remanifold::detail
