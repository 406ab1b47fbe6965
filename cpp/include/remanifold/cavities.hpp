// SPDX-License-Identifier: GPL-3.0-or-later
// Where simplices are fixed on one side of a facet only, and the candidates that may
// continue them. Candidates that share a facet belong to one cavity; cavities are
// independent of each other.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace remanifold {

struct Cavities {
  SimplexArray candidates;       ///< columns ascending, sorted
  std::vector<double> energies;  ///< of each candidate
  /// Candidates x (K+1): the number of the facet that leaves out each vertex.
  std::vector<Index> facets_of;

  SimplexArray facets;            ///< of the candidates
  std::vector<double> prices;     ///< of leaving a facet open
  std::vector<FacetNumber> rims;  ///< the fixed simplices' facet there, or kOpen
  Csr candidates_on;              ///< candidates on each facet

  /// K = D: the sign of each candidate's volume, and of the fixed simplex at each facet.
  /// Empty otherwise.
  std::vector<std::int8_t> orientations;
  std::vector<std::int8_t> rim_orientations;

  Csr candidates_in;  ///< of each cavity
  Csr facets_in;      ///< of each cavity

  /// Facets with one fixed coface that no candidate continues.
  std::vector<FacetNumber> dead_ends;

  /// The facets of a candidate, the i-th one without its i-th vertex.
  const Index* facets_without(Index candidate) const {
    return facets_of.data() + static_cast<std::size_t>(candidate) * candidates.arity;
  }
  Index count() const { return static_cast<Index>(candidates_in.rows()); }
};

/// What it costs to leave a facet open.
using FacetPrice = std::function<double(const Index* facet)>;

/// \param fixed       the fixed simplices; they may be those near the cavities only
/// \param inside      of each sample: whether facets all of whose vertices are inside are
///                    to be looked at; all fixed cofaces of these must be given
/// \param candidates  any order, repetitions allowed; columns ascending. Those with a
///                    facet that has two fixed cofaces are left out, and (K >= 2) those
///                    that lie folded back on a fixed simplex, unless fold_back
Cavities find_cavities(const SimplexArray& fixed,
                       const std::vector<std::uint8_t>& inside,
                       const SimplexArray& candidates, SimplexRuler& ruler,
                       const FacetPrice& price, bool fold_back = false,
                       const Execution& execution = {});

}  // namespace remanifold
