// SPDX-License-Identifier: GPL-3.0-or-later
// Intrinsic Delaunay triangulation of a surface of triangles, by flips of its edges.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

/// Triangles on the same surface with the same vertices. Its edges are straight along the
/// surface, and may join a vertex with itself, or two vertices more than once.
struct IntrinsicTriangulation {
  SimplexArray triangles{3, {}};
  std::vector<double> lengths;  ///< of the edges opposite to the vertices, M x 3
  Offset num_flips = 0;
  bool complete = true;  ///< no edge is left to be flipped
};

/// Edges are flipped while the angles opposite to one add up to more than pi, which ends
/// with non-negative cotangent weights (Fisher, Springborn, Schroeder and Bobenko, An
/// algorithm for the construction of intrinsic Delaunay triangulations with applications to
/// digital geometry processing, Computing 81, 2007). The surface may be known by lengths
/// alone, have a boundary and be not orientable. Edges of more than two triangles stay, and
/// so do the sides of triangles whose lengths are those of none.
///
/// An edge of one triangle stays as well, and its weight is negative where the angle opposite
/// to it is obtuse. With both_sides the surface is taken twice, and the sides are sewn
/// together along the edges of one triangle, and in a circle at those of three and more: then
/// every edge has two triangles and no weight is negative, if each triangle counts half
/// (Sharp and Crane, A Laplacian for nonmanifold triangle meshes, Computer Graphics Forum
/// 39(5), 2020).
///
/// No more than a hundred flips a triangle; some tenths are usual. Memory O(M).
/// \param triangles   of any orientation
/// \param lengths     of the edges opposite to the vertices of each triangle, in its order
/// \param both_sides  the result has 2 M triangles
/// \throws std::invalid_argument  other simplices than triangles, or not three lengths each
IntrinsicTriangulation intrinsic_delaunay(const SimplexArray& triangles,
                                          const std::vector<double>& lengths,
                                          bool both_sides = false,
                                          const Execution& execution = {});

}  // namespace remanifold
