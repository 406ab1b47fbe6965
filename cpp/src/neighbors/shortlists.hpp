// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest neighbors of all samples from the products of all with all. The products are
// rounded, in single precision where that resolves the distances, so they only tell which
// samples may be among the nearest: exact distances of few decide.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold::detail {

/// For each sample those that may be among its `count` nearest, ascending: at least these,
/// whatever the machine.
Csr make_shortlists(const Samples& samples, Index count, const Execution& execution);

/// The squared distance of each sample to each on its list, the same bits as
/// detail::squared_distance().
std::vector<double> measure_shortlists(const Samples& samples, const Csr& lists,
                                       const Execution& execution);

}  // namespace remanifold::detail
