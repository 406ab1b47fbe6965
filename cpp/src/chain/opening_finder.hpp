// SPDX-License-Identifier: GPL-3.0-or-later
// Finds where a complex bridges openings of the manifold, and weighs each: simplices whose
// empty balls are larger than nearly all among independent samples are put into connected
// clusters (as supra-threshold clusters are in the statistics of random fields: Friston et
// al., Assessing the significance of focal activations using their spatial extent, 1994),
// and the excess of volume of a cluster is weighed against the simplices around it.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/openings.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold::detail {

struct OpeningLevels {
  /// Openings no likelier than this to be among the data by chance are opened; 0: none.
  double significance = 0;
  /// Openings of which more than so many are to be expected are not listed.
  double most_expected = 1;
  /// Whatever the evidence is.
  std::vector<OpeningDecision> decisions = {};
};

struct WeighedOpenings {
  std::vector<Opening> openings;  ///< the least expected first
  /// Rows of the simplices to take out, ascending: those of the open ones.
  std::vector<Offset> bridges;
};

/// Cost linear in the number of simplices.
/// \param simplices  columns ascending
/// \param scales     as from local_scales(), times
/// \param stretch    by which they were too small; empty: 1
WeighedOpenings weigh_openings(const Samples& samples,
                               const Neighborhoods& neighborhoods,
                               const std::vector<double>& scales,
                               const std::vector<double>& stretch,
                               const SimplexArray& simplices,
                               const OpeningLevels& levels,
                               const Execution& execution = {});

}  // namespace remanifold::detail
