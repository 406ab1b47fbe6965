// SPDX-License-Identifier: GPL-3.0-or-later
// What is done with each of the samples of a ball to find those nearest to one of them, in
// the widest vectors that the machine has. No sum depends on these.
#pragma once

#include "remanifold/types.hpp"

namespace remanifold::detail {

/// Room that pick_near() takes beyond what it finds.
constexpr Index kPickSlack = 4;

/// sums[i] += the square of position - axis[i].
void add_squared_differences(double position, const double* axis, Index count,
                             double* sums);

/// The places of values no larger than the limit, ascending.
/// \param places  of size count + kPickSlack
/// \returns how many there are
Index pick_near(const double* values, Index count, double limit, Index* places);

}  // namespace remanifold::detail
