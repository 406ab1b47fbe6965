// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/linear_elements.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace remanifold {
namespace {

/// One simplex after the other, from the inner products of its edges.
class ElementKernel {
 public:
  ElementKernel(int dim, Offset count)
      : dim_(dim), gram_(dim, dim), factor_(dim, dim), inverse_(dim, dim) {
    const auto size = static_cast<std::size_t>(count);
    result_.volumes.assign(size, 0.0);
    result_.frames.assign(size * dim * dim, 0.0);
    result_.products.assign(size * (dim + 1) * (dim + 1), 0.0);
    result_.flat.assign(size, 1);
    for (int i = 2; i <= dim; ++i) {
      factorial_ *= i;
    }
    // Of eigenvalues with mean 1 the least is no smaller than their product over the
    // largest that the others can have.
    most_of_others_ = dim > 1 ? std::pow(dim / (dim - 1.0), dim - 1) : 1.0;
  }

  /// \param square  square(i, j), i < j: the squared length between two corners
  template <class Square>
  void take(Offset simplex, const Square& square) {
    double trace = 0;
    for (int i = 0; i < dim_; ++i) {
      gram_(i, i) = square(0, i + 1);
      trace += gram_(i, i);
    }
    const double scale = trace / dim_;
    if (!(scale > 0)) {
      return;
    }
    for (int i = 0; i < dim_; ++i) {
      for (int j = 0; j < i; ++j) {
        gram_(i, j) = (gram_(i, i) + gram_(j, j) - square(j + 1, i + 1)) / (2 * scale);
      }
    }
    for (int i = 0; i < dim_; ++i) {
      gram_(i, i) /= scale;
    }
    if (!factorize()) {
      return;
    }
    result_.flat[simplex] = 0;
    const double unit = std::sqrt(scale);
    double volume = 1;
    double* frame = result_.frames.data() + simplex * dim_ * dim_;
    for (int i = 0; i < dim_; ++i) {
      volume *= factor_(i, i) * unit;
      for (int j = 0; j <= i; ++j) {
        frame[i * dim_ + j] = factor_(i, j) * unit;
      }
    }
    result_.volumes[simplex] = volume / factorial_;
    invert();
    const int corners = dim_ + 1;
    double* products = result_.products.data() + simplex * corners * corners;
    double total = 0;
    for (int i = 0; i < dim_; ++i) {
      double row = 0;
      for (int j = 0; j < dim_; ++j) {
        // Columns of the inverse factor are the gradients.
        double sum = 0;
        for (int k = std::max(i, j); k < dim_; ++k) {
          sum += inverse_(k, i) * inverse_(k, j);
        }
        sum /= scale;
        products[(i + 1) * corners + j + 1] = sum;
        row += sum;
      }
      products[i + 1] = products[(i + 1) * corners] = -row;
      total += row;
    }
    products[0] = total;
  }

  LinearElements& result() { return result_; }

 private:
  /// Cholesky; false where the simplex is flat.
  bool factorize() {
    double determinant = 1;
    for (int j = 0; j < dim_; ++j) {
      double pivot = gram_(j, j);
      for (int k = 0; k < j; ++k) {
        pivot -= factor_(j, k) * factor_(j, k);
      }
      if (!(pivot > kFlatElement)) {  // no less than the least eigenvalue
        return false;
      }
      determinant *= pivot;
      factor_(j, j) = std::sqrt(pivot);
      for (int i = j + 1; i < dim_; ++i) {
        double sum = gram_(i, j);
        for (int k = 0; k < j; ++k) {
          sum -= factor_(i, k) * factor_(j, k);
        }
        factor_(i, j) = sum / factor_(j, j);
      }
    }
    if (determinant > 2 * most_of_others_ * kFlatElement) {
      return true;
    }
    solver_.compute(gram_, Eigen::EigenvaluesOnly);  // of the lower triangle
    return solver_.eigenvalues()[0] > kFlatElement;
  }

