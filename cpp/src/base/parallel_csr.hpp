// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of different lengths made by counting, as in csr.hpp, by several threads: each has a
// range of the rows and goes through all values, passing over those of the others. Reading
// in order costs little beside counting and placing all over memory, and no value changes
// its place for it.
#pragma once

#include "base/csr.hpp"
#include "base/parallel.hpp"

#include <algorithm>

namespace remanifold::detail {

/// \param fill  called with the first row of a range and the first beyond it
template <class Fill>
void for_each_range(Offset rows, const Execution& execution, const Fill& fill) {
  constexpr Offset most = 16;     // times that all values are gone through
  constexpr Offset least = 4096;  // rows that are worth it
  const Offset ranges = std::clamp<Offset>(
      rows / least, 1, std::min<Offset>(most, num_threads(execution)));
  for_each_block_uncounted(ranges, 1, execution, [&](Offset range, Offset) {
    fill(rows * range / ranges, rows * (range + 1) / ranges);
  });
}

/// What ragged_of() makes.
/// \param each  is asked by several threads at once
template <class Value, class Each>
Ragged<Value> ragged_of(Offset rows, const Execution& execution, const Each& each) {
  Ragged<Value> result;
  result.offsets.assign(static_cast<std::size_t>(rows) + 1, 0);
  for_each_range(rows, execution, [&](Offset begin, Offset end) {
    each([&](Offset row, const Value&) {
      if (row >= begin && row < end) {
        ++result.offsets[row + 1];
      }
    });
  });
  std::partial_sum(result.offsets.begin(), result.offsets.end(),
                   result.offsets.begin());
  result.values.resize(result.offsets.back());
  for_each_range(rows, execution, [&](Offset begin, Offset end) {
    std::vector<Offset> next(result.offsets.begin() + begin,
                             result.offsets.begin() + end);
    each([&](Offset row, const Value& value) {
      if (row >= begin && row < end) {
        result.values[next[row - begin]++] = value;
      }
    });
  });
  return result;
}

}  // namespace remanifold::detail
