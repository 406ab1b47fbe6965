// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "remanifold/types.hpp"

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace remanifold::detail {

/// Disjoint sets of nodes, each with a sign relative to the others of its set.
class SignedSets {
 public:
  explicit SignedSets(Offset size) : parent_(size), sign_(size, 1), count_(size, 1) {
    std::iota(parent_.begin(), parent_.end(), Offset{0});
  }

  /// Demands sign(a) * sign(b) = product.
  /// \returns false where that contradicts what was demanded before
  bool join(Offset a, Offset b, int product) {
    auto [root_a, sign_a] = find(a);
    auto [root_b, sign_b] = find(b);
    if (root_a == root_b) {
      return sign_a * sign_b == product;
    }
    if (count_[root_a] < count_[root_b]) {
      std::swap(root_a, root_b);
    }
    parent_[root_b] = root_a;
    sign_[root_b] = static_cast<std::int8_t>(sign_a * sign_b * product);
    count_[root_a] += count_[root_b];
    return true;
  }

  /// The root, and the sign of the node relative to it.
  std::pair<Offset, int> find(Offset node) const {
    int sign = 1;
    while (parent_[node] != node) {
      sign *= sign_[node];
      node = parent_[node];
    }
    return {node, sign};
  }

 private:
  std::vector<Offset> parent_;
  std::vector<std::int8_t> sign_;  // relative to the parent
  std::vector<Offset> count_;
};

}  // namespace remanifold::detail
