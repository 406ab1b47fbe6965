// SPDX-License-Identifier: GPL-3.0-or-later
// Fills cavities with the candidates of least energy, where every facet has two cofaces
// or is left open at its price. Small cavities are searched through exactly; the others
// are linear programs over oriented simplices (Attali and Lieutier, Delaunay-like
// triangulation of smooth orientable submanifolds by l1-norm minimization, 2022), whose
// solutions are nearly always integral (Dey, Hirani and Krishnamoorthy, 2011) and
// otherwise integer programs.
#pragma once

#include "remanifold/cavities.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace remanifold {

/// Minimise costs * x where row_lower <= A x <= row_upper and 0 <= x <= upper.
struct LinearProgram {
  std::vector<double> costs;
  std::vector<double> upper;
  std::vector<std::uint8_t> integral;  ///< of each column; empty: none
  std::vector<double> row_lower;
  std::vector<double> row_upper;
  std::vector<Offset> offsets{0};  ///< A by rows
  std::vector<Index> columns;
  std::vector<double> values;
};

/// \returns x, or nothing where no solution was found within the solver's limits
using ProgramSolver = std::function<std::vector<double>(const LinearProgram&)>;

struct ChainOptions {
  /// Cavities with no more candidates are searched through.
  Index search_candidates = 40;
  /// Steps of a search after which the cavity becomes a program; where there is no solver
  /// the best filling found by then is taken.
  Index search_steps = 500;
  /// Whether what a search finds has to have an orientation that agrees with the rims: among
  /// many candidates there are fillings without one. Where it has none a program decides.
  bool search_oriented = false;
  /// The largest program that is ever built has so many candidates. Larger cavities are cut
  /// into windows.
  Index largest_program = 4000;
  /// Candidates of a window. Half of them are its core, which is decided on: smaller ones
  /// cost less a candidate, and windows of 500 begin to leave more open than those of 1000.
  Index window = 1000;
  /// Candidates around a facet that was left open which are chosen from again without
  /// orientation, in cavities that are one program; 0: that is not tried.
  Index refill = 100;
  /// False where the fixed simplices are a part of a whole that has no orientation.
  bool orientable = true;
};

struct ChainFill {
  std::vector<Index> chosen;       ///< candidates, ascending
  std::vector<std::uint8_t> open;  ///< of each cavity: has facets left open
  std::vector<Index> open_facets;  ///< by cavity, ascending within each
  Index searched = 0;              ///< cavities searched through
  Index programs = 0;              ///< cavities and windows solved as linear programs
  Index cut = 0;                   ///< cavities cut into windows, each a program
  Index refills = 0;               ///< programs around facets that were left open
  Index refilled = 0;              ///< of these, where energy fell
  Index largest_program = 0;       ///< its candidates
  Index integer_programs = 0;      ///< and as integer programs
  Index unsolved = 0;              ///< neither search nor solver came to an end
};

/// \param fixed    the fixed simplices that the cavities' rims refer to, all of them
/// \param num_vertices  more than any vertex
ChainFill fill_cavities(const Cavities& cavities, const SimplexArray& fixed,
                        Index num_vertices, const ChainOptions& options,
                        const ProgramSolver& solver, const Execution& execution = {});

}  // namespace remanifold
