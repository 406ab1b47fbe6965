// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/tangent_space.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "detail/dispatch.hpp"
#include "detail/enclosing_simplex.hpp"
#include "detail/local_coordinates.hpp"
#include "detail/parallel.hpp"
#include "detail/tolerance.hpp"

namespace remanifold {
namespace {

using detail::LocalCoordinates;
using detail::RowMatrix;

constexpr Offset kBlock = 128;

/// The K leading principal directions of the neighborhood with x, as rows.
class PrincipalDirections {
 public:
  bool find(const RowMatrix& vectors, int dim, RowMatrix& basis) {
    if (vectors.cols() < dim || vectors.rows() < dim) {
      return false;
    }
    const auto count = static_cast<double>(vectors.rows() + 1);
    mean_ = vectors.colwise().sum() / count;
    covariance_.noalias() = vectors.transpose() * vectors;
    covariance_.noalias() -= count * mean_.transpose() * mean_;
    solver_.compute(covariance_);
    const auto& values = solver_.eigenvalues();
    const Eigen::Index last = vectors.cols() - 1;
    if (!(values(last - dim + 1) > detail::kDependentSquaredSine * values(last))) {
      return false;
    }
    basis.resize(dim, vectors.cols());
    for (int i = 0; i < dim; ++i) {
      basis.row(i) = solver_.eigenvectors().col(last - i).transpose();
    }
    return true;
  }

 private:
  Eigen::RowVectorXd mean_;
  Eigen::MatrixXd covariance_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver_;
};

/// Tilts a basis by the linear part of a quadratic fit through x.
class JetFit {
 public:
  /// Leaves the basis alone where there are fewer neighbors than unknowns, or where the
  /// fit is degenerate.
  void refine(const RowMatrix& vectors, RowMatrix& basis) {
    const Eigen::Index dim = basis.rows();
    const Eigen::Index unknowns = dim + dim * (dim + 1) / 2;
    if (vectors.rows() < unknowns) {
      return;
    }
    coordinates_.noalias() = vectors * basis.transpose();
    const double length = std::sqrt(coordinates_.rowwise().squaredNorm().maxCoeff());
    coordinates_ /= length;
    design_.resize(vectors.rows(), unknowns);
    design_.leftCols(dim) = coordinates_;
    Eigen::Index column = dim;
    for (Eigen::Index i = 0; i < dim; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        design_.col(column++) = coordinates_.col(i).cwiseProduct(coordinates_.col(j));
      }
    }
    normal_.noalias() = design_.transpose() * design_;
    solver_.compute(normal_);
    const auto pivots = solver_.vectorD();
    if (solver_.info() != Eigen::Success ||
        !(pivots.minCoeff() > detail::kDependentSquaredSine * pivots.maxCoeff())) {
      return;
    }
    right_.noalias() = design_.transpose() * vectors;
    tilted_ = solver_.solve(right_).topRows(dim);
    if (detail::orthonormalize(tilted_)) {
      basis = tilted_;
    }
  }

 private:
  Eigen::MatrixXd coordinates_;
  Eigen::MatrixXd design_;
  Eigen::MatrixXd normal_;
  Eigen::MatrixXd right_;
  RowMatrix tilted_;
  Eigen::LDLT<Eigen::MatrixXd> solver_;
};

template <int K>
class TangentKernel {
 public:
  TangentKernel(const Samples& samples, const TangentOptions& options,
                const Execution& execution)
      : samples_(samples), options_(options), execution_(execution), search_(options.dim) {}

  void compute(Index x, const Index* neighbors, Index count, TangentSpaces& result) {
    {
      const detail::Timed timed(coordinate_seconds_);
      coordinates_.load(samples_, x, neighbors, count);
    }

    const bool found = count > 0 && (options_.estimator == Estimator::kEnclosure
                                         ? find_enclosing(x, neighbors, result)
                                         : find_fitted());
    result.boundary[x] = found ? 0 : 1;
    const auto row = static_cast<std::size_t>(x);
    const detail::Timed timed(coordinate_seconds_);
    if (samples_.has_points()) {
      const std::size_t size = basis_size();
      double* out = result.bases.data() + row * size;
      if (found) {
        std::copy_n(basis_.data(), size, out);
      } else {
        std::fill_n(out, size, std::numeric_limits<double>::quiet_NaN());
      }
    } else if (found) {
      std::copy_n(coefficients_.data(), coefficients_.size(),
                  result.coefficients.data() +
                      row * options_.dim * result.num_coefficients);
    }
  }

  double coordinate_seconds() const { return coordinate_seconds_; }

 private:
  std::size_t basis_size() const {
    return static_cast<std::size_t>(options_.dim) * samples_.ambient_dim();
  }

