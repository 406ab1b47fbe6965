// SPDX-License-Identifier: GPL-3.0-or-later
#include "detail/simplex_rows.hpp"

#include <algorithm>
#include <numeric>

namespace remanifold::detail {

SimplexArray sorted_unique(const SimplexArray& simplices) {
  const int arity = simplices.arity;
  std::vector<Offset> order(simplices.size());
  std::iota(order.begin(), order.end(), Offset{0});
  std::sort(order.begin(), order.end(), [&](Offset a, Offset b) {
    return std::lexicographical_compare(simplices[a], simplices[a] + arity,
                                        simplices[b], simplices[b] + arity);
  });
  SimplexArray result{arity, {}};
  result.vertices.reserve(simplices.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Index* row = simplices[order[i]];
    if (i == 0 || !std::equal(row, row + arity, simplices[order[i - 1]])) {
      append_row(result, row);
    }
  }
  return result;
}

void erase_rows(SimplexArray& simplices, const std::vector<std::uint8_t>& marked) {
  Offset kept = 0;
  for (Offset s = 0; s < simplices.size(); ++s) {
    if (marked[s] == 0) {
      std::copy_n(simplices[s], simplices.arity,
                  simplices.vertices.begin() + kept * simplices.arity);
      ++kept;
    }
  }
  simplices.vertices.resize(kept * simplices.arity);
}

Offset find_row(const SimplexArray& sorted, const Index* simplex) {
  const int arity = sorted.arity;
  Offset low = 0;
  Offset high = sorted.size();
  while (low < high) {
    const Offset middle = (low + high) / 2;
    if (std::lexicographical_compare(sorted[middle], sorted[middle] + arity, simplex,
                                     simplex + arity)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low < sorted.size() && std::equal(simplex, simplex + arity, sorted[low])
             ? low
             : Offset{-1};
}

}  // namespace remanifold::detail
