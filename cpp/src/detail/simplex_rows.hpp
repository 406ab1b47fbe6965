// SPDX-License-Identifier: GPL-3.0-or-later
// Sorting and selecting the rows of simplex arrays.
#pragma once

#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold::detail {

/// Rows in lexicographic order, each once.
SimplexArray sorted_unique(const SimplexArray& simplices);

/// Removes the rows that are marked.
void erase_rows(SimplexArray& simplices, const std::vector<std::uint8_t>& marked);

/// Position of the row in an array that is sorted, or -1.
Offset find_row(const SimplexArray& sorted, const Index* simplex);

inline void append_row(SimplexArray& simplices, const Index* simplex) {
  simplices.vertices.insert(simplices.vertices.end(), simplex,
                            simplex + simplices.arity);
}

}  // namespace remanifold::detail
