// SPDX-License-Identifier: GPL-3.0-or-later
// Results of unknown length, block by block: blocks are worked on in waves and joined after
// each, so that what is not joined yet is little beside the result.
#pragma once

#include "base/parallel.hpp"
#include "remanifold/types.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace remanifold::detail {

/// Blocks that are worked on side by side before what they found is joined: enough for each
/// thread that the last of them are not waited for long.
inline Offset blocks_of_wave(const Execution& execution) {
  constexpr Offset of_thread = 16;
  constexpr Offset most = 128;
  return std::min(most, of_thread * num_threads(execution));
}

/// Moves some values behind all others; keeps the room of both.
template <class T>
void append(std::vector<T>& all, std::vector<T>& some) {
  all.insert(all.end(), some.begin(), some.end());
  some.clear();
}

/// Where the first `done` of `count` rows have filled the vector so far.
template <class T>
void reserve_for(std::vector<T>& values, Offset done, Offset count) {
  constexpr double kMore = 1.1;  // memory that is not used is never touched
  if (done < count) {
    values.reserve(static_cast<std::size_t>(kMore * static_cast<double>(values.size()) *
                                            static_cast<double>(count) /
                                            static_cast<double>(done)));
  }
}

}  // namespace remanifold::detail
