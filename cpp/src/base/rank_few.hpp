// SPDX-License-Identifier: GPL-3.0-or-later
// The ranks of few keys, by counting those that are less: in the widest vectors that the
// machine has, and without a branch that nobody can predict.
#pragma once

#include "remanifold/types.hpp"

#include <cstdint>

namespace remanifold::detail {

/// Numbers of keys are divisible by this; infinity fills them up.
constexpr Index kRankedTogether = 8;

/// \param ranks  for each key, how many are less
void rank_few(const float* keys, Index count, std::int32_t* ranks);

}  // namespace remanifold::detail
