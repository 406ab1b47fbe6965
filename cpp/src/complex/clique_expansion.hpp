// SPDX-License-Identifier: GPL-3.0-or-later
// All cliques of a graph that begin at one vertex.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

namespace remanifold::detail {

/// Extends a clique by the common neighbors that follow its last vertex.
class CliqueExpansion {
 public:
  CliqueExpansion(const Csr& graph, int arity, const Execution& execution)
      : graph_(graph),
        arity_(arity),
        execution_(execution),
        clique_(arity),
        candidates_(arity) {}

  /// Stops when there are more than max_size vertices in `out`.
  void expand_from(Index vertex, std::vector<Index>& out,
                   std::size_t max_size = std::numeric_limits<std::size_t>::max()) {
    max_size_ = max_size;
    clique_[0] = vertex;
    const Index* end = graph_.end(vertex);
    candidates_[0].assign(std::upper_bound(graph_.begin(vertex), end, vertex), end);
    extend(1, out);
  }

 private:
  void extend(int size, std::vector<Index>& out) {
    execution_.poll();
    const std::vector<Index>& candidates = candidates_[size - 1];
    if (static_cast<int>(candidates.size()) < arity_ - size) {
      return;
    }
    for (std::size_t i = 0; i < candidates.size() && out.size() <= max_size_; ++i) {
      clique_[size] = candidates[i];
      if (size + 1 == arity_) {
        out.insert(out.end(), clique_.begin(), clique_.end());
        continue;
      }
      std::vector<Index>& next = candidates_[size];
      next.clear();
      std::set_intersection(candidates.begin() + static_cast<Offset>(i) + 1,
                            candidates.end(), graph_.begin(candidates[i]),
                            graph_.end(candidates[i]), std::back_inserter(next));
      extend(size + 1, out);
    }
  }

  const Csr& graph_;
  int arity_;
  std::size_t max_size_ = 0;
  const Execution& execution_;
  std::vector<Index> clique_;
  std::vector<std::vector<Index>>
      candidates_;  // [size - 1]: may follow the first `size`
};

}  // namespace remanifold::detail
