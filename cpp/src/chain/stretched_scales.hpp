// SPDX-License-Identifier: GPL-3.0-or-later
// The spacing where samples lie denser in some directions than in others: scan lines, rings
// of a turned part, vertices of long thin triangles. The nearest neighbors are all on one
// line there, and their distance is no spacing of the samples; simplices on which the
// stars agree reach across and tell it.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/star_consensus.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold::detail {

/// By how much the local scale is too small, 1 or more for each sample; empty where it is
/// right everywhere. Cost linear in the number of simplices.
/// \param stars  K at least 2
/// \param radii  circumradius of each simplex over the local scale at its vertices
std::vector<double> stretch_of_scales(const StarSimplices& stars,
                                      const std::vector<float>& radii,
                                      Index num_samples,
                                      const Execution& execution = {});

}  // namespace remanifold::detail
