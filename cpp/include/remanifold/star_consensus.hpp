// SPDX-License-Identifier: GPL-3.0-or-later
// What the stars of all samples say together: each of their simplices once, with the
// number of its vertices whose star has it. One that is in the stars of all its K+1
// vertices is agreed on; facets of agreed simplices have at most two agreed cofaces.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

struct StarSimplices {
  SimplexArray simplices;           ///< columns ascending, each simplex once
  std::vector<std::uint8_t> votes;  ///< 1 .. K+1

  bool agreed(Offset s) const { return votes[s] == simplices.arity; }
};

StarSimplices count_votes(const LocalRegions& regions, const Execution& execution = {});

}  // namespace remanifold
