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

/// Samples that stand for all others: every so many of them, in their order.
Offset outlier_probe_stride(Offset size);
/// Distance, in the units of OutlierOptions, that an outlier has at least.
/// \param relative  of all that stand for the others, as from outlier_evidence()
double least_outlier_distance(double distance, std::vector<double> relative);

/// Of a part: what find_outliers() would ask at first about some of its samples.
struct OutlierQuestions {
  std::vector<Index> apart;   ///< samples far from others
  std::vector<Index> probes;  ///< samples that stand for all
  double median_scale = 0;    ///< of all
};
struct OutlierEvidence {
  std::vector<double> away;  ///< of those that are outliers if farther than the least
  std::vector<double> relative;  ///< of each probe
  double reach =
      0;  ///< within which all samples have to be here; infinite along curves
};
OutlierEvidence outlier_evidence(const Samples& samples, const NeighborSearch& search,
                                 const Neighborhoods& neighborhoods,
                                 const OutlierOptions& options,
                                 const OutlierQuestions& asked,
                                 const Execution& execution = {});

/// Neighbors that say how far off a sample is, among so many samples; and how many times the
/// median scale is sparse, where samples may be outliers that have only each other.
Index outlier_votes(int dim, Offset size);
constexpr double kSparseScale = 3;

}  // namespace remanifold
