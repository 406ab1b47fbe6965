// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "remanifold/types.hpp"

#include <unordered_map>
#include <utility>

namespace remanifold::detail {

/// Disjoint sets of nodes, each with a sign relative to the others of its set.
class SignedSets {
 public:
  /// Demands sign(a) * sign(b) = product.
  /// \returns false where that contradicts what was demanded before
  bool join(Offset a, Offset b, int product) {
    const auto [root_a, sign_a] = find(a);
    const auto [root_b, sign_b] = find(b);
    if (root_a == root_b) {
      return sign_a * sign_b == product;
    }
    parents_[root_b] = {root_a, sign_a * sign_b * product};
    return true;
  }

 private:
  /// The root, and the sign of the node relative to it.
  std::pair<Offset, int> find(Offset node) {
    int sign = 1;
    for (;;) {
      const auto [parent, relative] = parents_.try_emplace(node, node, 1).first->second;
      if (parent == node) {
        return {node, sign};
      }
      sign *= relative;
      node = parent;
    }
  }

  std::unordered_map<Offset, std::pair<Offset, int>> parents_;
};

}  // namespace remanifold::detail
