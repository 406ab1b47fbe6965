// SPDX-License-Identifier: GPL-3.0-or-later
// Tangent frames by fitting the neighbor vectors q - x of one sample: the principal
// directions of the neighborhood, and the linear part of a quadratic fit over them. The
// vectors stand in columns, one a coordinate, filled up with zeros to a multiple of four:
// zeros change no sum, and sums of four lanes are the same on every machine.
#pragma once

#include "base/tolerance.hpp"
#include "local/local_coordinates.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace remanifold::detail {

/// K = 1, 2, ... or Eigen::Dynamic, D likewise.
template <int K, int D>
class FrameFit {
 public:
  using Frame = Eigen::Matrix<double, K, D, Eigen::RowMajor>;

  explicit FrameFit(int dim) : dim_(dim) {}

  /// Room for `count` vectors of `size` coordinates, to be written by coordinate().
  void resize(Index count, Eigen::Index size) {
    count_ = count;
    padded_ = (count + kLanes - 1) / kLanes * kLanes;
    vectors_.resize(padded_, size);
    vectors_.bottomRows(padded_ - count).setZero();
  }
  double& coordinate(Index i, Eigen::Index axis) { return vectors_(i, axis); }

  /// The K leading principal directions of the vectors with x itself.
  /// \param rough  good enough to be refined
  /// \returns false where there are fewer
  bool find_principal(bool rough) {
    const Eigen::Index size = vectors_.cols();
    if (size < dim() || count_ < dim()) {
      return false;
    }
    covariance_.resize(size, size);
    mean_.resize(size);
    const auto members = static_cast<double>(count_ + 1);
    for (Eigen::Index i = 0; i < size; ++i) {
      mean_[i] = sum(vectors_.col(i)) / members;
      for (Eigen::Index j = 0; j <= i; ++j) {
        covariance_(i, j) = covariance_(j, i) =
            dot(vectors_.col(i), vectors_.col(j)) - members * mean_[i] * mean_[j];
      }
    }
    decompose_covariance(rough);
    const auto& values = eigen_.eigenvalues();
    const Eigen::Index last = size - 1;
    if (!(values[last - dim() + 1] > kDependentSquaredSine * values[last])) {
      return false;
    }
    frame_.resize(dim(), size);
    for (int i = 0; i < dim(); ++i) {
      frame_.row(i) = eigen_.eigenvectors().col(last - i).transpose();
    }
    return true;
  }

  /// Tilts the frame by the linear part of a quadratic fit through x. Leaves it alone
  /// where there are fewer vectors than unknowns, or where the fit is degenerate.
  void refine() {
    const int unknowns = dim() + dim() * (dim() + 1) / 2;
    if (count_ < unknowns) {
      return;
    }
    fill_design(unknowns);
    if (!decompose(unknowns)) {
      return;
    }
    tilted_.resize(dim(), vectors_.cols());
    for (Eigen::Index axis = 0; axis < vectors_.cols(); ++axis) {
      solve(unknowns, axis);
    }
    if (orthonormalize(tilted_)) {
      frame_ = tilted_;
    }
  }

  /// Orthonormal rows, K x D.
  const Frame& frame() const { return frame_; }

 private:
  static constexpr int kLanes = 4;
  static constexpr double kGap = 1e-3;
  static constexpr int kUnknowns =
      K == Eigen::Dynamic ? Eigen::Dynamic : K + K * (K + 1) / 2;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  /// The closed form loses digits where eigenvalues are close to each other: it has to tell
  /// tangents from normals.
  void decompose_covariance(bool rough) {
    if constexpr (D == 3) {
      if (rough) {
        eigen_.computeDirect(covariance_);
        const auto& values = eigen_.eigenvalues();
        if (values[3 - dim()] - values[2 - dim()] > kGap * values[2]) {
          return;
        }
      }
    }
    eigen_.compute(covariance_);
  }

  template <class A, class B>
  double dot(const A& a, const B& b) const {
    double lanes[kLanes] = {};
    const double* pa = a.data();
    const double* pb = b.data();
    for (Index i = 0; i < padded_; i += kLanes) {
      for (int lane = 0; lane < kLanes; ++lane) {
        lanes[lane] += pa[i + lane] * pb[i + lane];
      }
    }
    return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
  }

  template <class A>
  double sum(const A& a) const {
    double lanes[kLanes] = {};
    const double* pa = a.data();
    for (Index i = 0; i < padded_; i += kLanes) {
      for (int lane = 0; lane < kLanes; ++lane) {
        lanes[lane] += pa[i + lane];
      }
    }
    return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
  }

  /// The tangent coordinates, scaled to the farthest, and their products.
  void fill_design(int unknowns) {
    design_.resize(padded_, unknowns);
    squared_lengths_.setZero(padded_);
    for (int k = 0; k < dim(); ++k) {
      auto column = design_.col(k);
      column.setZero();
      for (Eigen::Index axis = 0; axis < vectors_.cols(); ++axis) {
        column += frame_(k, axis) * vectors_.col(axis);
      }
      squared_lengths_ += column.cwiseAbs2();
    }
    design_.leftCols(dim()) /= std::sqrt(squared_lengths_.maxCoeff());
    int column = dim();
    for (int i = 0; i < dim(); ++i) {
      for (int j = 0; j <= i; ++j) {
        design_.col(column++) = design_.col(i).cwiseProduct(design_.col(j));
      }
    }
  }

  /// The normal matrix of the fit as L diag(p) L^T.
  /// \returns false where it is singular
  bool decompose(int unknowns) {
    lower_.resize(unknowns, unknowns);
    pivots_.resize(unknowns);
    double largest = 0;
    for (int i = 0; i < unknowns; ++i) {
      for (int j = 0; j <= i; ++j) {
        double entry = dot(design_.col(i), design_.col(j));
        for (int k = 0; k < j; ++k) {
          entry -= lower_(i, k) * lower_(j, k) * pivots_[k];
        }
        if (j < i) {
          lower_(i, j) = entry / pivots_[j];
        } else {
          pivots_[i] = entry;
        }
      }
      largest = std::max(largest, pivots_[i]);
      if (!(pivots_[i] > kDependentSquaredSine * largest)) {
        return false;
      }
    }
    return true;
  }

  /// The linear part of the fit of one coordinate.
  void solve(int unknowns, Eigen::Index axis) {
    solution_.resize(unknowns);
    for (int i = 0; i < unknowns; ++i) {
      solution_[i] = dot(design_.col(i), vectors_.col(axis));
      for (int k = 0; k < i; ++k) {
        solution_[i] -= lower_(i, k) * solution_[k];
      }
    }
    for (int i = unknowns - 1; i >= 0; --i) {
      solution_[i] /= pivots_[i];
      for (int k = i + 1; k < unknowns; ++k) {
        solution_[i] -= lower_(k, i) * solution_[k];
      }
    }
    tilted_.col(axis) = solution_.head(dim());
  }

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
