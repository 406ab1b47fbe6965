// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/relative_signs.hpp"

#include "base/signed_sets.hpp"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

namespace remanifold::detail {
namespace {

/// The walk from the first group on, cheapest candidates first. The side of a simplex at
/// one of its facets is its sign there in the boundary: where two simplices are oriented
/// alike, their sides at a common facet are opposite.
class SignWalk {
 public:
  SignWalk(const CavityPart& part, const RimOrientation::Signs& rims)
      : part_(part),
        signs_(part.num_facets(), 0),
        group_(part.num_facets(), -1),
        facets_of_group_(rims.num_groups),
        known_(rims.num_groups, 0),
        reached_(part.num_candidates(), 0) {
    std::size_t rim = 0;
    for (Offset f = 0; f < part.num_facets(); ++f) {
      if (part.rims[f] >= 0) {
        signs_[f] = rims.sign[rim];
        group_[f] = rims.group[rim];
        facets_of_group_[group_[f]].push_back(f);
        ++rim;
      }
    }
  }

  std::vector<std::int8_t> run() {
    for (std::size_t g = 0; g < known_.size(); ++g) {
      if (known_[g] == 0) {
        start_at(static_cast<Index>(g), 1, 0);
        walk();
      }
    }
    return std::move(signs_);
  }

 private:
  /// Distance, candidate, sign: the first two decide, so that ties do not depend on order.
  using Step = std::tuple<double, Offset, int>;

  void start_at(Index group, int factor, double distance) {
    known_[group] = 1;
    for (const Offset f : facets_of_group_[group]) {
      signs_[f] = static_cast<std::int8_t>(signs_[f] * factor);
      hand_over(f, side_of_rim(f), distance);
    }
  }

  int side_of_rim(Offset facet) const {
    return signs_[facet] * parity(part_.rims[facet] % part_.arity());
  }

  /// To the candidates on a facet, the side of what is there already.
  void hand_over(Offset facet, int side, double distance) {
    part_.for_each_on(facet, [&](Offset c, int position) {
      if (reached_[c] == 0) {
        queue_.emplace(distance + part_.cavities->energies[part_.candidates[c]], c,
                       -side * parity(position));
      }
    });
  }

  void walk() {
    while (!queue_.empty()) {
      const auto [distance, c, sign] = queue_.top();
      queue_.pop();
      if (reached_[c] != 0) {
        continue;
      }
      reached_[c] = 1;
      for (int i = 0; i < part_.arity(); ++i) {
        const Offset f = part_.facet_of(c, i);
        const int side = sign * parity(i);
        if (group_[f] < 0) {
          hand_over(f, side, distance);
        } else if (known_[group_[f]] == 0) {
          start_at(group_[f], side_of_rim(f) == -side ? 1 : -1, distance);
        }
      }
    }
  }

  const CavityPart& part_;
  std::vector<std::int8_t> signs_;  // of each facet
  std::vector<Index> group_;        // of each facet, or -1
  std::vector<std::vector<Offset>> facets_of_group_;
  std::vector<std::uint8_t> known_;    // of each group
  std::vector<std::uint8_t> reached_;  // of each candidate
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue_;
};

}  // namespace

std::vector<std::int8_t> relative_signs(const CavityPart& part,
                                        const RimOrientation::Signs& rims) {
  return SignWalk(part, rims).run();
}

bool has_orientation(const CavityPart& part, const std::vector<std::int8_t>& signs,
                     const std::vector<Index>& chosen) {
  // The last node stands for the simplices at the rims, whose sides are known.
  const auto rims = static_cast<Offset>(chosen.size());
  SignedSets<Offset> sets(rims + 1);
  struct Side {
    Offset node;
    int parity;
  };
  std::vector<Side> side_at(part.num_facets(), {-1, 0});
  for (Offset f = 0; f < part.num_facets(); ++f) {
    if (part.rims[f] != kOpen) {
      side_at[f] = {rims, signs[f] * parity(part.rims[f] % part.arity())};
    }
  }
  for (Offset i = 0; i < rims; ++i) {
    const Offset c = part.find_candidate(chosen[i]);
    for (int k = 0; k < part.arity(); ++k) {
      Side& other = side_at[part.facet_of(c, k)];
      if (other.node < 0) {
        other = {i, parity(k)};
      } else if (!sets.join(i, other.node, -parity(k) * other.parity)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace remanifold::detail
