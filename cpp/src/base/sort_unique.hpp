// SPDX-License-Identifier: GPL-3.0-or-later
// A vector sorted, with each value once.
#pragma once

#include <algorithm>
#include <vector>

namespace remanifold::detail {

/// Sorts, and leaves each value once.
template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace remanifold::detail
