// SPDX-License-Identifier: GPL-3.0-or-later
// What is done with each of the samples of a ball to find those nearest to one of them, in
// the widest vectors that the machine has. No sum is another for it.
#pragma once

#include "remanifold/types.hpp"

namespace remanifold::detail {

/// Room that pick_near() takes beyond what it finds.
constexpr Index kPickSlack = 4;

/// Squared distances of points to one, summed axis by axis.
/// \param axes    coordinates, those of an axis next to each other
/// \param stride  from one axis to the next, divisible by four and no less than the count
/// \param sums    of the size of the stride
void squared_distances(const double* p, const double* axes, Index stride, int dim,
                       Index count, double* sums);

/// The places of values no larger than the limit, ascending.
/// \param places  of size count + kPickSlack
/// \returns how many there are
Index pick_near(const double* values, Index count, double limit, Index* places);

}  // namespace remanifold::detail
