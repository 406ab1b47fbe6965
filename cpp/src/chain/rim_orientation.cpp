// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/rim_orientation.hpp"

#include "base/sort_unique.hpp"

#include <algorithm>
#include <utility>

namespace remanifold::detail {

RimOrientation::RimOrientation(const SimplexArray& fixed, Index num_vertices,
                               const Execution& execution)
    : arity_(fixed.arity),
      neighbors_(facet_neighbors(fixed, num_vertices, execution)),
      patches_(orient_patches(neighbors_, arity_)) {}

RimOrientation::Signs RimOrientation::orient(const std::vector<FacetNumber>& rims) {
  Signs result;
  result.sign.resize(rims.size());
  result.group.assign(rims.size(), -1);
  std::vector<Index> patches;
  for (const FacetNumber f : rims) {
    patches.push_back(patches_.patch[f / arity_]);
  }
  sort_unique(patches);
  for (const Index patch : patches) {
    std::vector<Offset> seeds;
    for (const FacetNumber f : rims) {
      if (patches_.patch[f / arity_] == patch) {
        seeds.push_back(f / arity_);
      }
    }
    const bool local = patches_.orientable[patch] == 0;
    if (local) {
      walk(seeds);
    }
    std::vector<Index> group_of_walk(seeds.size(), -1);
    const Index first_group = result.num_groups;
    result.num_groups += local ? 0 : 1;
    for (std::size_t i = 0; i < rims.size(); ++i) {
      const Offset simplex = rims[i] / arity_;
      if (patches_.patch[simplex] != patch) {
        continue;
      }
      if (!local) {
        result.sign[i] = patches_.sign[simplex];
        result.group[i] = first_group;
        continue;
      }
      Index root = owner_[simplex];
      std::int8_t sign = sign_[simplex];
      while (parent_[root] != root) {
        sign = static_cast<std::int8_t>(sign * parity_[root]);
        root = parent_[root];
      }
      if (group_of_walk[root] < 0) {
        group_of_walk[root] = result.num_groups++;
      }
      result.sign[i] = sign;
      result.group[i] = group_of_walk[root];
    }
    for (const Offset simplex : reached_) {
      owner_[simplex] = -1;
    }
    reached_.clear();
  }
  return result;
}

// Breadth first from all seeds at once. Where two walks meet they become one; a walk that
// comes back with the other sign has gone round a loop without orientation and is not
// believed.
void RimOrientation::walk(const std::vector<Offset>& seeds) {
  owner_.resize(patches_.sign.size(), -1);
  sign_.resize(patches_.sign.size(), 0);
  parent_.clear();
  parity_.clear();
  std::size_t apart = 0;
  for (const Offset seed : seeds) {
    if (owner_[seed] < 0) {
      owner_[seed] = static_cast<Index>(parent_.size());
      sign_[seed] = 1;
      reached_.push_back(seed);
      parent_.push_back(owner_[seed]);
      parity_.push_back(1);
      ++apart;
    }
  }
  const auto root_of = [&](Index walk) {
    std::pair<Index, std::int8_t> root{walk, 1};
    while (parent_[root.first] != root.first) {
      root.second = static_cast<std::int8_t>(root.second * parity_[root.first]);
      root.first = parent_[root.first];
    }
    return root;
  };
  for (std::size_t next = 0; next < reached_.size() && apart > 1; ++next) {
    const Offset s = reached_[next];
    for (FacetNumber f = s * arity_; f < (s + 1) * arity_; ++f) {
      const FacetNumber other = neighbors_[f];
      if (other < 0) {
        continue;
      }
      const Offset t = other / arity_;
      const auto wanted = static_cast<std::int8_t>(
          flips_across(f, other, arity_) ? -sign_[s] : sign_[s]);
      if (owner_[t] < 0) {
        owner_[t] = owner_[s];
        sign_[t] = wanted;
        reached_.push_back(t);
        continue;
      }
      const auto [a, sign_a] = root_of(owner_[s]);
      const auto [b, sign_b] = root_of(owner_[t]);
      if (a != b) {
        // sign_[t] * sign_b * parity = wanted * sign_a
        parent_[b] = a;
        parity_[b] = static_cast<std::int8_t>(sign_[t] * sign_b * wanted * sign_a);
        --apart;
      }
    }
  }
}

}  // namespace remanifold::detail
