// SPDX-License-Identifier: GPL-3.0-or-later
// K = 1: joins the ends of curves and merges tiny loops, which the chain of least energy
// prefers where a curve has sharp corners.
#pragma once

#include "remanifold/cavities.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

/// Ends are joined shortest edge first, as long as an edge costs less than leaving both
/// ends open; a path of fewer than `smallest_loop` samples is not closed while another
/// end is near. Loops of fewer samples are merged with the curve next to them, at the least
/// energy and for no more than four open ends would cost; not where they are much farther
/// from it than from each other: a curve that leaves its way for such a loop, there and
/// back, lets go of it.
/// \param edges  no sample in more than two; rows sorted in the result
void repair_curves(const Samples& samples, const Neighborhoods& neighborhoods,
                   const std::vector<double>& scales, const FacetPrice& price,
                   Index smallest_loop, SimplexArray& edges,
                   const Execution& execution = {});

}  // namespace remanifold
