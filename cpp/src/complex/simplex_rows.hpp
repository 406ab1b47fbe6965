// SPDX-License-Identifier: GPL-3.0-or-later
// Sorting and selecting the rows of simplex arrays.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

namespace remanifold::detail {

/// Below one row for so many vertices, rows are sorted by comparing them: a few out of a
/// large complex must not cost a look at all of its vertices.
constexpr Offset kSparse = 8;

/// Rows in lexicographic order, each once.
SimplexArray sorted_unique(const SimplexArray& simplices,
                           const Execution& execution = {});

/// The order in which rows ascend, equal ones by position.
std::vector<Offset> row_order(const SimplexArray& simplices,
                              const Execution& execution = {});

/// The rows of an array by the vertex in one column; rows in that order are not copied.
class Buckets {
 public:
  Buckets(const SimplexArray& simplices, int column, Index num_vertices,
          const Execution& execution);

  Offset begin(Offset v) const { return starts_[v]; }
  Offset end(Offset v) const { return starts_[v + 1]; }
  Offset row(Offset i) const { return rows_.empty() ? i : rows_[i]; }

  /// Moves out the numbers of all rows; `row` is of no use afterwards.
  std::vector<Offset> take_rows();

 private:
  std::vector<Offset> starts_;
  std::vector<Offset> rows_;
};

inline bool row_less(const Index* a, const Index* b, int arity) {
  for (int i = 0; i < arity; ++i) {
    if (a[i] != b[i]) {
      return a[i] < b[i];
    }
  }
  return false;
}

inline bool row_equal(const Index* a, const Index* b, int arity) {
  for (int i = 0; i < arity; ++i) {
    if (a[i] != b[i]) {
      return false;
    }
  }
  return true;
}

/// Numbers of the rows of which at least `least` vertices are marked.
std::vector<Offset> rows_near(const SimplexArray& simplices,
                              const std::vector<std::uint8_t>& marked, int least,
                              const Execution& execution = {});

/// These rows.
SimplexArray select_rows(const SimplexArray& simplices,
                         const std::vector<Offset>& rows);

/// Removes the rows that are marked.
void erase_rows(SimplexArray& simplices, const std::vector<std::uint8_t>& marked);

/// Position of the row in an array that is sorted, or -1.
Offset find_row(const SimplexArray& sorted, const Index* simplex);

/// Sorts by insertion while there is little to sort, as in the star of a sample.
template <class Iterator, class Less>
void sort_few(Iterator first, Iterator last, const Less& less) {
  constexpr auto few = 24;
  if (last - first > few) {
    std::sort(first, last, less);
    return;
  }
  for (Iterator i = first; i != last; ++i) {
    const auto value = *i;
    Iterator j = i;
    for (; j != first && less(value, *(j - 1)); --j) {
      *j = *(j - 1);
    }
    *j = value;
  }
}

/// Sorts each row, and points at the rows in their order.
inline void sort_rows(std::vector<Index>& rows, int arity,
                      std::vector<const Index*>& order) {
  order.clear();
  for (auto row = rows.begin(); row != rows.end(); row += arity) {
    sort_few(row, row + arity, std::less<>());
    order.push_back(&*row);
  }
  sort_few(order.begin(), order.end(),
           [&](const Index* a, const Index* b) { return row_less(a, b, arity); });
}

inline void append_row(SimplexArray& simplices, const Index* simplex) {
  simplices.vertices.insert(simplices.vertices.end(), simplex,
                            simplex + simplices.arity);
}

}  // namespace remanifold::detail
