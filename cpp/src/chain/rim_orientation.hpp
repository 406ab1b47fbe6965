// SPDX-License-Identifier: GPL-3.0-or-later
// Signs that orient the simplices around a cavity alike, by walking over shared facets:
// tangent frames would be wrong at creases. A patch that has no orientation gets a local
// one, by walks from the rim outwards until they meet.
#pragma once

#include "remanifold/facets.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold::detail {

class RimOrientation {
 public:
  /// \param orientable  false where the fixed simplices are a part of a whole that has no
  ///                    orientation: no patch is believed to have one
  RimOrientation(const SimplexArray& fixed, Index num_vertices, bool orientable,
                 const Execution& execution);

  /// Of some facets of fixed simplices: the sign of the simplex, and a group within which
  /// signs agree. Groups count from 0.
  struct Signs {
    std::vector<std::int8_t> sign;
    std::vector<Index> group;
    Index num_groups = 0;
    bool certain = true;  // within groups: no patch is without orientation
  };
  Signs orient(const std::vector<FacetNumber>& rims);
  /// The same by what is near: walks from the rims take no more than `most` steps, and
  /// those that did not meet are groups of their own.
  Signs orient_near(const std::vector<FacetNumber>& rims, std::size_t most);

  /// One more simplex, the next in number, for walks to go through.
  /// \param neighbors  at each of its facets the facet of the simplex there, or kOpen
  void append(const FacetNumber* neighbors);
  /// Without those that were appended.
  void forget();

 private:
  void orient_by_walking(const std::vector<FacetNumber>& rims,
                         const std::vector<std::size_t>& own, std::size_t most,
                         Signs& result);
  void walk(const std::vector<Offset>& seeds, std::size_t most);

  int arity_;
  std::vector<FacetNumber> neighbors_;
  OrientedPatches patches_;
  std::vector<Index> owner_;       // walk that reached a simplex, or -1
  std::vector<std::int8_t> sign_;  // relative to the start of that walk
  std::vector<Offset> reached_;
  std::vector<Index> parent_;  // walks that met
  std::vector<std::int8_t> parity_;
};

}  // namespace remanifold::detail
