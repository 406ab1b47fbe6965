// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/tangent_space.hpp"

#include "base/assertions.hpp"
#include "base/dispatch.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "base/tolerance.hpp"
#include "local/enclosing_simplex.hpp"
#include "local/frame_fit.hpp"
#include "local/local_coordinates.hpp"
#include "remanifold/verify.hpp"

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

/// The tangent spaces of one thread. Samples go in groups: first all coordinates of a
/// group are read, then its tangent spaces are found in local coordinates, then they are
/// written out in R^D. Large D then neither slows down what lies between nor hides in it.
template <int K, int D>
class TangentKernel {
 public:
  TangentKernel(const Samples& samples, const Neighborhoods& neighborhoods, Index count,
                const TangentOptions& options, const Execution& execution)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        count_(count),
        options_(options),
        execution_(execution),
        distances_(samples, neighborhoods),
        search_(options.dim),
        fit_(options.dim) {}

  void compute(Index begin, Index end, TangentSpaces& result) {
    if (D != Eigen::Dynamic && options_.estimator != Estimator::kEnclosure) {
      for (Index x = begin; x < end; ++x) {
        fit_at(x, result);
      }
      return;
    }
    group_.resize(std::max<std::size_t>(group_.size(), end - begin));
    {
      const detail::Timed timed(coordinate_seconds_);
      for (Index x = begin; x < end; ++x) {
        LocalCoordinates& coordinates = group_[x - begin].coordinates;
        if (distances_.pay() && samples_.ambient_dim() > count_) {
          coordinates.load(distances_, x, neighborhoods_.of(x), count_);
        } else {
          coordinates.load(samples_, x, neighborhoods_.of(x), count_);
        }
      }
    }
    for (Index x = begin; x < end; ++x) {
      Local& local = group_[x - begin];
      local.found = count_ > 0 && (options_.estimator == Estimator::kEnclosure
                                       ? find_enclosing(x, local, result)
                                       : find_fitted(local, result));
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

  /// In space, without detours.
  void fit_at(Index x, TangentSpaces& result) {
    const Index* neighbors = neighborhoods_.of(x);
    const double* px = samples_.point(x);
    fit_.resize(count_, D);
    for (Index i = 0; i < count_; ++i) {
      const double* pq = samples_.point(neighbors[i]);
      for (int axis = 0; axis < D; ++axis) {
        fit_.coordinate(i, axis) = pq[axis] - px[axis];
      }
    }
    write_points(x, count_ > 0 && fit_.fit(options_.estimator == Estimator::kJet),
                 fit_.frame(), result);
  }

  bool find_fitted(Local& local, const TangentSpaces& result) {
    const RowMatrix& vectors = local.coordinates.vectors();
    fit_.resize(count_, vectors.cols());
    for (Index i = 0; i < count_; ++i) {
      for (Eigen::Index axis = 0; axis < vectors.cols(); ++axis) {
        fit_.coordinate(i, axis) = vectors(i, axis);
      }
    }
    if (!fit_.fit(options_.estimator == Estimator::kJet)) {
      return false;
    }
    local.basis = fit_.frame();
    if (local.coordinates.direct()) {
      return true;
    }
    local.coefficients = local.coordinates.to_coefficients(local.basis);
    return !result.bases.empty() ||
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
    if (!result.bases.empty()) {
      if (local.found && options_.estimator == Estimator::kEnclosure) {
        span_simplex(simplex_of(x, result), local.basis);
        local.found = detail::orthonormalize(local.basis);
      } else if (local.found && !local.coordinates.direct()) {
        local.coordinates.to_ambient(local.coefficients, local.basis);
        local.found = detail::orthonormalize(local.basis);
      }
      write_points(x, local.found, local.basis, result);
    } else if (local.found) {
      std::copy_n(local.coefficients.data(), local.coefficients.size(),
                  result.coefficients.data() +
                      static_cast<std::size_t>(x) * options_.dim * count_);
    }
    if (!result.neighbors.empty()) {
      std::copy_n(neighborhoods_.of(x), count_,
                  result.neighbors.data() + static_cast<std::size_t>(x) * count_);
    }
    result.boundary[x] = local.found ? 0 : 1;
    if (!local.found) {
      std::fill_n(simplex_of(x, result), options_.dim + 1, -1);
    }
  }

  template <class Basis>
  void write_points(Index x, bool found, const Basis& basis, TangentSpaces& result) {
    const auto size = static_cast<std::size_t>(options_.dim) * samples_.ambient_dim();
    double* out = result.bases.data() + static_cast<std::size_t>(x) * size;
    if (found) {
      std::copy_n(basis.data(), size, out);
    } else {
      std::fill_n(out, size, std::numeric_limits<double>::quiet_NaN());
    }
    result.boundary[x] = found ? 0 : 1;
  }

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  Index count_;
  const TangentOptions& options_;
  const Execution& execution_;
  detail::KnownDistances distances_;
  std::vector<Local> group_;
  detail::EnclosingSimplex<K> search_;
  detail::FrameFit<K, D> fit_;
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
    options.num_neighbors = paper_neighbors(options.dim);
  }
  validate(samples, options);
  const Index count = std::min(options.num_neighbors, neighborhoods.count);
  const auto n = static_cast<std::size_t>(samples.size());
  const auto dim = static_cast<std::size_t>(options.dim);

  TangentSpaces result;
  result.dim = options.dim;
  result.simplices.assign(n * (dim + 1), -1);
  result.boundary.resize(n);
  // The Gram matrix has lost half of the digits of a thin simplex: what encloses needs
  // coordinates.
  const bool by_distances = detail::KnownDistances(samples, neighborhoods).pay() &&
                            samples.ambient_dim() > count &&
                            options.estimator != Estimator::kEnclosure;
  if (samples.has_points() && !by_distances) {
    const detail::Timed timed(result.coordinate_seconds);
    result.bases.resize(n * dim * samples.ambient_dim());
  } else {
    result.num_coefficients = count;
    result.coefficients.assign(n * dim * count,
                               std::numeric_limits<double>::quiet_NaN());
    result.neighbors.resize(by_distances ? n * count : 0);
  }
  detail::begin_step(execution, Step::kTangentSpaces, samples.size());
  const auto run = [&](auto k, auto d) {
    using Kernel = TangentKernel<decltype(k)::value, decltype(d)::value>;
    detail::ThreadScratch<Kernel> kernels(
        [&] { return Kernel(samples, neighborhoods, count, options, execution); });
    detail::for_each_block(samples.size(), group_size(options.dim), execution,
                           [&](Offset begin, Offset end) {
                             kernels.use([&](Kernel& kernel) {
                               kernel.compute(static_cast<Index>(begin),
                                              static_cast<Index>(end), result);
                             });
                           });
    kernels.for_each([&](const Kernel& kernel) {
      result.coordinate_seconds += kernel.coordinate_seconds();
    });
  };
  detail::dispatch_dim(options.dim, [&](auto k) {
    if constexpr (k == 1 || k == 2) {
      if (samples.has_points() && samples.ambient_dim() == 3) {
        run(k, std::integral_constant<int, 3>());
        return;
      }
    }
    run(k, std::integral_constant<int, Eigen::Dynamic>());
  });
  detail::assert_that([&] { verify_tangent_spaces(samples, result); });
  return result;
}

}  // namespace remanifold
