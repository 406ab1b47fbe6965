// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/cavity_refill.hpp"

#include "base/sort_unique.hpp"
#include "chain/cavity_part.hpp"

#include <algorithm>
#include <set>

namespace remanifold::detail {
namespace {

/// Of the energy there: less is rounding.
constexpr double kBetter = 1e-9;
/// Neighborhoods of one cavity.
constexpr Index kMost = 8;

}  // namespace

CavityRefill::CavityRefill(const Cavities& cavities, Index size)
    : cavities_(cavities),
      arity_(cavities.candidates.arity),
      size_(size),
      cofaces_(cavities.rims.size()),
      chosen_(cavities.energies.size(), 0),
      marked_(cavities.energies.size(), 0),
      tried_(cavities.rims.size(), 0),
      number_(cavities.energies.size(), -1) {
  for (std::size_t f = 0; f < cofaces_.size(); ++f) {
    cofaces_[f] = cavities.rims[f] == kOpen ? 0 : 1;
  }
}

void CavityRefill::choose(Index candidate, int change) {
  chosen_[candidate] = change > 0 ? 1 : 0;
  const Index* facets = cavities_.facets_without(candidate);
  for (int i = 0; i < arity_; ++i) {
    cofaces_[facets[i]] = static_cast<std::uint8_t>(cofaces_[facets[i]] + change);
  }
}

CavityRefill::Neighborhood CavityRefill::around(Index facet) {
  Neighborhood near;
  const Offset seeds = std::min<Offset>(size_, cavities_.candidates_on.size(facet));
  near.candidates.assign(cavities_.candidates_on.begin(facet),
                         cavities_.candidates_on.begin(facet) + seeds);
  for (const Index c : near.candidates) {
    marked_[c] = 1;
  }
  grow_through_facets(
      cavities_, size_, [](Index) { return true; }, marked_, near.candidates);
  for (std::size_t i = 0; i < near.candidates.size(); ++i) {
    const Index c = near.candidates[i];
    marked_[c] = 0;
    number_[c] = static_cast<Index>(i);
    const Index* facets = cavities_.facets_without(c);
    near.facets.insert(near.facets.end(), facets, facets + arity_);
  }
  sort_unique(near.facets);
  for (const Index f : near.facets) {
    int inside = 0;
    for (const Index* c = cavities_.candidates_on.begin(f);
         c != cavities_.candidates_on.end(f); ++c) {
      inside += number_[*c] >= 0 ? chosen_[*c] : 0;
    }
    near.outside.push_back(static_cast<std::uint8_t>(cofaces_[f] - inside));
  }
  return near;
}

/// A facet has two cofaces, none, or is open: x on it + outside = 2 * both + open.
LinearProgram CavityRefill::program_of(const Neighborhood& near) const {
  LinearProgram p;
  for (const Index c : near.candidates) {
    p.costs.push_back(cavities_.energies[c]);
    p.upper.push_back(1);
    p.integral.push_back(1);
  }
  const auto column = [&](double cost, bool integral) {
    p.costs.push_back(cost);
    p.upper.push_back(1);
    p.integral.push_back(integral ? 1 : 0);
    return static_cast<Index>(p.costs.size() - 1);
  };
  for (std::size_t i = 0; i < near.facets.size(); ++i) {
    const Index f = near.facets[i];
    const auto begin = static_cast<Offset>(p.columns.size());
    for (const Index* c = cavities_.candidates_on.begin(f);
         c != cavities_.candidates_on.end(f); ++c) {
      if (number_[*c] >= 0) {
        p.columns.push_back(number_[*c]);
        if (near.outside[i] == 2) {
          p.upper[number_[*c]] = 0;
        }
      }
    }
    const auto count = static_cast<Offset>(p.columns.size()) - begin;
    p.values.resize(p.columns.size(), 1);
    if (near.outside[i] == 2) {
      p.columns.resize(begin);
      p.values.resize(begin);
      continue;
    }
    if (near.outside[i] == 0 && count > 1) {
      p.columns.push_back(column(0, true));
      p.values.push_back(-2);
    }
    p.columns.push_back(column(cavities_.prices[f], false));
    p.values.push_back(near.outside[i] == 0 ? -1 : 1);
    p.row_lower.push_back(near.outside[i]);
    p.row_upper.push_back(near.outside[i]);
    p.offsets.push_back(static_cast<Offset>(p.columns.size()));
  }
  return p;
}

double CavityRefill::energy_now(const Neighborhood& near) const {
  double energy = 0;
  for (const Index c : near.candidates) {
    energy += chosen_[c] != 0 ? cavities_.energies[c] : 0;
  }
  for (const Index f : near.facets) {
    energy += cofaces_[f] == 1 ? cavities_.prices[f] : 0;
  }
  return energy;
}

void CavityRefill::run(Index cavity, const ProgramSolver& solver,
                       const Execution& execution, std::vector<Index>& chosen) {
  for (const Index c : chosen) {
    choose(c, 1);
  }
  std::set<Index> open;
  for (const Index* f = cavities_.facets_in.begin(cavity);
       f != cavities_.facets_in.end(cavity); ++f) {
    if (cofaces_[*f] == 1) {
      open.insert(*f);
    }
  }
  const Index most = num_programs_ + kMost;
  while (!open.empty() && num_programs_ < most) {
    const Index facet = *open.begin();
    open.erase(open.begin());
    if (cofaces_[facet] != 1 || tried_[facet] != 0) {
      continue;
    }
    execution.poll();
    const Neighborhood near = around(facet);
    ++num_programs_;
    const std::vector<double> x = solver(program_of(near));
    const double before = energy_now(near);
    std::vector<std::uint8_t> previous;
    for (const Index c : near.candidates) {
      previous.push_back(chosen_[c]);
    }
    const auto set = [&](const auto& wanted) {
      for (std::size_t i = 0; i < near.candidates.size(); ++i) {
        const Index c = near.candidates[i];
        if ((chosen_[c] != 0) != wanted(i)) {
          choose(c, wanted(i) ? 1 : -1);
        }
      }
    };
    if (!x.empty()) {
      set([&](std::size_t i) { return x[i] > 0.5; });
      if (energy_now(near) < before * (1 - kBetter)) {
        ++num_bettered_;
      } else {
        set([&](std::size_t i) { return previous[i] != 0; });
      }
    }
    // Facets among the nearer half were looked at as well, and all of them where nothing
    // is farther.
    tried_[facet] = 1;
    const std::size_t count = near.candidates.size();
    const std::size_t half =
        count < static_cast<std::size_t>(size_) ? count : (count + 1) / 2;
    for (std::size_t i = 0; i < near.candidates.size(); ++i) {
      const Index* facets = cavities_.facets_without(near.candidates[i]);
      for (int j = 0; j < arity_; ++j) {
        const Index f = facets[j];
        if (i < half) {
          tried_[f] = 1;
        } else if (cofaces_[f] == 1 && tried_[f] == 0) {
          open.insert(f);
        }
      }
      number_[near.candidates[i]] = -1;
    }
  }
  chosen.clear();
  for (const Index* c = cavities_.candidates_in.begin(cavity);
       c != cavities_.candidates_in.end(cavity); ++c) {
    if (chosen_[*c] != 0) {
      chosen.push_back(*c);
    }
  }
}

}  // namespace remanifold::detail
