// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/simplex_measures.hpp"

#include "base/parallel.hpp"
#include "base/select_few.hpp"
#include "base/small_systems.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace remanifold {
namespace {

constexpr Offset kBlock = 1024;
/// Squared volume, in units of a regular simplex of the same edges, below which a simplex
/// has no circumcenter.
constexpr double kFlat = 1e-20;

constexpr int kMaxDim = 16;
using Factors = detail::SymmetricFactors<Eigen::Dynamic, kMaxDim>;
using Small = Factors::Matrix;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDim, 1>;

/// Inner products of the edges from the first vertex of a simplex.
struct Edges {
  Edges(const Samples& samples, const Index* vertices, int dim) : gram(dim, dim) {
    for (int i = 0; i < dim; ++i) {
      gram(i, i) = samples.squared_distance(vertices[0], vertices[i + 1]);
      squares += gram(i, i);
    }
    for (int i = 0; i < dim; ++i) {
      for (int j = 0; j < i; ++j) {
        const double squared =
            samples.squared_distance(vertices[i + 1], vertices[j + 1]);
        squares += squared;
        gram(i, j) = gram(j, i) = (gram(i, i) + gram(j, j) - squared) / 2;
      }
      product *= gram(i, i);
    }
    factors.compute(gram);
  }

  bool are_flat() const { return !(factors.determinant() > kFlat * product); }

  /// Barycentric coordinates of the circumcenter but for that of the first vertex.
  SmallVector center() {
    SmallVector weights = gram.diagonal() / 2;
    factors.solve(weights);
    return weights;
  }

  Small gram;
  Factors factors;
  double squares = 0;  ///< of all edges, summed
  double product = 1;  ///< of the diagonal
};

}  // namespace

std::vector<double> local_scales(const Samples& samples,
                                 const Neighborhoods& neighborhoods, int dim,
                                 const Execution& execution) {
  const Index n = samples.size();
  const Index count = std::min(scale_neighbors(dim), neighborhoods.count);
  std::vector<double> raw(n, 0.0);
  std::vector<double> scales(n, 0.0);
  if (count == 0) {
    return scales;
  }
  detail::for_each_block_uncounted(n, kBlock, execution, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      const auto x = static_cast<Index>(i);
      raw[x] = std::sqrt(samples.squared_distance(x, neighborhoods.of(x)[count - 1]));
    }
  });
  detail::for_each_block_uncounted(n, kBlock, execution, [&](Offset begin, Offset end) {
    std::vector<double> near(count + 1);
    detail::FewSelector selector;
    for (Offset i = begin; i < end; ++i) {
      const auto x = static_cast<Index>(i);
      near[0] = raw[x];
      for (Index k = 0; k < count; ++k) {
        near[k + 1] = raw[neighborhoods.of(x)[k]];
      }
      scales[x] = selector.select(near, static_cast<std::size_t>(count) / 2);
    }
  });
  return scales;
}

double evenness(const Samples& samples, const Neighborhoods& neighborhoods,
                const std::vector<double>& scales, int dim,
                const Execution& execution) {
  if (neighborhoods.count == 0) {
    return 0;
  }
  if (samples.whole() != nullptr) {
    return samples.whole()->evenness;
  }
  std::vector<double> ratios =
      nearest_over_scale(samples, neighborhoods, scales, execution);
  const auto tenth = ratios.begin() + static_cast<Offset>(ratios.size() / 10);
  std::nth_element(ratios.begin(), tenth, ratios.end());
  return evenness_of(*tenth, dim);
}

std::vector<double> nearest_over_scale(const Samples& samples,
                                       const Neighborhoods& neighborhoods,
                                       const std::vector<double>& scales,
                                       const Execution& execution) {
  std::vector<double> ratios(samples.size());
  detail::for_each_block_uncounted(
      samples.size(), kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset i = begin; i < end; ++i) {
          const auto x = static_cast<Index>(i);
          ratios[x] = std::sqrt(samples.squared_distance(x, neighborhoods.of(x)[0])) /
                      scales[x];
        }
      });
  return ratios;
}

double evenness_of(double tenth, int dim) {
  // Of a Poisson process: one in ten has a neighbor in a ball that holds -log(0.9) samples
  // on average, where h holds as many as it has neighbors.
  const double random = std::pow(-std::log(0.9) / scale_neighbors(dim), 1.0 / dim);
  const double low = random + 0.3 * (1 - random);
  const double high = random + 0.42 * (1 - random);
  return std::clamp((tenth - low) / (high - low), 0.0, 1.0);
}

