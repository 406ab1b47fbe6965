// SPDX-License-Identifier: GPL-3.0-or-later
// The local scale of the samples, and sizes of simplices from squared distances alone.
#pragma once

#include "remanifold/constants.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

/// h(x): the distance to the neighbor of rank scale_neighbors(K), smoothed by the median over x and these
/// neighbors. Canonical lengths.
std::vector<double> local_scales(const Samples& samples,
                                 const Neighborhoods& neighborhoods, int dim,
                                 const Execution& execution = {});

/// How evenly the samples lie, from 0 (independent of each other) to 1 (no two much nearer
/// than the rest): from the tenth percentile of the nearest-neighbor distance over h.
double evenness(const Samples& samples, const Neighborhoods& neighborhoods,
                const std::vector<double>& scales, int dim,
                const Execution& execution = {});

/// The nearest-neighbor distance of each sample over h, and the evenness that follows from
/// their N / 10-th, counted from 0.
std::vector<double> nearest_over_scale(const Samples& samples,
                                       const Neighborhoods& neighborhoods,
                                       const std::vector<double>& scales,
                                       const Execution& execution = {});
double evenness_of(double tenth, int dim);

struct SimplexMeasures {
  double volume = 0;
  double circumradius = 0;   ///< infinite where the simplex is flat
  double squared_edges = 0;  ///< sum over all edges
};

/// Measures simplices one after the other.
class SimplexRuler {
 public:
  SimplexRuler(const Samples& samples, const std::vector<double>& scales)
      : samples_(samples), scales_(scales) {}

  SimplexMeasures measure(const Index* vertices, int arity) const;
  /// Whether a simplex has its circumcenter inside, or outside by no more than this share
  /// of a height.
  bool holds_center(const Index* vertices, int arity, double tolerance) const;
  /// Whether the simplices fill their space, K = D, so that each has a sign of its own.
  bool fills_space(int arity) const {
    return samples_.has_points() && samples_.ambient_dim() == arity - 1;
  }
  /// Determinant of the edges from the first vertex over the product of their lengths,
  /// where the simplices fill their space.
  double relative_volume(const Index* vertices, int arity) const;
  /// Sign of that; 1 where it is zero.
  int orientation(const Index* vertices, int arity) const {
    return relative_volume(vertices, arity) < 0 ? -1 : 1;
  }
  /// Mean of h over the vertices.
  double scale(const Index* vertices, int arity) const;
  /// Volume times sum of squared edges over h^(K+2): up to a constant the L1 distance
  /// between |x|^2 and its linear interpolant on the simplex, which a Delaunay
  /// triangulation minimises (Chen and Xu, Optimal Delaunay triangulations, 2004).
  double energy(const Index* vertices, int arity) const;
  /// Cosine of the angle between two simplices at their common facet; -1 where they
  /// continue each other without a fold.
  double fold(const Index* facet, int arity, Index apex, Index other_apex) const;
  /// Volume of a (K-1)-simplex over h^(K-1).
  double facet_size(const Index* vertices, int arity) const;

 private:
  const Samples& samples_;
  const std::vector<double>& scales_;
};

}  // namespace remanifold
