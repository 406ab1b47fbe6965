// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/relative_signs.hpp"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

namespace remanifold::detail {
namespace {

int parity(Offset position) { return position % 2 == 0 ? 1 : -1; }

/// The walk from the first group on, cheapest candidates first. The side of a simplex at
/// one of its facets is its sign there in the boundary: where two simplices are oriented
/// alike, their sides at a common facet are opposite.
class SignWalk {
 public:
  SignWalk(const Cavities& cavities, Index cavity, const RimOrientation::Signs& rims)
      : cavities_(cavities),
        arity_(cavities.candidates.arity),
        candidates_(cavities.candidates_in.begin(cavity)),
        num_candidates_(cavities.candidates_in.size(cavity)),
        facets_(cavities.facets_in.begin(cavity)),
        num_facets_(cavities.facets_in.size(cavity)),
        signs_(num_facets_, 0),
        group_(num_facets_, -1),
        facets_of_group_(rims.num_groups),
        known_(rims.num_groups, 0),
        reached_(num_candidates_, 0) {
    std::size_t rim = 0;
    for (Offset f = 0; f < num_facets_; ++f) {
      if (cavities.rims[facets_[f]] != kOpen) {
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
    return signs_[facet] * parity(cavities_.rims[facets_[facet]] % arity_);
  }

  /// To the candidates on a facet, the side of what is there already.
  void hand_over(Offset facet, int side, double distance) {
    const Index number = facets_[facet];
    for (const Index* c = cavities_.candidates_on.begin(number);
         c != cavities_.candidates_on.end(number); ++c) {
      const Offset own =
          std::lower_bound(candidates_, candidates_ + num_candidates_, *c) -
          candidates_;
      if (reached_[own] == 0) {
        const Index* facets = cavities_.facets_without(*c);
        const Offset position = std::find(facets, facets + arity_, number) - facets;
        queue_.emplace(distance + cavities_.energies[*c], own,
                       -side * parity(position));
      }
    }
  }

  void walk() {
    while (!queue_.empty()) {
      const auto [distance, own, sign] = queue_.top();
      queue_.pop();
      if (reached_[own] != 0) {
        continue;
      }
      reached_[own] = 1;
      const Index* facets = cavities_.facets_without(candidates_[own]);
      for (int i = 0; i < arity_; ++i) {
        const Offset f =
            std::lower_bound(facets_, facets_ + num_facets_, facets[i]) - facets_;
        const int side = sign * parity(i);
        if (group_[f] < 0) {
          hand_over(f, side, distance);
        } else if (known_[group_[f]] == 0) {
          start_at(group_[f], side_of_rim(f) == -side ? 1 : -1, distance);
        }
      }
    }
  }

  const Cavities& cavities_;
  int arity_;
  const Index* candidates_;
  Offset num_candidates_;
  const Index* facets_;
  Offset num_facets_;
  std::vector<std::int8_t> signs_;  // of each facet
  std::vector<Index> group_;        // of each facet, or -1
  std::vector<std::vector<Offset>> facets_of_group_;
  std::vector<std::uint8_t> known_;    // of each group
  std::vector<std::uint8_t> reached_;  // of each candidate
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue_;
};

}  // namespace

std::vector<std::int8_t> relative_signs(const Cavities& cavities, Index cavity,
                                        const RimOrientation::Signs& rims) {
  return SignWalk(cavities, cavity, rims).run();
}

}  // namespace remanifold::detail
