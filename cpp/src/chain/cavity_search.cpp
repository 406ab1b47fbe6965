// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/cavity_search.hpp"

#include <algorithm>
#include <limits>

namespace remanifold::detail {

CavitySearch::CavitySearch(const Cavities& cavities, const Execution& execution)
    : cavities_(cavities),
      execution_(execution),
      arity_(cavities.candidates.arity),
      cofaces_(cavities.rims.size()),
      conceded_(cavities.rims.size(), 0) {
  for (std::size_t f = 0; f < cofaces_.size(); ++f) {
    cofaces_[f] = cavities.rims[f] == kOpen ? 0 : 1;
    if (!cavities.rim_orientations.empty()) {
      const bool even = cavities.rims[f] % arity_ % 2 == 0;
      sides_.push_back(static_cast<std::int8_t>(even ? cavities.rim_orientations[f]
                                                     : -cavities.rim_orientations[f]));
    }
  }
}

bool CavitySearch::run(Index cavity, Index max_steps) {
  cavity_ = cavity;
  steps_left_ = max_steps;
  best_energy_ = std::numeric_limits<double>::infinity();
  best_.clear();
  best_open_ = true;
  num_conceded_ = 0;
  branch(0);
  return steps_left_ > 0;
}

bool CavitySearch::fits(Index candidate) const {
  const Index* facets = cavities_.facets_without(candidate);
  for (int i = 0; i < arity_; ++i) {
    const Index f = facets[i];
    if (cofaces_[f] >= 2 || conceded_[f] != 0 ||
        (cofaces_[f] == 1 && !sides_.empty() && side(candidate, i) == sides_[f])) {
      return false;
    }
  }
  return true;
}

void CavitySearch::put(Index candidate, int change) {
  const Index* facets = cavities_.facets_without(candidate);
  for (int i = 0; i < arity_; ++i) {
    // What is taken away again leaves the other coface, on the other side.
    if (!sides_.empty() && (change < 0 || cofaces_[facets[i]] == 0)) {
      const int own = side(candidate, i);
      sides_[facets[i]] = static_cast<std::int8_t>(change > 0 ? own : -own);
    }
    cofaces_[facets[i]] = static_cast<std::uint8_t>(cofaces_[facets[i]] + change);
  }
}

void CavitySearch::branch(double energy) {
  if (steps_left_ == 0) {
    return;
  }
  --steps_left_;
  execution_.poll();
  // What is open costs at least its price or its share of a candidate.
  double bound = energy;
  Index facet = -1;
  Index fewest = std::numeric_limits<Index>::max();
  for (const Index* f = cavities_.facets_in.begin(cavity_);
       f != cavities_.facets_in.end(cavity_); ++f) {
    if (cofaces_[*f] != 1 || conceded_[*f] != 0) {
      continue;
    }
    Index options = 0;
    double cheapest = cavities_.prices[*f];
    for (const Index* c = cavities_.candidates_on.begin(*f);
         c != cavities_.candidates_on.end(*f); ++c) {
      if (fits(*c)) {
        ++options;
        cheapest = std::min(cheapest, cavities_.energies[*c] / arity_);
      }
    }
    bound += cheapest;
    if (options < fewest) {
      fewest = options;
      facet = *f;
    }
  }
  if (!(bound < best_energy_)) {
    return;
  }
  if (facet < 0) {
    best_energy_ = energy;
    best_open_ = num_conceded_ > 0;
    best_ = stack_;
    return;
  }
  std::vector<Index> options;
  for (const Index* c = cavities_.candidates_on.begin(facet);
       c != cavities_.candidates_on.end(facet); ++c) {
    if (fits(*c)) {
      options.push_back(*c);
    }
  }
  std::stable_sort(options.begin(), options.end(), [&](Index a, Index b) {
    return cavities_.energies[a] < cavities_.energies[b];
  });
  for (const Index c : options) {
    put(c, 1);
    stack_.push_back(c);
    branch(energy + cavities_.energies[c]);
    stack_.pop_back();
    put(c, -1);
  }
  conceded_[facet] = 1;
  ++num_conceded_;
  branch(energy + cavities_.prices[facet]);
  --num_conceded_;
  conceded_[facet] = 0;
}

}  // namespace remanifold::detail
