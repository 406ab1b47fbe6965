// SPDX-License-Identifier: GPL-3.0-or-later
// Noisy samples moved onto the manifold: each to the quadric that its neighborhood shows,
// along the normals (moving least squares in any dimension and codimension: Levin,
// Mesh-independent surface interpolation, 2003; Sober and Levin, Manifold approximation by
// moving least-squares projection, 2020). The size of the neighborhoods is that at which
// samples are predicted best by the others (leave-one-out cross-validation): many where
// noise is what separates them, few where curvature is.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

struct SmoothingOptions {
  int dim = 0;  ///< K
  /// Neighbors that a quadric is fitted to, their weights falling to zero at the last;
  /// 0: by cross-validation.
  Index num_neighbors = 0;
  /// Moves nothing where cross-validation finds no noise: where large neighborhoods do not
  /// predict better than small ones.
  bool only_noise = true;
  SearchOptions search;
};

struct Smoothing {
  /// size() x D in canonical lengths; empty where nothing was moved.
  std::vector<double> points;
  Index num_neighbors = 0;  ///< as used; 0 where nothing was moved
  int rounds = 0;           ///< neighborhoods are found again among what was moved
  /// Root of the mean squared normal distance between samples and manifold, canonical
  /// length. NaN where there are too few samples to tell.
  double noise = 0;
  /// The least root of the mean squared error of a prediction, canonical length.
  double prediction_error = 0;
};

/// Points only.
/// \throws std::invalid_argument  K < 1 or > D, fewer neighbors than K + 1, no points
Smoothing smooth(const Samples& samples, const NeighborSearch& search,
                 const SmoothingOptions& options, const Execution& execution = {});

}  // namespace remanifold
