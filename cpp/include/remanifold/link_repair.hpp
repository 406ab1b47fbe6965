// SPDX-License-Identifier: GPL-3.0-or-later
// Vertices whose link is neither a sphere nor a ball. Facets may all be in order there:
// two sheets may share a vertex, or two parts of a boundary an edge.
#pragma once

#include "remanifold/cavities.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

/// Simplices of links that are judged at most for each simplex of the complex. Surfaces and
/// solids need a few, four-manifolds that are mended in the end up to five hundred.
inline constexpr Offset kLinkWorkPerSimplex = 1000;

/// Up to K = 4, mends links one move after the other, as long as there are fewer bad ones
/// after it:
/// - one of several fans of simplices around a face is taken out and the hole filled
///   without the face,
/// - a simplex at the boundary is taken out, or put in between two open facets.
/// Small holes that a move leaves are closed again where that costs less than the price of
/// their facets. Rows of the result are sorted.
/// Where no move helps, or the work is at its end, all but the largest fan at the vertex are
/// taken out.
/// \param marked  vertices to look at
/// \returns the vertices at which simplices were taken out for good, ascending
std::vector<Index> repair_links(const Samples& samples,
                                const std::vector<double>& scales,
                                const std::vector<std::uint8_t>& marked,
                                const FacetPrice& price, SimplexArray& simplices,
                                const Execution& execution = {},
                                Offset work_per_simplex = kLinkWorkPerSimplex);

/// The last of that alone: takes out all but the largest fan whose link is a sphere or ball
/// at each marked vertex, and at those next to it that are no better after it. Up to K = 4.
/// \returns the vertices at which simplices were taken out, ascending
std::vector<Index> cut_links(const Samples& samples,
                             const std::vector<std::uint8_t>& marked,
                             SimplexArray& simplices, const Execution& execution = {});

/// From K = 2 to 4, takes out vertices at which the simplices stand up as a spike: they are
/// more than twice as large as what closes the hole, and no vertex around is nearer than
/// its local scale. Only where that leaves links proper, the steepest first. Among clutter
/// such vertices are strays that lie near the manifold.
/// \returns these vertices, ascending
std::vector<Index> level_spikes(const Samples& samples,
                                const std::vector<double>& scales,
                                SimplexArray& simplices,
                                const Execution& execution = {});

}  // namespace remanifold