SimplexMeasures SimplexRuler::measure(const Index* vertices, int arity) const {
  SimplexMeasures result;
  const int dim = arity - 1;
  if (dim == 0) {
    result.volume = 1;
    return result;
  }
  if (dim == 2) {
    const double a = samples_.squared_distance(vertices[0], vertices[1]);
    const double b = samples_.squared_distance(vertices[0], vertices[2]);
    const double c = samples_.squared_distance(vertices[1], vertices[2]);
    const double product = (a + b - c) / 2;
    const double determinant = a * b - product * product;
    result.squared_edges = a + b + c;
    result.volume = determinant > 0 ? std::sqrt(determinant) / 2 : 0;
    result.circumradius = determinant > kFlat * a * b
                              ? std::sqrt(a * b * c / determinant) / 2
                              : std::numeric_limits<double>::infinity();
    return result;
  }
  Edges edges(samples_, vertices, dim);
  result.squared_edges = edges.squares;
  const double determinant = edges.factors.determinant();
  double factorial = 1;
  for (int i = 2; i <= dim; ++i) {
    factorial *= i;
  }
  result.volume = determinant > 0 ? std::sqrt(determinant) / factorial : 0;
  if (edges.are_flat()) {
    result.circumradius = std::numeric_limits<double>::infinity();
    return result;
  }
  const SmallVector half = edges.gram.diagonal() / 2;
  result.circumradius = std::sqrt(std::max(0.0, half.dot(edges.center())));
  return result;
}

bool SimplexRuler::holds_center(const Index* vertices, int arity,
                                double tolerance) const {
  const int dim = arity - 1;
  if (dim < 1 || dim > kMaxDim) {
    return false;
  }
  Edges edges(samples_, vertices, dim);
  if (edges.are_flat()) {
    return false;
  }
  const SmallVector weights = edges.center();
  double first = 1;  // coordinate of the first vertex
  for (int i = 0; i < dim; ++i) {
    if (weights[i] < -tolerance) {
      return false;
    }
    first -= weights[i];
  }
  return first >= -tolerance;
}

double SimplexRuler::relative_volume(const Index* vertices, int arity) const {
  const int dim = arity - 1;
  Small edges(dim, dim);
  double lengths = 1;
  for (int i = 0; i < dim; ++i) {
    double square = 0;
    for (int j = 0; j < dim; ++j) {
      const double along =
          samples_.point(vertices[i + 1])[j] - samples_.point(vertices[0])[j];
      edges(i, j) = along;
      square += along * along;
    }
    lengths *= std::sqrt(square);
  }
  return lengths > 0 ? detail::determinant_of(edges) / lengths : 0.0;
}

double SimplexRuler::scale(const Index* vertices, int arity) const {
  double sum = 0;
  for (int i = 0; i < arity; ++i) {
    sum += scales_[vertices[i]];
  }
  return sum / arity;
}

double SimplexRuler::energy(const Index* vertices, int arity) const {
  const SimplexMeasures measures = measure(vertices, arity);
  return measures.volume * measures.squared_edges /
         std::pow(scale(vertices, arity), arity + 1);
}

double SimplexRuler::fold(const Index* facet, int arity, Index apex,
                          Index other_apex) const {
  // Both apexes less their projections on the facet.
  const int dim = arity - 1;
  const auto product = [&](Index a, Index b) {
    return samples_.inner_product(facet[0], a, b);
  };
  double first = product(apex, apex);
  double second = product(other_apex, other_apex);
  double both = product(apex, other_apex);
  if (dim == 1) {
    const double square = product(facet[1], facet[1]);
    const double to_first = product(facet[1], apex);
    const double to_second = product(facet[1], other_apex);
    if (square > std::numeric_limits<double>::min()) {
      first -= to_first / square * to_first;
      second -= to_second / square * to_second;
      both -= to_first / square * to_second;
    }
  } else if (dim > 1) {
    Small gram(dim, dim);
    SmallVector to_first(dim);
    SmallVector to_second(dim);
    for (int i = 0; i < dim; ++i) {
      for (int j = 0; j <= i; ++j) {
        gram(i, j) = gram(j, i) = product(facet[i + 1], facet[j + 1]);
      }
      to_first[i] = product(facet[i + 1], apex);
      to_second[i] = product(facet[i + 1], other_apex);
    }
    Factors factors;
    factors.compute(gram);
    SmallVector first_weights = to_first;
    SmallVector second_weights = to_second;
    factors.solve(first_weights);
    factors.solve(second_weights);
    first -= first_weights.dot(to_first);
    second -= second_weights.dot(to_second);
    both -= first_weights.dot(to_second);
  }
  const double lengths = std::sqrt(std::max(0.0, first) * std::max(0.0, second));
  return lengths > 0 ? std::clamp(both / lengths, -1.0, 1.0) : 1.0;
}

double SimplexRuler::facet_size(const Index* vertices, int arity) const {
  return measure(vertices, arity).volume / std::pow(scale(vertices, arity), arity - 1);
}

}  // namespace remanifold