  void invert() {
    for (int j = 0; j < dim_; ++j) {
      inverse_(j, j) = 1 / factor_(j, j);
      for (int i = j + 1; i < dim_; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) {
          sum -= factor_(i, k) * inverse_(k, j);
        }
        inverse_(i, j) = sum / factor_(i, i);
      }
    }
  }

  int dim_;
  double factorial_ = 1;
  double most_of_others_ = 1;
  Eigen::MatrixXd gram_;  // lower triangle, in units of its mean diagonal
  Eigen::MatrixXd factor_;
  Eigen::MatrixXd inverse_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver_;
  LinearElements result_;
};

/// \tparam K  of the maps, or dynamic
template <int K>
void rotate_all(int dim, const std::vector<double>& maps, std::vector<double>& out) {
  using Matrix = Eigen::Matrix<double, K, K, Eigen::RowMajor>;
  const std::size_t size = static_cast<std::size_t>(dim) * dim;
  Eigen::JacobiSVD<Eigen::Matrix<double, K, K>> solver(
      dim, dim, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix left(dim, dim);
  for (std::size_t begin = 0; begin < maps.size(); begin += size) {
    solver.compute(Eigen::Map<const Matrix>(maps.data() + begin, dim, dim));
    left = solver.matrixU();
    Eigen::Map<Matrix> result(out.data() + begin, dim, dim);
    result.noalias() = left * solver.matrixV().transpose();
    if (result.determinant() < 0) {
      left.col(dim - 1) *= -1;  // of the least singular value
      result.noalias() = left * solver.matrixV().transpose();
    }
  }
}

}  // namespace

std::vector<double> nearest_rotations(int dim, const std::vector<double>& maps) {
  if (dim < 1 || maps.size() % (static_cast<std::size_t>(dim) * dim) != 0) {
    throw std::invalid_argument(std::to_string(maps.size()) +
                                " entries for linear maps of dimension " +
                                std::to_string(dim));
  }
  std::vector<double> result(maps.size());
  switch (dim) {
    case 2:
      rotate_all<2>(dim, maps, result);
      break;
    case 3:
      rotate_all<3>(dim, maps, result);
      break;
    default:
      rotate_all<Eigen::Dynamic>(dim, maps, result);
  }
  return result;
}

LinearElements linear_elements(const MatrixView& points,
                               const SimplexArray& simplices) {
  const int dim = simplices.arity - 1;
  if (dim < 1) {
    throw std::invalid_argument("elements have a dimension of 1 at least");
  }
  for (const Index vertex : simplices.vertices) {
    if (vertex < 0 || vertex >= points.rows) {
      throw std::invalid_argument("simplices have vertex " + std::to_string(vertex) +
                                  " of " + std::to_string(points.rows) + " points");
    }
  }
  ElementKernel kernel(dim, simplices.size());
  for (Offset m = 0; m < simplices.size(); ++m) {
    const Index* corners = simplices[m];
    kernel.take(m, [&](int i, int j) {
      const double* a = points.row(corners[i]);
      const double* b = points.row(corners[j]);
      double sum = 0;
      for (Offset d = 0; d < points.cols; ++d) {
        sum += (a[d] - b[d]) * (a[d] - b[d]);
      }
      return sum;
    });
  }
  return std::move(kernel.result());
}

LinearElements linear_elements(int dim, const std::vector<double>& squares) {
  const Offset pairs = static_cast<Offset>(dim) * (dim + 1) / 2;
  const auto given = static_cast<Offset>(squares.size());
  if (dim < 1 || given % pairs != 0) {
    throw std::invalid_argument(std::to_string(given) +
                                " squared lengths for elements of dimension " +
                                std::to_string(dim));
  }
  ElementKernel kernel(dim, given / pairs);
  for (Offset m = 0; m < given / pairs; ++m) {
    const double* own = squares.data() + m * pairs;
    kernel.take(
        m, [&](int i, int j) { return own[i * (2 * dim + 1 - i) / 2 + j - i - 1]; });
  }
  return std::move(kernel.result());
}

}  // namespace remanifold
