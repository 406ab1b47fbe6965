// SPDX-License-Identifier: GPL-3.0-or-later
// The same manifold with fewer vertices: edges are collapsed, the cheapest first, where
// that changes nothing but the geometry.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace remanifold {

enum Fixed : std::uint8_t { kMovable, kStays, kUntouched };

struct SimplificationOptions {
  Index num_vertices = 0;  ///< stop when no more are left
  /// No vertex that is taken out may come to lie farther from the result.
  double max_error = std::numeric_limits<double>::infinity();
  bool even = false;  ///< where the longest new edge is shortest, not the error least
};

struct Simplification {
  /// In the order of those they come from, oriented as they were.
  SimplexArray simplices;
  /// Of each vertex: how far it lies from the result, at most. Zero for those that are
  /// left.
  std::vector<double> errors;
};

/// One end of an edge is moved to the other (half-edge collapse), so that the vertices that
/// are left stay where they are. An edge is collapsed where
/// - what its ends' links have in common is the link of the edge, the boundary being closed
///   by a cone: of a combinatorial manifold of any dimension, with boundary or without, it
///   leaves one that is homeomorphic (Dey, Edelsbrunner, Guha, Nekhayev, Topology
///   preserving edge contraction, 1999; Nevo, Higher minors and Van Kampen's obstruction,
///   2007),
/// - a vertex of the boundary moves along the boundary,
/// - no simplex turns far, and none becomes flatter than the flattest around,
/// - the vertices taken out so far stay near what takes the place of the star.
/// O(n log n) for n simplices of bounded stars.
/// \param fixed  of each vertex: kMovable, kStays, or kUntouched where the complex is no
///               manifold and nothing may be moved there either
Simplification simplify(MatrixView vertices, const SimplexArray& simplices,
                        const std::vector<std::uint8_t>& fixed,
                        const SimplificationOptions& options,
                        const Execution& execution = {});

}  // namespace remanifold
