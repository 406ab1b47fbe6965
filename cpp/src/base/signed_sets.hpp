// SPDX-License-Identifier: GPL-3.0-or-later
// Sets that are joined and never split, with a sign between any two of their members:
// what orients simplices alike, or says that it cannot be done.
#pragma once

#include "remanifold/types.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace remanifold::detail {

/// Disjoint sets of nodes, each with a sign relative to the others of its set.
/// \tparam Number  that counts the nodes
template <class Number>
class SignedSets {
 public:
  explicit SignedSets(Offset size) : parent_(size), sign_(size, 1) {
    std::iota(parent_.begin(), parent_.end(), Number{0});
  }

  /// Demands sign(a) * sign(b) = product. The lower root stays; touches what lies between
  /// the roots and the two only.
  /// \returns false where that contradicts what was demanded before
  bool join(Offset a, Offset b, int product) {
    const auto [root_a, sign_a] = find(a);
    const auto [root_b, sign_b] = find(b);
    if (root_a == root_b) {
      return sign_a * sign_b == product;
    }
    const Offset child = std::max(root_a, root_b);
    parent_[child] = static_cast<Number>(std::min(root_a, root_b));
    sign_[child] = static_cast<std::int8_t>(sign_a * sign_b * product);
    return true;
  }

  /// The root, and the sign of the node relative to it.
  std::pair<Offset, int> find(Offset node) {
    int sign = 1;
    while (parent_[node] != node) {
      const Offset parent = parent_[node];
      if (parent_[parent] != parent) {
        sign_[node] = static_cast<std::int8_t>(sign_[node] * sign_[parent]);
        parent_[node] = parent_[parent];
      }
      sign *= sign_[node];
      node = parent_[node];
    }
    return {node, sign};
  }

  /// Before the node, or the node itself where it is a root.
  Offset parent(Offset node) const { return parent_[node]; }
  /// Relative to the parent.
  int sign(Offset node) const { return sign_[node]; }

 private:
  std::vector<Number> parent_;
  std::vector<std::int8_t> sign_;
};

}  // namespace remanifold::detail
