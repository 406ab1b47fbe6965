// SPDX-License-Identifier: GPL-3.0-or-later
// Noisy samples moved onto the manifold: each to the quadrics that its neighborhood shows,
// along the normals (moving least squares in any dimension and codimension: Levin,
// Mesh-independent surface interpolation, 2003; Sober and Levin, Manifold approximation by
// moving least-squares projection, 2020). Quadrics are fitted at centers, and a sample goes
// to the mean of those that it is near the middle of (Cleveland and Devlin, Locally
// weighted regression, 1988), so that the cost does not grow with the neighborhoods.
//
// Their size is that at which noise and bias balance. A ladder of sizes is looked at, at
// some samples: noise is the scatter about the quadrics where it does not grow with the
// size, and the bias follows from how far the foot of a sample moves from half the size to
// the whole, beyond what noise explains (Lepski, 1991).
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
  /// 0: those at which noise and bias balance.
  Index num_neighbors = 0;
  /// Moves nothing where there is no noise: where the scatter about quadrics grows with
  /// the neighborhoods, or large neighborhoods do not predict better than small ones.
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
  /// Root of the mean squared error of a prediction of a sample by the others, canonical
  /// length.
  double prediction_error = 0;
  /// Root of the mean squared distance from the manifold that is expected to remain,
  /// canonical length.
  double remaining_error = 0;
  /// Samples nearer to each other than this show what remains, not the shape; canonical
  /// length.
  double resolution = 0;
  /// The dimension that neighborhoods of all sizes show; K where they may be of a
  /// K-manifold or there are too few samples to tell. Noise that drowns the shape fills
  /// space, as well as a manifold of more dimensions does.
  int fitting_dim = 0;
  /// The noise is as large as the shape: no neighborhood is wide enough to average it out
  /// and narrow enough to be the graph of a quadric.
  bool drowned = false;
  /// The samples lie in two layers, not about one: what passed for noise was the distance
  /// between them, and nothing was moved.
  bool layers = false;
  /// With `growth` times as many samples it would not be.
  double growth = 1;
};

/// How many samples smooth() first looks at among so many, and which one of all in their
/// order is the i-th.
Offset num_noise_probes(Offset size);
Offset noise_probe(Offset i, Offset size);

/// What that look finds at some samples of a part, of each so many times so many values; and
/// whether those of all probes, in their order, show noise or more dimensions than K: if
/// not, smooth() moves nothing with only_noise.
constexpr int kNoiseTests = 3;
constexpr int kNoiseValues = 11;
std::vector<double> test_noise_at(const Samples& samples, const NeighborSearch& search,
                                  int dim, const std::vector<Index>& probes,
                                  const Execution& execution = {});
/// \param samples  any part of the whole
bool shows_noise(const Samples& samples, int dim, const std::vector<double>& tests);

/// Points only.
/// \throws std::invalid_argument  K < 1 or > D, fewer neighbors than K + 1, no points
Smoothing smooth(const Samples& samples, const NeighborSearch& search,
                 const SmoothingOptions& options, const Execution& execution = {});

}  // namespace remanifold
