// SPDX-License-Identifier: GPL-3.0-or-later
// Signs that make the rims of one cavity agree where its fixed simplices do not tell:
// groups of rims whose orientation to each other is open are joined by the cheapest way
// through the candidates between them, which is where a filling of least energy is
// likeliest to run. One walk, as many steps as there are candidates and facets.
#pragma once

#include "chain/rim_orientation.hpp"
#include "remanifold/cavities.hpp"

#include <cstdint>
#include <vector>

namespace remanifold::detail {

/// \param rims  of the facets of the cavity that have a rim, in order
/// \returns the sign of the fixed simplex at each facet of the cavity; 0 where there is
///          none
std::vector<std::int8_t> relative_signs(const Cavities& cavities, Index cavity,
                                        const RimOrientation::Signs& rims);

}  // namespace remanifold::detail
