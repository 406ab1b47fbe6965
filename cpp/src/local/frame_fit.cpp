// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/frame_fit.hpp"

#include "base/tolerance.hpp"

#include <algorithm>
#include <cmath>

namespace remanifold::detail {

template <int K, int D>
template <class A, class B>
double FrameFit<K, D>::dot(const A& a, const B& b) const {
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

template <int K, int D>
template <class A>
double FrameFit<K, D>::sum(const A& a) const {
  double lanes[kLanes] = {};
  const double* pa = a.data();
  for (Index i = 0; i < padded_; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += pa[i + lane];
    }
  }
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

template <int K, int D>
void FrameFit<K, D>::resize(Index count, Eigen::Index size) {
  count_ = count;
  padded_ = (count + kLanes - 1) / kLanes * kLanes;
  vectors_.resize(padded_, size);
  vectors_.bottomRows(padded_ - count).setZero();
}

template <int K, int D>
bool FrameFit<K, D>::fit(bool jet) {
  if (!find_principal(jet)) {
    return false;
  }
  if (jet) {
    refine();
    refine();
  }
  return true;
}

template <int K, int D>
bool FrameFit<K, D>::find_principal(bool rough) {
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

template <int K, int D>
void FrameFit<K, D>::refine() {
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

template <int K, int D>
void FrameFit<K, D>::decompose_covariance(bool rough) {
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

template <int K, int D>
void FrameFit<K, D>::fill_design(int unknowns) {
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

template <int K, int D>
bool FrameFit<K, D>::decompose(int unknowns) {
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

template <int K, int D>
void FrameFit<K, D>::solve(int unknowns, Eigen::Index axis) {
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

template class FrameFit<1, 3>;
template class FrameFit<1, Eigen::Dynamic>;
template class FrameFit<2, 3>;
template class FrameFit<2, Eigen::Dynamic>;
template class FrameFit<3, Eigen::Dynamic>;
template class FrameFit<4, Eigen::Dynamic>;
template class FrameFit<Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace remanifold::detail
