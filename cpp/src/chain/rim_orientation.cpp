// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/rim_orientation.hpp"

#include "base/sort_unique.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace remanifold::detail {

RimOrientation::RimOrientation(const SimplexArray& fixed, Index num_vertices,
                               bool orientable, const Execution& execution)
    : arity_(fixed.arity),
      neighbors_(facet_neighbors(fixed, num_vertices, execution)),
      patches_(orient_patches(neighbors_, arity_)) {
  if (!orientable) {
    std::fill(patches_.orientable.begin(), patches_.orientable.end(), 0);
  }
}

void RimOrientation::append(const FacetNumber* neighbors) {
  const auto first = static_cast<FacetNumber>(neighbors_.size());
  for (int i = 0; i < arity_; ++i) {
    neighbors_.push_back(neighbors[i]);
    if (neighbors[i] >= 0) {
      neighbors_[neighbors[i]] = first + i;
    }
  }
}

void RimOrientation::forget() {
  const FacetNumber known = static_cast<FacetNumber>(patches_.sign.size()) * arity_;
  for (auto f = static_cast<FacetNumber>(neighbors_.size()); f-- > known;) {
    if (neighbors_[f] >= 0) {
      neighbors_[neighbors_[f]] = kOpen;
    }
  }
  neighbors_.resize(known);
}

RimOrientation::Signs RimOrientation::orient(const std::vector<FacetNumber>& rims) {
  Signs result;
  result.sign.resize(rims.size());
  result.group.assign(rims.size(), -1);
  const auto patch_of = [&](std::size_t i) { return patches_.patch[rims[i] / arity_]; };
  std::vector<std::size_t> by_patch(rims.size());
  std::iota(by_patch.begin(), by_patch.end(), std::size_t{0});
  std::stable_sort(by_patch.begin(), by_patch.end(), [&](std::size_t a, std::size_t b) {
    return patch_of(a) < patch_of(b);
  });
  std::vector<std::size_t> own;
  for (auto begin = by_patch.begin(); begin != by_patch.end(); begin += own.size()) {
    const Index patch = patch_of(*begin);
    own.assign(begin, std::find_if(begin, by_patch.end(), [&](std::size_t i) {
                 return patch_of(i) != patch;
               }));
    if (patches_.orientable[patch] == 0) {
      result.certain = false;
      orient_by_walking(rims, own, std::numeric_limits<std::size_t>::max(), result);
      continue;
    }
    for (const std::size_t i : own) {
      result.sign[i] = patches_.sign[rims[i] / arity_];
      result.group[i] = result.num_groups;
    }
    ++result.num_groups;
  }
  return result;
}

RimOrientation::Signs RimOrientation::orient_near(const std::vector<FacetNumber>& rims,
                                                  std::size_t most) {
  Signs result;
  result.sign.resize(rims.size());
  result.group.assign(rims.size(), -1);
  std::vector<std::size_t> all(rims.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  orient_by_walking(rims, all, most, result);
  return result;
}

void RimOrientation::orient_by_walking(const std::vector<FacetNumber>& rims,
                                       const std::vector<std::size_t>& own,
                                       std::size_t most, Signs& result) {
  std::vector<Offset> seeds;
  for (const std::size_t i : own) {
    seeds.push_back(rims[i] / arity_);
  }
  walk(seeds, most);
  std::vector<Index> group_of_walk(seeds.size(), -1);
  for (const std::size_t i : own) {
    const Offset simplex = rims[i] / arity_;
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

// Breadth first from all seeds at once. Where two walks meet they become one; a walk that
// comes back with the other sign has gone round a loop without orientation and is not
// believed.
void RimOrientation::walk(const std::vector<Offset>& seeds, std::size_t most) {
  owner_.resize(neighbors_.size() / arity_, -1);
  sign_.resize(neighbors_.size() / arity_, 0);
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
  for (std::size_t next = 0; next < std::min(most, reached_.size()) && apart > 1;
       ++next) {
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
