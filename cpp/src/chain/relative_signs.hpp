// SPDX-License-Identifier: GPL-3.0-or-later
// Signs that make the rims of a cavity, or of a part of one, agree where its fixed
// simplices do not tell: groups of rims whose orientation to each other is open are joined
// by the cheapest way through the candidates between them, which is where a filling of
// least energy is likeliest to run. One walk, as many steps as there are candidates and
// facets.
#pragma once

#include "chain/cavity_part.hpp"
#include "chain/rim_orientation.hpp"

#include <cstdint>
#include <vector>

namespace remanifold::detail {

/// \param rims  of the facets that have a rim, in order
/// \returns the sign of the simplex that is at each facet of the part; 0 where none is
std::vector<std::int8_t> relative_signs(const CavityPart& part,
                                        const RimOrientation::Signs& rims);

/// Whether some candidates of the part can be oriented such that what meets at a facet
/// cancels there.
/// \param signs  of the simplex that is at each facet
/// \param chosen  no more than two simplices on a facet, with what is there already
bool has_orientation(const CavityPart& part, const std::vector<std::int8_t>& signs,
                     const std::vector<Index>& chosen);

}  // namespace remanifold::detail
