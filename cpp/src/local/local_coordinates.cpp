// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/local_coordinates.hpp"

#include "base/tolerance.hpp"

#include <cmath>

namespace remanifold::detail {
void LocalCoordinates::load(const Samples& samples, Index x, const Index* neighbors,
                            Index count) {
  count_ = count;
  const Index dim = samples.ambient_dim();
  direct_ = samples.has_points() && dim <= count;
  has_gram_ = false;
  has_vectors_ = false;
  if (samples.has_points()) {
    RowMatrix& target = direct_ ? vectors_ : differences_;
    target.resize(count, dim);
    const double* px = samples.point(x);
    for (Index i = 0; i < count; ++i) {
      const double* pq = samples.point(neighbors[i]);
      double* row = target.row(i).data();
      for (Index j = 0; j < dim; ++j) {
        row[j] = pq[j] - px[j];
      }
    }
    has_vectors_ = direct_;
    if (!direct_) {
      gram_.noalias() = differences_ * differences_.transpose();
      has_gram_ = true;
    }
    return;
  }
  gram_.resize(count, count);
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j <= i; ++j) {
      gram_(i, j) = gram_(j, i) = samples.inner_product(x, neighbors[i], neighbors[j]);
    }
  }
  has_gram_ = true;
}

void LocalCoordinates::load(const KnownDistances& distances, Index x,
                            const Index* neighbors, Index count) {
  count_ = count;
  direct_ = false;
  has_vectors_ = false;
  gram_.resize(count, count);
  for (Index i = 0; i < count; ++i) {
    gram_(i, i) = distances(x, neighbors[i]);
    for (Index j = 0; j < i; ++j) {
      gram_(i, j) = gram_(j, i) =
          (gram_(i, i) + gram_(j, j) - distances(neighbors[i], neighbors[j])) / 2;
    }
  }
  has_gram_ = true;
}

const RowMatrix& LocalCoordinates::gram() {
  if (!has_gram_) {
    gram_.resize(count_, count_);
    for (Index i = 0; i < count_; ++i) {
      for (Index j = 0; j <= i; ++j) {
        gram_(i, j) = gram_(j, i) = vectors_.row(i).dot(vectors_.row(j));
      }
    }
    has_gram_ = true;
  }
  return gram_;
}

const RowMatrix& LocalCoordinates::vectors() {
  if (!has_vectors_) {
    decompose_gram();
    has_vectors_ = true;
  }
  return vectors_;
}

// Cholesky with pivots: vectors * vectors^T = gram.
void LocalCoordinates::decompose_gram() {
  vectors_.setZero(count_, count_);
  pivots_.clear();
  Eigen::VectorXd rest = gram_.diagonal();
  const double smallest = kDependentSquaredSine * rest.maxCoeff();
  for (Index k = 0; k < count_; ++k) {
    Eigen::Index pivot = 0;
    const double largest = rest.maxCoeff(&pivot);
    if (!(largest > smallest)) {
      break;
    }
    const double root = std::sqrt(largest);
    for (Index i = 0; i < count_; ++i) {
      const double dot = vectors_.row(i).head(k).dot(vectors_.row(pivot).head(k));
      vectors_(i, k) = (gram_(i, pivot) - dot) / root;
    }
    // Exact zeros above the pivots make them a triangular system.
    for (const Index earlier : pivots_) {
      vectors_(earlier, k) = 0;
    }
    vectors_(pivot, k) = root;
    rest -= vectors_.col(k).cwiseAbs2();
    pivots_.push_back(static_cast<Index>(pivot));
    for (const Index used : pivots_) {
      rest(used) = 0;
    }
  }
  vectors_.conservativeResize(count_, static_cast<Eigen::Index>(pivots_.size()));
}

RowMatrix LocalCoordinates::to_coefficients(const RowMatrix& rows) {
  // The axes are triangular combinations of the pivot vectors: rows = C * L.
  const auto rank = static_cast<Eigen::Index>(pivots_.size());
  RowMatrix lower(rank, rank);
  for (Eigen::Index i = 0; i < rank; ++i) {
    lower.row(i) = vectors_.row(pivots_[i]);
  }
  const RowMatrix on_pivots = lower.transpose()
                                  .triangularView<Eigen::Upper>()
                                  .solve(rows.transpose())
                                  .transpose();
  RowMatrix coefficients = RowMatrix::Zero(rows.rows(), count_);
  for (Eigen::Index i = 0; i < rank; ++i) {
    coefficients.col(pivots_[i]) = on_pivots.col(i);
  }
  return coefficients;
}

void LocalCoordinates::to_ambient(const RowMatrix& coefficients, RowMatrix& out) const {
  out.noalias() = coefficients * (direct_ ? vectors_ : differences_);
}

bool orthonormalize(RowMatrix& rows, const RowMatrix& gram) {
  return gram_schmidt(rows, [&](Eigen::Index i, Eigen::Index j) {
    return rows.row(i).dot(gram * rows.row(j).transpose());
  });
}

}  // namespace remanifold::detail
