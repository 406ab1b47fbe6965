// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of numbers that are joined and never split (union-find).
#pragma once

#include "remanifold/types.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace remanifold::detail {

class DisjointSets {
 public:
  explicit DisjointSets(Offset size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), Offset{0});
  }
  Offset find(Offset i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  /// The lower root stays.
  void join(Offset a, Offset b) {
    a = find(a);
    b = find(b);
    if (a != b) {
      parent_[std::max(a, b)] = std::min(a, b);
    }
  }

 private:
  std::vector<Offset> parent_;
};

}  // namespace remanifold::detail
