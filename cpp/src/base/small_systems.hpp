// SPDX-License-Identifier: GPL-3.0-or-later
// Linear systems of a few unknowns in plain loops. Eigen's decompositions compute the same,
// but each takes the compiler a second or two for every size and every right-hand side.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace remanifold::detail {

/// Gaussian elimination with partial pivoting. Leaves in `matrix` the factors of the
/// permuted rows, in `right` these rows of the right-hand side.
/// \returns the determinant
template <class Matrix, class Vector>
double eliminate(Matrix& matrix, Vector& right) {
  const Eigen::Index size = matrix.rows();
  bool odd = false;
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < size; ++i) {
      if (std::abs(matrix(i, k)) > std::abs(matrix(pivot, k))) {
        pivot = i;
      }
    }
    if (matrix(pivot, k) == 0) {
      return 0;
    }
    if (pivot != k) {
      for (Eigen::Index j = 0; j < size; ++j) {
        std::swap(matrix(k, j), matrix(pivot, j));
      }
      std::swap(right[k], right[pivot]);
      odd = !odd;
    }
    for (Eigen::Index i = k + 1; i < size; ++i) {
      matrix(i, k) /= matrix(k, k);
      for (Eigen::Index j = k + 1; j < size; ++j) {
        matrix(i, j) -= matrix(i, k) * matrix(k, j);
      }
    }
  }
  double product = 1;
  for (Eigen::Index k = size - 1; k >= 0; --k) {
    product *= matrix(k, k);
  }
  return odd ? -product : product;
}

/// Solves for what stands in `right`. Overwrites both; infinities or NaN where the matrix
/// is singular.
/// \returns the determinant
template <class Matrix, class Vector>
double solve_square(Matrix& matrix, Vector& right) {
  const double determinant = eliminate(matrix, right);
  const Eigen::Index size = matrix.rows();
  // The last bits follow the order of the terms: the last first.
  for (Eigen::Index i = 1; i < size; ++i) {
    double sum = matrix(i, i - 1) * right[i - 1];
    for (Eigen::Index j = i - 2; j >= 0; --j) {
      sum += matrix(i, j) * right[j];
    }
    right[i] -= sum;
  }
  for (Eigen::Index i = size - 1; i >= 0; --i) {
    if (i + 1 < size) {
      double sum = matrix(i, size - 1) * right[size - 1];
      for (Eigen::Index j = size - 2; j > i; --j) {
        sum += matrix(i, j) * right[j];
      }
      right[i] -= sum;
    }
    right[i] /= matrix(i, i);
  }
  return determinant;
}

/// Of a matrix that is overwritten.
template <class Matrix>
double determinant_of(Matrix& matrix) {
  Eigen::Matrix<double, Matrix::ColsAtCompileTime, 1, 0, Matrix::MaxColsAtCompileTime,
                1>
      none = matrix.col(0);
  return eliminate(matrix, none);
}

/// L D L^T of a symmetric matrix, rows by descending diagonal.
/// \tparam Size     of the matrix, or Eigen::Dynamic
/// \tparam MaxSize  of a matrix of dynamic size; Eigen::Dynamic for any
template <int Size, int MaxSize = Size>
class SymmetricFactors {
 public:
  using Matrix = Eigen::Matrix<double, Size, Size, 0, MaxSize, MaxSize>;

  /// \param matrix  of which the lower triangle is read
  void compute(const Matrix& matrix) {
    const Eigen::Index size = matrix.rows();
    order_.resize(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      order_[i] = i;
    }
    for (Eigen::Index k = 0; k < size; ++k) {
      Eigen::Index largest = k;
      for (Eigen::Index i = k + 1; i < size; ++i) {
        if (std::abs(matrix(order_[i], order_[i])) >
            std::abs(matrix(order_[largest], order_[largest]))) {
          largest = i;
        }
      }
      std::swap(order_[k], order_[largest]);
    }
    factors_.resize(size, size);
    column_.resize(size);
    for (Eigen::Index k = 0; k < size; ++k) {
      for (Eigen::Index j = 0; j < k; ++j) {
        column_[j] = factors_(j, j) * factors_(k, j);
      }
      for (Eigen::Index i = k; i < size; ++i) {
        const Eigen::Index high = std::max(order_[i], order_[k]);
        const Eigen::Index low = std::min(order_[i], order_[k]);
        double sum = 0;
        for (Eigen::Index j = 0; j < k; ++j) {
          sum += factors_(i, j) * column_[j];
        }
        factors_(i, k) = matrix(high, low) - sum;
      }
      if (factors_(k, k) != 0) {
        for (Eigen::Index i = k + 1; i < size; ++i) {
          factors_(i, k) /= factors_(k, k);
        }
      }
    }
  }

  double pivot(Eigen::Index i) const { return factors_(i, i); }

  double determinant() const {
    double product = 1;
    for (Eigen::Index i = 0; i < factors_.rows(); ++i) {
      product *= factors_(i, i);
    }
    return product;
  }

  /// Solves for a right-hand side that is overwritten. Directions with a pivot of zero are
  /// left out.
  template <class Vector>
  void solve(Vector&& right) {
    const Eigen::Index size = factors_.rows();
    for (Eigen::Index i = 0; i < size; ++i) {
      column_[i] = right[order_[i]];
      for (Eigen::Index j = 0; j < i; ++j) {
        column_[i] -= factors_(i, j) * column_[j];
      }
    }
    for (Eigen::Index i = size - 1; i >= 0; --i) {
      column_[i] = std::abs(factors_(i, i)) > std::numeric_limits<double>::min()
                       ? column_[i] / factors_(i, i)
                       : 0;
      if (i + 1 < size) {
        double sum = 0;
        for (Eigen::Index j = i + 1; j < size; ++j) {
          sum += factors_(j, i) * column_[j];
        }
        column_[i] -= sum;
      }
    }
    for (Eigen::Index i = 0; i < size; ++i) {
      right[order_[i]] = column_[i];
    }
  }

 private:
  Matrix factors_;
  Eigen::Matrix<double, Size, 1, 0, MaxSize, 1> column_;
  Eigen::Matrix<Eigen::Index, Size, 1, 0, MaxSize, 1> order_;
};

}  // namespace remanifold::detail
