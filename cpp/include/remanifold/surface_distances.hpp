// SPDX-License-Identifier: GPL-3.0-or-later
// Exact distances along the triangles of a surface, from the lengths of their edges.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

/// Windows, the parts of edges that straight lines from a vertex reach through the same
/// triangles, are carried from triangle to triangle, the nearest first (Chen and Han,
/// Shortest paths on a polyhedron, 1990; Xin and Wang, Improving Chen and Han's algorithm
/// on the discrete geodesic problem, 2009). At a corner of a triangle only the window that
/// brings the shortest way to it goes on to both sides. The surface may be known by
/// lengths alone, have a boundary and be not orientable; no edge may have more than two
/// triangles.
/// \param triangles  of any orientation
/// \param lengths    of the edges opposite to the vertices of each triangle, in its order
/// \returns row by row the distances of all vertices from each source, infinite where no
///          path leads
std::vector<double> surface_distances(const SimplexArray& triangles,
                                      const std::vector<double>& lengths,
                                      Index num_vertices,
                                      const std::vector<Index>& sources,
                                      const Execution& execution = {});

}  // namespace remanifold
