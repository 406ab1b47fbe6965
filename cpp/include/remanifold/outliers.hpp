// SPDX-License-Identifier: GPL-3.0-or-later
// Samples that do not lie on the manifold of the others. A sample is judged by its
// neighbors: by its normal distances from the quadrics through their neighborhoods,
// without itself, of which the lower quartile counts, since at a crease or a corner some
// neighbors lie on the same side; in units of the local scale. Where samples of the shape
// itself lie nearly that far off, of parts that are coarse for their surroundings, the
// limit is twice as far. Far from everything no quadrics agree. Outliers hide each other,
// so that the search is repeated among the rest until none is found.
#pragma once

#include "remanifold/constants.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

struct OutlierOptions {
  int dim = 0;  ///< K
  /// Distance from which on a sample is an outlier, in units of the local scale: the
  /// distance to the (2K+2)-th neighbor, the median over the samples around. Noisy samples
  /// lie apart anyway: no less than eight times the distance that one in four exceeds.
  double distance = kOutlierDistance;
};

enum class OutlierReason : std::uint8_t {
  kOff,       ///< farther off what the neighbors show than any distance that is usual
  kScattered  ///< sparse, and the neighbors show no manifold
};

struct Outlier {
  Index sample;
  OutlierReason reason;
  /// Off what the neighbors show, in local scales.
  double distance;
};

/// The outliers, ascending. Costs next to nothing where no sample lies apart from others.
/// \throws std::invalid_argument  K < 1, or a distance that is not positive
std::vector<Outlier> find_outliers(const Samples& samples, const NeighborSearch& search,
                                   const Neighborhoods& neighborhoods,
                                   const OutlierOptions& options,
                                   const Execution& execution = {});

}  // namespace remanifold
