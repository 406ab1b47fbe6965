// SPDX-License-Identifier: GPL-3.0-or-later
// The filling of least energy of one cavity, by going through all of them: the open facet
// with the fewest candidates is closed by each in turn, or left open.
#pragma once

#include "remanifold/cavities.hpp"

#include <vector>

namespace remanifold::detail {

class CavitySearch {
 public:
  /// Both are referred to.
  CavitySearch(const Cavities& cavities, const Execution& execution);
  CavitySearch(const Cavities&, Execution&&) = delete;

  /// \returns false where max_steps did not suffice; chosen() is the best so far
  bool run(Index cavity, Index max_steps);
  const std::vector<Index>& chosen() const { return best_; }
  bool leaves_open() const { return best_open_; }

 private:
  void branch(double energy);
  bool fits(Index candidate) const;
  void put(Index candidate, int change);
  /// K = D: the side of its i-th facet on which a candidate lies.
  int side(Index candidate, int i) const {
    return cavities_.orientations[candidate] * (i % 2 == 0 ? 1 : -1);
  }

  const Cavities& cavities_;
  const Execution& execution_;
  int arity_;
  std::vector<std::uint8_t> cofaces_;   // of each facet
  std::vector<std::int8_t> sides_;      // K = D: the side of a single coface
  std::vector<std::uint8_t> conceded_;  // facets left open
  Index cavity_ = 0;
  Index steps_left_ = 0;
  double best_energy_ = 0;
  bool best_open_ = false;
  Index num_conceded_ = 0;
  std::vector<Index> stack_;
  std::vector<Index> best_;
};

}  // namespace remanifold::detail
