// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/tangent_space.hpp"

#include "detail/dispatch.hpp"
#include "detail/enclosing_simplex.hpp"
#include "detail/local_coordinates.hpp"
#include "detail/parallel.hpp"
#include "detail/tolerance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

using detail::LocalCoordinates;
using detail::RowMatrix;

/// Samples whose coordinates are read together; fewer where each may take seconds.
constexpr Offset group_size(int dim) { return dim < 4 ? 32 : dim == 4 ? 8 : 1; }

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

/// The tangent spaces of one thread. Samples go in groups: first all coordinates of a
/// group are read, then its tangent spaces are found in local coordinates, then they are
/// written out in R^D. Large D then neither slows down what lies between nor hides in it.
template <int K>
class TangentKernel {
 public:
  TangentKernel(const Samples& samples, const Neighborhoods& neighborhoods, Index count,
                const TangentOptions& options, const Execution& execution)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        count_(count),
        options_(options),
        execution_(execution),
        search_(options.dim) {}

  void compute(Index begin, Index end, TangentSpaces& result) {
    group_.resize(std::max<std::size_t>(group_.size(), end - begin));
    {
      const detail::Timed timed(coordinate_seconds_);
      for (Index x = begin; x < end; ++x) {
        group_[x - begin].coordinates.load(samples_, x, neighborhoods_.of(x), count_);
      }
    }
    for (Index x = begin; x < end; ++x) {
      Local& local = group_[x - begin];
      local.found = count_ > 0 && (options_.estimator == Estimator::kEnclosure
                                       ? find_enclosing(x, local, result)
                                       : find_fitted(local));
    }
    const detail::Timed timed(coordinate_seconds_);
    for (Index x = begin; x < end; ++x) {
      write(x, group_[x - begin], result);
    }
  }

  double coordinate_seconds() const { return coordinate_seconds_; }

 private:
  struct Local {
    LocalCoordinates coordinates;
    bool found = false;
    RowMatrix basis;         // in local coordinates where these are direct
    RowMatrix coefficients;  // of the neighbor vectors otherwise
  };

  Index* simplex_of(Index x, TangentSpaces& result) const {
    return result.simplices.data() + static_cast<std::size_t>(x) * (options_.dim + 1);
  }

  bool find_enclosing(Index x, Local& local, TangentSpaces& result) {
    const Index* ranks = search_.find(local.coordinates.gram(), execution_);
    if (ranks == nullptr) {
      return false;
    }
    const int dim = options_.dim;
    for (int i = 0; i <= dim; ++i) {
      simplex_of(x, result)[i] = neighborhoods_.of(x)[ranks[i]];
    }
    if (samples_.has_points()) {
      return true;
    }
    local.coefficients.setZero(dim, count_);
    for (int i = 0; i < dim; ++i) {
      local.coefficients(i, ranks[i + 1]) = 1;
      local.coefficients(i, ranks[0]) = -1;
    }
    return detail::orthonormalize(local.coefficients, local.coordinates.gram());
  }

  bool find_fitted(Local& local) {
    const RowMatrix& vectors = local.coordinates.vectors();
    if (!principal_.find(vectors, options_.dim, local.basis)) {
      return false;
    }
    if (options_.estimator == Estimator::kJet) {
      jet_.refine(vectors, local.basis);
      jet_.refine(vectors, local.basis);
    }
    if (local.coordinates.direct()) {
      return true;
    }
    local.coefficients = local.coordinates.to_coefficients(local.basis);
    return samples_.has_points() ||
           detail::orthonormalize(local.coefficients, local.coordinates.gram());
  }

  /// Differences of the tuple's members, from the coordinates: the Gram matrix has lost
  /// half of the digits of a thin simplex.
  void span_simplex(const Index* simplex, RowMatrix& basis) const {
    const int ambient_dim = samples_.ambient_dim();
    basis.resize(options_.dim, ambient_dim);
    const double* origin = samples_.point(simplex[0]);
    for (int i = 0; i < options_.dim; ++i) {
      const double* vertex = samples_.point(simplex[i + 1]);
      for (int j = 0; j < ambient_dim; ++j) {
        basis(i, j) = vertex[j] - origin[j];
      }
    }
  }

  void write(Index x, Local& local, TangentSpaces& result) {
    if (samples_.has_points()) {
      if (local.found && options_.estimator == Estimator::kEnclosure) {
        span_simplex(simplex_of(x, result), local.basis);
        local.found = detail::orthonormalize(local.basis);
      } else if (local.found && !local.coordinates.direct()) {
        local.coordinates.to_ambient(local.coefficients, local.basis);
        local.found = detail::orthonormalize(local.basis);
      }
      const auto size = static_cast<std::size_t>(options_.dim) * samples_.ambient_dim();
      double* out = result.bases.data() + static_cast<std::size_t>(x) * size;
      if (local.found) {
        std::copy_n(local.basis.data(), size, out);
      } else {
        std::fill_n(out, size, std::numeric_limits<double>::quiet_NaN());
      }
    } else if (local.found) {
      std::copy_n(local.coefficients.data(), local.coefficients.size(),
                  result.coefficients.data() +
                      static_cast<std::size_t>(x) * options_.dim * count_);
    }
    result.boundary[x] = local.found ? 0 : 1;
    if (!local.found) {
      std::fill_n(simplex_of(x, result), options_.dim + 1, -1);
    }
  }

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  Index count_;
  const TangentOptions& options_;
  const Execution& execution_;
  std::vector<Local> group_;
  detail::EnclosingSimplex<K> search_;
  PrincipalDirections principal_;
  JetFit jet_;
  double coordinate_seconds_ = 0;
};

void validate(const Samples& samples, const TangentOptions& options) {
  if (options.dim < 1) {
    throw std::invalid_argument("dim is " + std::to_string(options.dim) +
                                ", expected at least 1");
  }
  if (samples.has_points() && options.dim > samples.ambient_dim()) {
    throw std::invalid_argument(
        "dim is " + std::to_string(options.dim) + ", more than the " +
        std::to_string(samples.ambient_dim()) + " coordinates of the points");
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
                                     TangentOptions options,
                                     const Execution& execution) {
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
    const detail::Timed timed(result.coordinate_seconds);
    result.bases.resize(n * dim * samples.ambient_dim());
  } else {
    result.num_coefficients = count;
    result.coefficients.resize(n * dim * count);
  }
  detail::begin_step(execution, Step::kTangentSpaces, samples.size());
  detail::dispatch_dim(options.dim, [&](auto k) {
    using Kernel = TangentKernel<decltype(k)::value>;
    detail::PerThread<Kernel> kernels(
        [&] { return Kernel(samples, neighborhoods, count, options, execution); });
    detail::for_each_block(samples.size(), group_size(options.dim), execution,
                           [&](Offset begin, Offset end) {
                             kernels.local().compute(static_cast<Index>(begin),
                                                     static_cast<Index>(end), result);
                           });
    for (const Kernel& kernel : kernels) {
      result.coordinate_seconds += kernel.coordinate_seconds();
    }
  });
  return result;
}

}  // namespace remanifold
