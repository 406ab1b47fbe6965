// SPDX-License-Identifier: GPL-3.0-or-later
// Approximate tangent space ATS(x) of each sample (Freedman 2002, section 3.1), by
// - enclosure: the first (K+1)-tuple of NBD(x), in colexicographic order of neighbor
//   ranks, whose simplex holds the projection of x and of no other neighbor;
// - PCA: the K leading principal directions of the neighborhood;
// - jet: PCA, then twice a quadratic fit of the neighborhood over the tangent
//   coordinates, whose linear part tilts the basis (order h^2 instead of h).
// A sample without a tangent basis belongs to the boundary BD.
// Work per sample is in the m x m Gram matrix of the neighborhood: free of D.
#pragma once

#include "remanifold/constants.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

enum class Estimator { kEnclosure, kPca, kJet };

struct TangentOptions {
  int dim = 0;              ///< K
  Index num_neighbors = 0;  ///< m = rK; 0: paper_neighbors(K)
  Estimator estimator = Estimator::kEnclosure;
};

struct TangentSpaces {
  int dim = 0;
  /// Points: size() x K x D, orthonormal rows. Empty where only products are known, or
  /// where there are more coordinates than one wants to store.
  std::vector<double> bases;
  /// Otherwise: size() x K x m, the basis vectors as combinations of the differences
  /// between the first m neighbors and the sample; NaN where there is none.
  std::vector<double> coefficients;
  Index num_coefficients = 0;    ///< m
  std::vector<Index> neighbors;  ///< points: size() x m, these neighbors
  /// size() x (K+1): the tangent basis tuple, nearest first; -1 where there is none.
  std::vector<Index> simplices;
  std::vector<std::uint8_t> boundary;  ///< 1: no tangent basis
  double coordinate_seconds = 0;       ///< thread time spent on coordinates
};

/// \throws std::invalid_argument  K < 1, K > D, fewer neighbors than K + 1 asked for
TangentSpaces compute_tangent_spaces(const Samples& samples,
                                     const Neighborhoods& neighborhoods,
                                     TangentOptions options,
                                     const Execution& execution = {});

/// Where samples are dense along curves and sparse across them, as on scan lines, the
/// nearest neighbors lie on one curve. There, for K of at least 2, fits again to the nearest
/// in a metric in which both are as dense, among 512 neighbors at most. Points only; with
/// the enclosure nothing is done.
void refit_along_curves(const Samples& samples, const NeighborSearch& search,
                        const Neighborhoods& neighborhoods,
                        const TangentOptions& options, TangentSpaces& tangents,
                        const Execution& execution = {});

/// N x K x D: what TangentSpaces::coefficients stand for, in the numbering of the points.
/// \param scale  of the samples
std::vector<double> tangent_bases(MatrixView points, int dim,
                                  const double* coefficients, const Index* neighbors,
                                  Index count, double scale,
                                  const Execution& execution = {});

}  // namespace remanifold
