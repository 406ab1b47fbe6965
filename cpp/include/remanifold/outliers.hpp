// SPDX-License-Identifier: GPL-3.0-or-later
// Samples that do not lie on the manifold of the others. A sample is judged by its
// neighbors: by its normal distances from the quadrics through their neighborhoods,
// without itself, of which the lower quartile counts, since at a crease or a corner some
// neighbors lie on the same side. Outliers hide each other, so that the search is repeated
// among the rest until none is found.
#pragma once

#include "remanifold/constants.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

struct OutlierOptions {
  int dim = 0;  ///< K
  /// Distance from which on a sample is an outlier, in units of the local scale (the
  /// distance to the (2K+2)-th neighbor around it, and no more than twice the median of
  /// these; the distance between the curves where samples are dense along curves). Noisy
  /// samples lie apart anyway: no less than eight times the distance that one
  /// in four exceeds.
  double distance = kOutlierDistance;
};

struct Outliers {
  std::vector<Index> samples;  ///< ascending
  /// Whether they are strewn about the manifold. What sharp features and coarse sampling
  /// make look like outliers lies just beyond the distance; clutter lies anywhere: at least
  /// five, and a third of all, are twice as far from all other samples.
  bool are_clutter = false;
};

/// Costs next to nothing where no sample lies apart from others.
/// \throws std::invalid_argument  K < 1, or a distance that is not positive
Outliers find_outliers(const Samples& samples, const NeighborSearch& search,
                       const Neighborhoods& neighborhoods,
                       const OutlierOptions& options, const Execution& execution = {});

}  // namespace remanifold
