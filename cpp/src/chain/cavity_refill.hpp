// SPDX-License-Identifier: GPL-3.0-or-later
// A filling is tried to be bettered where it left facets open: signs of rims that no walk
// connects are a guess. Around
// such a facet the cavity is filled again by an integer program that knows no orientation,
// with everything outside as it is; what costs less is taken. A large neighborhood search
// (Shaw, Using constraint programming and local search methods to solve vehicle routing
// problems, 1998) whose neighborhoods are of one size, each facet the middle of at most one.
#pragma once

#include "remanifold/cavities.hpp"
#include "remanifold/minimum_chain.hpp"

#include <cstdint>
#include <vector>

namespace remanifold::detail {

class CavityRefill {
 public:
  /// \param size  candidates of a neighborhood
  CavityRefill(const Cavities& cavities, Index size);

  /// \param chosen  candidates of the cavity, ascending; bettered in place
  void run(Index cavity, const ProgramSolver& solver, const Execution& execution,
           std::vector<Index>& chosen);

  Index num_programs() const { return num_programs_; }
  Index num_bettered() const { return num_bettered_; }

 private:
  struct Neighborhood {
    std::vector<Index> candidates;      ///< the nearest first
    std::vector<Index> facets;          ///< ascending
    std::vector<std::uint8_t> outside;  ///< cofaces of each facet that stay
  };

  Neighborhood around(Index facet);
  LinearProgram program_of(const Neighborhood& near) const;
  double energy_now(const Neighborhood& near) const;
  void choose(Index candidate, int change);

  const Cavities& cavities_;
  int arity_;
  Index size_;
  std::vector<std::uint8_t> cofaces_;  // of each facet
  std::vector<std::uint8_t> chosen_;   // of each candidate
  std::vector<std::uint8_t> marked_;   // of each candidate: in the neighborhood
  std::vector<std::uint8_t> tried_;    // of each facet
  std::vector<Index> number_;          // of each candidate in the neighborhood
  Index num_programs_ = 0;
  Index num_bettered_ = 0;
};

}  // namespace remanifold::detail
