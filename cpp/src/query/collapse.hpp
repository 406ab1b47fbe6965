// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a complex collapses to a point: proof that a combinatorial manifold is a ball
// (J. H. C. Whitehead, Simplicial spaces, nuclei and m-groups, 1939), and with one simplex
// taken out a sphere.
#pragma once

#include "remanifold/types.hpp"

namespace remanifold::detail {

/// Greedily, in a few orders: false says nothing. Linear in the faces of all dimensions.
/// \param closed  whether every facet has two cofaces: the first simplex is taken out
/// \returns false, too, where there are more vertices than it is made for
bool collapses_to_point(const SimplexArray& simplices, bool closed);

}  // namespace remanifold::detail
