// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of different lengths in one array, made by counting: O(values), and the values of a
// row keep the order in which they came.
#pragma once

#include "remanifold/types.hpp"

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace remanifold::detail {

/// Row i is values[offsets[i] .. offsets[i + 1]).
template <class Value>
struct Ragged {
  std::vector<Offset> offsets{0};
  std::vector<Value> values;

  Offset rows() const { return static_cast<Offset>(offsets.size()) - 1; }
  const Value* begin(Offset i) const { return values.data() + offsets[i]; }
  const Value* end(Offset i) const { return values.data() + offsets[i + 1]; }
  Offset size(Offset i) const { return offsets[i + 1] - offsets[i]; }
};

/// \param each  calls what it is given with (row, value) for every value; it is asked twice
///              and has to say the same
template <class Value, class Each>
Ragged<Value> ragged_of(Offset rows, const Each& each) {
  Ragged<Value> result;
  result.offsets.assign(static_cast<std::size_t>(rows) + 1, 0);
  each([&](Offset row, const Value&) { ++result.offsets[row + 1]; });
  std::partial_sum(result.offsets.begin(), result.offsets.end(),
                   result.offsets.begin());
  result.values.resize(result.offsets.back());
  std::vector<Offset> next(result.offsets.begin(), result.offsets.end() - 1);
  each([&](Offset row, const Value& value) { result.values[next[row]++] = value; });
  return result;
}

template <class Each>
Csr csr_of(Offset rows, const Each& each) {
  Ragged<Index> result = ragged_of<Index>(rows, each);
  return {std::move(result.offsets), std::move(result.values)};
}

}  // namespace remanifold::detail
