// SPDX-License-Identifier: GPL-3.0-or-later
// What can be chosen about a whole reconstruction. Each step has options of its own beside
// it; here are those that a caller of reconstruct() sets, with the defaults of the method.
#pragma once

#include "remanifold/clique_complex.hpp"
#include "remanifold/manifold_complex.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/smoothing.hpp"
#include "remanifold/tangent_space.hpp"
#include "remanifold/types.hpp"

#include <functional>
#include <optional>

namespace remanifold {

struct ReconstructOptions {
  int dim = 0;  ///< K
  /// Neighbors for the tangent spaces; 0: jet_neighbors(K), with the paper's method
  /// paper_neighbors(K).
  Index num_neighbors = 0;
  /// By default jet, with the paper's method enclosure.
  std::optional<Estimator> estimator;
  SearchOptions search;

  /// OutlierOptions::distance; 0 keeps all samples. By default kOutlierDistance, with the
  /// paper's method 0.
  std::optional<double> outlier_distance;
  bool smooth = false;
  SmoothingOptions smoothing;  ///< its dim and search are those above
  /// Called with Smoothing::fitting_dim where that is not K, before anything dear is done;
  /// may throw.
  std::function<void(int)> on_other_dim;

  ManifoldOptions manifold;            ///< the default method: boundary and the like
  EdgeRule edges = EdgeRule::kMutual;  ///< the paper's method
};

}  // namespace remanifold
