// SPDX-License-Identifier: GPL-3.0-or-later
// Convex hulls of points around the origin of R^K, grown one point at a time: one a sample.
// A sign comes from rounded numbers where a bound on their error makes it certain, and from
// CGAL's exact predicates where not, so that the hull is that of the points as given.
//
// A hull starts as a tiny simplex around the origin, whose vertices have the ids
// -1 .. -(K+1). It stands for the origin: a facet with a negative id is a direction in
// which the dual region has no end. The origin alone would leave it to rounding whether
// points on a common ray, as all rows of a grid are, count as extreme.
#pragma once

#include "remanifold/types.hpp"

namespace remanifold::detail {

/// Coordinate `axis` of vertex `which` (0 .. K) of the simplex at the start: the unit
/// vectors and minus their sum.
constexpr double start_coordinate(int dim, int which, int axis) {
  return which == dim ? -1.0 : which == axis ? 1.0 : 0.0;
}
constexpr bool is_start(Index id) { return id < 0; }
constexpr Index start_id(int which) { return -1 - which; }
constexpr int start_vertex(Index id) { return -1 - id; }

/// Sign of the determinant of points 1 .. K minus point 0, exact. K is 2 or more.
int exact_orientation(int dim, const double* const* points);

}  // namespace remanifold::detail
