// SPDX-License-Identifier: GPL-3.0-or-later
// What the samples and the result say about each other, sample by sample: the spacing, the
// scatter about a quadric fitted to the neighborhood at two widths (noise stays, what is
// left of the shape shrinks with the width), curvature and reach, and what does not occur
// where the sampling is dense enough: simplices that stand off the tangent space, folds,
// gaps, and samples that are near in space and far along the result.
//
// The reach is Federer's: 1 / reach(x) = max over q of 2 d(q - x, T_x) / |q - x|^2
// (Aamari, Kim, Chazal, Michel, Rinaldo, Wasserman, Estimating the reach of a manifold,
// 2019), over the neighborhood: curvature and sheets nearby alike bound it.
//
// Cost O(N m^2 K^2) beyond the neighborhoods, memory O(N).
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

struct QualityOptions {
  int dim = 0;              ///< K
  Index num_neighbors = 0;  ///< of the narrow fit, half of the wide one; 0: of a jet
  /// What a jet over as many neighbors finds, where that is known: orthonormal bases by
  /// input number, K x D each, NaN where there is none. Not copied; points only.
  const double* tangents = nullptr;
  Index num_listed = 0;  ///< neighbors of each sample that are handed over
};

/// Neighbors of all samples, copies left out.
struct ListedNeighbors {
  /// In an order of the samples in which those near each other are near in memory; numbers
  /// in that order.
  Neighborhoods near;
  std::vector<Index> numbers;  ///< input numbers of the samples in that order
};

/// \param count  of each sample; fewer where there are fewer samples
ListedNeighbors list_neighbors(const Samples& samples, const NeighborSearch& search,
                               Index count, const Execution& execution = {});

/// By input number, copies like the sample they were merged with; input lengths. NaN where
/// a sample has too few neighbors.
struct SamplingQuality {
  std::vector<double> spacing;        ///< h, see local_scales
  std::vector<double> scatter;        ///< root mean square distance from the narrow fit
  std::vector<double> wide_scatter;   ///< the same for the wide fit
  std::vector<double> curvature;      ///< largest norm of the second fundamental form
  std::vector<double> reach;          ///< infinite where the neighborhood is flat
  std::vector<double> tangent_share;  ///< volume of the star on T_x over its own volume
  std::vector<double> fold;           ///< largest fold in degrees away from the rim
  std::vector<double> gap;            ///< largest empty ball away from the rim
  std::vector<double>
      nearest_strange;            ///< distance to the nearest sample far along the
                                  ///< result; infinite where none of the neighbors is
  std::vector<std::uint8_t> rim;  ///< 2: on an open facet, 1: in a simplex with such
  /// What list_neighbors() gives of at least num_listed; empty where none are asked for.
  ListedNeighbors listed;
};

/// \param simplices  in input numbers, columns in any order
SamplingQuality measure_quality(const Samples& samples, const NeighborSearch& search,
                                const SimplexArray& simplices,
                                const QualityOptions& options,
                                const Execution& execution = {});

}  // namespace remanifold
