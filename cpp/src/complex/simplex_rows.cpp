// SPDX-License-Identifier: GPL-3.0-or-later
#include "complex/simplex_rows.hpp"

#include "base/parallel.hpp"
#include "base/parallel_csr.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

namespace remanifold::detail {

namespace {

constexpr Offset kBlock = 4096;

}  // namespace

Buckets::Buckets(const SimplexArray& simplices, int column, Index num_vertices,
                 const Execution& execution) {
  std::atomic<bool> sorted{true};
  for_each_block_uncounted(simplices.size(), kBlock, execution,
                           [&](Offset begin, Offset end) {
                             for (Offset s = std::max<Offset>(begin, 1); s < end; ++s) {
                               if (simplices[s][column] < simplices[s - 1][column]) {
                                 sorted = false;
                                 return;
                               }
                             }
                           });
  starts_.assign(static_cast<std::size_t>(num_vertices) + 1, 0);
  if (sorted) {
    for_each_block_uncounted(
        simplices.size(), kBlock, execution, [&](Offset begin, Offset end) {
          for (Offset s = begin; s < end; ++s) {
            const Index v = simplices[s][column];
            const bool last =
                s + 1 == simplices.size() || simplices[s + 1][column] != v;
            if (last) {
              starts_[v + 1] = s + 1;
            }
          }
        });
    for (Index v = 0; v < num_vertices; ++v) {
      starts_[v + 1] = std::max(starts_[v], starts_[v + 1]);
    }
    return;
  }
  Ragged<Offset> rows =
      ragged_of<Offset>(num_vertices, execution, [&](const auto& add) {
        for (Offset s = 0; s < simplices.size(); ++s) {
          add(simplices[s][column], s);
        }
      });
  starts_ = std::move(rows.offsets);
  rows_ = std::move(rows.values);
}

std::vector<Offset> Buckets::take_rows() {
  if (rows_.empty()) {
    rows_.resize(starts_.back());
    std::iota(rows_.begin(), rows_.end(), Offset{0});
  }
  return std::move(rows_);
}

std::vector<Offset> row_order(const SimplexArray& simplices,
                              const Execution& execution) {
  const int arity = simplices.arity;
  const Offset count = simplices.size();
  Index last = 0;
  for (Offset s = 0; s < count; ++s) {
    last = std::max(last, *simplices[s]);
  }
  if (count < last / kSparse) {
    std::vector<Offset> order(count);
    std::iota(order.begin(), order.end(), Offset{0});
    std::stable_sort(order.begin(), order.end(), [&](Offset a, Offset b) {
      return row_less(simplices[a], simplices[b], arity);
    });
    return order;
  }
  const auto less = [&](Offset a, Offset b) {
    return row_less(simplices[a] + 1, simplices[b] + 1, arity - 1);
  };
  // Buckets by the first column, then each on its own.
  Buckets buckets(simplices, 0, last + 1, execution);
  std::vector<Offset> order = buckets.take_rows();
  for_each_block_uncounted(last + 1, kBlock, execution, [&](Offset begin, Offset end) {
    for (Offset v = begin; v < end; ++v) {
      sort_few(
          order.begin() + buckets.begin(v), order.begin() + buckets.end(v),
          [&](Offset a, Offset b) { return less(a, b) || (a < b && !less(b, a)); });
    }
  });
  return order;
}

SimplexArray sorted_unique(const SimplexArray& simplices, const Execution& execution) {
  const int arity = simplices.arity;
  const std::vector<Offset> order = row_order(simplices, execution);
  const auto count = static_cast<Offset>(order.size());
  // How many rows of a block are not like those before them, then where these go.
  std::vector<Offset> starts(
      static_cast<std::size_t>((count + kBlock - 1) / kBlock) + 1, 0);
  const auto is_new = [&](Offset i) {
    return i == 0 || !row_equal(simplices[order[i]], simplices[order[i - 1]], arity);
  };
  for_each_block_uncounted(count, kBlock, execution, [&](Offset begin, Offset end) {
    Offset kept = 0;
    for (Offset i = begin; i < end; ++i) {
      kept += is_new(i) ? 1 : 0;
    }
    starts[begin / kBlock + 1] = kept;
  });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  SimplexArray result{arity, {}};
  result.vertices.resize(static_cast<std::size_t>(starts.back()) * arity);
  for_each_block_uncounted(count, kBlock, execution, [&](Offset begin, Offset end) {
    Index* to = result.vertices.data() + starts[begin / kBlock] * arity;
    for (Offset i = begin; i < end; ++i) {
      if (is_new(i)) {
        to = std::copy_n(simplices[order[i]], arity, to);
      }
    }
  });
  return result;
}

std::vector<Offset> rows_near(const SimplexArray& simplices,
                              const std::vector<std::uint8_t>& marked, int least,
                              const Execution& execution) {
  const int arity = simplices.arity;
  std::vector<std::vector<Offset>> blocks((simplices.size() + kBlock - 1) / kBlock);
  for_each_block_uncounted(simplices.size(), kBlock, execution,
                           [&](Offset begin, Offset end) {
                             for (Offset s = begin; s < end; ++s) {
                               int count = 0;
                               for (int i = 0; i < arity; ++i) {
                                 count += marked[simplices[s][i]] != 0 ? 1 : 0;
                               }
                               if (count >= least) {
                                 blocks[begin / kBlock].push_back(s);
                               }
                             }
                           });
  std::vector<Offset> rows;
  for (const std::vector<Offset>& block : blocks) {
    rows.insert(rows.end(), block.begin(), block.end());
  }
  return rows;
}

SimplexArray select_rows(const SimplexArray& simplices,
                         const std::vector<Offset>& rows) {
  SimplexArray result{simplices.arity, {}};
  result.vertices.reserve(rows.size() * simplices.arity);
  for (const Offset s : rows) {
    append_row(result, simplices[s]);
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
    if (row_less(sorted[middle], simplex, arity)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low < sorted.size() && row_equal(simplex, sorted[low], arity) ? low
                                                                       : Offset{-1};
}

}  // namespace remanifold::detail
