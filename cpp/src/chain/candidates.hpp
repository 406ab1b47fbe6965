// SPDX-License-Identifier: GPL-3.0-or-later
// Simplices beyond those of the stars that may fill a cavity.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold::detail {

/// Edges (pairs) of the simplices that have both ends among the marked samples.
void append_edges(const SimplexArray& simplices,
                  const std::vector<std::uint8_t>& marked, std::vector<Index>& pairs);

/// Edges between marked samples, one of which is among the nearest `count` of the other.
void append_neighbor_edges(const Neighborhoods& neighborhoods, Index count,
                           const std::vector<Index>& vertices,
                           const std::vector<std::uint8_t>& marked,
                           std::vector<Index>& pairs);

/// All K-simplices whose edges are among the pairs; none where there are more than
/// max_count.
SimplexArray cliques_of(const std::vector<Index>& pairs, int dim, std::size_t max_count,
                        const Execution& execution);

/// K-faces of the Delaunay triangulation of some samples, D <= 3. Points only.
/// \param elsewhere  coordinates of samples of the whole that are not here: faces among them
///                   are left out
SimplexArray delaunay_faces(const Samples& samples, const std::vector<Index>& vertices,
                            const std::vector<double>& elsewhere, int dim);

}  // namespace remanifold::detail
