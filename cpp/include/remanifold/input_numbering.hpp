// SPDX-License-Identifier: GPL-3.0-or-later
// Results of the steps in the caller's numbering of the samples. Of samples that were
// merged the first one carries edge set and star, rows of the others are empty; tangent
// spaces are repeated for each.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/tangent_space.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

/// Bases are NaN on the boundary. Coefficients, which refer to neighbors, are left out.
TangentSpaces to_input(const Samples& samples, const TangentSpaces& tangents,
                       const Execution& execution = {});

/// Rows ascend.
Csr edge_sets_to_input(const Samples& samples, const LocalRegions& regions,
                       const Execution& execution = {});

/// Per sample K + 1 vertices a simplex: the sample itself, then the others ascending; the
/// simplices of a star are sorted. Offsets count simplices.
Csr stars_to_input(const Samples& samples, const LocalRegions& regions,
                   const Execution& execution = {});

/// Samples by canonical numbers to input numbers, ascending.
std::vector<Index> to_input(const Samples& samples, std::vector<Index> vertices);

/// Flags of input samples to canonical ones: set where one of the merged samples has it.
std::vector<std::uint8_t> flags_to_canonical(const Samples& samples,
                                             const std::vector<std::uint8_t>& flags);

/// Simplices of input numbers to canonical ones, columns ascending, rows in their order.
SimplexArray to_canonical(const Samples& samples, SimplexArray simplices,
                          const Execution& execution = {});

/// Simplices of canonical numbers, columns ascending, to input numbers: columns ascending
/// but for the last two, which change places where that gives the simplex its sign.
/// Without signs all columns ascend. Rows in lexicographic order of ascending columns.
SimplexArray to_input(const Samples& samples, SimplexArray simplices,
                      const std::vector<std::int8_t>& signs,
                      const Execution& execution = {});

}  // namespace remanifold
