// SPDX-License-Identifier: GPL-3.0-or-later
// Puts samples that no simplex uses into a complex without changing what it is: the
// simplices on a face near the sample are replaced by those that join the sample with the
// rest of their boundary (stellar subdivision, which keeps every manifold one).
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

struct Insertion {
  std::vector<Index> inserted;
  /// Too far from all simplices of their neighbors, or outside of all that fill space.
  std::vector<Index> outliers;
};

/// Samples farther than max_distance times the local scale, theirs and that of the nearest
/// simplex, from the simplices around their neighbors stay outside: a stray sample has a
/// large scale of its own. Of all faces of the simplices nearest to a sample, the
/// one whose subdivision has the least energy is taken; where simplices fill their space,
/// K = D, of those after which they still lie side by side. Rows of the result are sorted.
/// \param kept_out  samples that stay outside, ascending
Insertion insert_vertices(const Samples& samples, const Neighborhoods& neighborhoods,
                          const std::vector<double>& scales, double max_distance,
                          const std::vector<Index>& kept_out, SimplexArray& simplices,
                          const Execution& execution = {});

}  // namespace remanifold