  bool find_enclosing(Index x, const Index* neighbors, TangentSpaces& result) {
    const Index* ranks = search_.find(coordinates_.gram(), execution_);
    if (ranks == nullptr) {
      return false;
    }
    const int dim = options_.dim;
    Index* simplex =
        result.simplices.data() + static_cast<std::size_t>(x) * (dim + 1);
    for (int i = 0; i <= dim; ++i) {
      simplex[i] = neighbors[ranks[i]];
    }
    if (!samples_.has_points()) {
      coefficients_.setZero(dim, coordinates_.count());
      for (int i = 0; i < dim; ++i) {
        coefficients_(i, ranks[i + 1]) = 1;
        coefficients_(i, ranks[0]) = -1;
      }
      return detail::orthonormalize(coefficients_, coordinates_.gram());
    }
    const detail::Timed timed(coordinate_seconds_);
    // From the coordinates: the Gram matrix has lost half of the digits of a thin simplex.
    const int ambient_dim = samples_.ambient_dim();
    basis_.resize(dim, ambient_dim);
    const double* origin = samples_.point(simplex[0]);
    for (int i = 0; i < dim; ++i) {
      const double* vertex = samples_.point(simplex[i + 1]);
      for (int j = 0; j < ambient_dim; ++j) {
        basis_(i, j) = vertex[j] - origin[j];
      }
    }
    return detail::orthonormalize(basis_);
  }

  bool find_fitted() {
    const RowMatrix& vectors = coordinates_.vectors();
    if (!principal_.find(vectors, options_.dim, fitted_)) {
      return false;
    }
    if (options_.estimator == Estimator::kJet) {
      jet_.refine(vectors, fitted_);
      jet_.refine(vectors, fitted_);
    }
    if (coordinates_.direct()) {
      basis_ = fitted_;
      return true;
    }
    coefficients_ = coordinates_.to_coefficients(fitted_);
    if (!samples_.has_points()) {
      return detail::orthonormalize(coefficients_, coordinates_.gram());
    }
    const detail::Timed timed(coordinate_seconds_);
    coordinates_.to_ambient(coefficients_, basis_);
    return detail::orthonormalize(basis_);
  }

  const Samples& samples_;
  const TangentOptions& options_;
  const Execution& execution_;
  LocalCoordinates coordinates_;
  detail::EnclosingSimplex<K> search_;
  PrincipalDirections principal_;
  JetFit jet_;
  RowMatrix fitted_;
  RowMatrix basis_;
  RowMatrix coefficients_;
  double coordinate_seconds_ = 0;
};

void validate(const Samples& samples, const TangentOptions& options) {
  if (options.dim < 1) {
    throw std::invalid_argument("dim is " + std::to_string(options.dim) +
                                ", expected at least 1");
  }
  if (samples.has_points() && options.dim > samples.ambient_dim()) {
    throw std::invalid_argument("dim is " + std::to_string(options.dim) +
                                ", more than the " +
                                std::to_string(samples.ambient_dim()) +
                                " coordinates of the points");
  }
  if (options.num_neighbors < options.dim + 1) {
    throw std::invalid_argument(
        "num_neighbors is " + std::to_string(options.num_neighbors) +
        ", expected at least dim + 1 = " + std::to_string(options.dim + 1));
  }
}

}  // namespace

TangentSpaces compute_tangent_spaces(const Samples& samples,
                                     const Neighborhoods& neighborhoods,
                                     TangentOptions options, const Execution& execution) {
  if (options.num_neighbors == 0) {
    options.num_neighbors = 10 * options.dim;
  }
  validate(samples, options);
  const Index count = std::min(options.num_neighbors, neighborhoods.count);
  const auto n = static_cast<std::size_t>(samples.size());
  const auto dim = static_cast<std::size_t>(options.dim);

  TangentSpaces result;
  result.dim = options.dim;
  result.simplices.assign(n * (dim + 1), -1);
  result.boundary.resize(n);
  if (samples.has_points()) {
    result.bases.resize(n * dim * samples.ambient_dim());
  } else {
    result.num_coefficients = count;
    result.coefficients.resize(n * dim * count);
  }
  detail::begin_step(execution, Step::kTangentSpaces, samples.size());
  detail::dispatch_dim(options.dim, [&](auto k) {
    using Kernel = TangentKernel<decltype(k)::value>;
    detail::PerThread<Kernel> kernels(
        [&] { return Kernel(samples, options, execution); });
    detail::for_each_block(
        samples.size(), kBlock, execution, [&](Offset begin, Offset end) {
          Kernel& kernel = kernels.local();
          for (Offset i = begin; i < end; ++i) {
            const auto x = static_cast<Index>(i);
            kernel.compute(x, neighborhoods.of(x), count, result);
          }
        });
    for (const Kernel& kernel : kernels) {
      result.coordinate_seconds += kernel.coordinate_seconds();
    }
  });
  return result;
}

}  // namespace remanifold
