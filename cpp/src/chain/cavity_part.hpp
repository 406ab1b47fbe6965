// SPDX-License-Identifier: GPL-3.0-or-later
// What one program is about: a cavity, or a window of a cavity that is too large for one
// program. Windows are taken along the rims, each as a core with what surrounds it; what
// the program says of the core is kept, its simplices are rims to the windows after it,
// and the surroundings are looked at again. So the cost is linear in the candidates, and
// orientation matters only within a window.
#pragma once

#include "chain/rim_orientation.hpp"
#include "remanifold/cavities.hpp"

#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

namespace remanifold::detail {

struct CavityPart {
  const Cavities* cavities = nullptr;
  std::vector<Index> candidates;  ///< ascending
  std::vector<Index> facets;      ///< theirs, ascending
  /// Of each facet: that of the simplex which is there, fixed or chosen before, or kOpen.
  std::vector<FacetNumber> rims;
  /// K = D: the sign of that simplex; empty otherwise.
  std::vector<std::int8_t> rim_orientations;
  /// Of each facet: whether candidates outside may continue it. That costs nothing here.
  std::vector<std::uint8_t> continued;
  /// Of each candidate: whether this part decides on it.
  std::vector<std::uint8_t> core;

  int arity() const { return cavities->candidates.arity; }
  Offset num_candidates() const { return static_cast<Offset>(candidates.size()); }
  Offset num_facets() const { return static_cast<Offset>(facets.size()); }
  /// The position of a candidate of the cavity in this part, or -1.
  Offset find_candidate(Index candidate) const;
  /// The position of the facet that leaves out the i-th vertex of the c-th candidate.
  Offset facet_of(Offset c, int i) const;
  /// \param body  called with each candidate's position and the position of its vertex
  ///              that the facet leaves out
  template <class Body>
  void for_each_on(Offset facet, const Body& body) const {
    for (const Index* c = cavities->candidates_on.begin(facets[facet]);
         c != cavities->candidates_on.end(facets[facet]); ++c) {
      const Offset own = find_candidate(*c);
      if (own >= 0) {
        const Index* without = cavities->facets_without(*c);
        int i = 0;
        while (without[i] != facets[facet]) {
          ++i;
        }
        body(own, i);
      }
    }
  }
};

/// Sign of the facet of a simplex that leaves out the vertex at a position.
inline int parity(Offset position) { return position % 2 == 0 ? 1 : -1; }

/// Adds candidates until there are `most`, breadth first through facets.
/// \param is_free  whether a candidate may be taken
/// \param marked   of each candidate: whether it is among the grown ones
template <class IsFree>
void grow_through_facets(const Cavities& cavities, Index most, const IsFree& is_free,
                         std::vector<std::uint8_t>& marked, std::vector<Index>& grown) {
  for (std::size_t next = 0; next < grown.size(); ++next) {
    const Index* facets = cavities.facets_without(grown[next]);
    for (int i = 0; i < cavities.candidates.arity; ++i) {
      for (const Index* c = cavities.candidates_on.begin(facets[i]);
           c != cavities.candidates_on.end(facets[i]); ++c) {
        if (marked[*c] != 0 || !is_free(*c)) {
          continue;
        }
        if (static_cast<Index>(grown.size()) == most) {
          return;
        }
        marked[*c] = 1;
        grown.push_back(*c);
      }
    }
  }
}

CavityPart whole_cavity(const Cavities& cavities, Index cavity);

/// The windows of cavities, one after the other.
class CavityWindows {
 public:
  /// \param num_fixed  the fixed simplices that rims refer to; candidates that are chosen
  ///                   count on from there
  /// \param size       candidates of a window; its core is a half of them
  CavityWindows(const Cavities& cavities, Offset num_fixed, Index size);

  void start(Index cavity);
  /// \returns an empty part where everything is decided
  CavityPart next();
  /// \param chosen       candidates of the part's core
  /// \param orientation  is told of them, if there is one
  void decide(const CavityPart& part, const std::vector<Index>& chosen,
              RimOrientation* orientation);

 private:
  void touch(Index facet);

  const Cavities& cavities_;
  int arity_;
  Index size_;
  Offset num_fixed_;
  Offset num_simplices_;  // and chosen ones
  std::vector<FacetNumber>
      rims_;  // of each facet; kBranching where it has both cofaces
  std::vector<std::int8_t> rim_orientations_;
  std::vector<std::uint8_t> decided_;  // of each candidate
  std::vector<std::uint8_t> marked_;   // of each candidate: in the window that grows
  /// Candidates on rims, lowest first: samples are numbered along a curve that fills space.
  std::priority_queue<Index, std::vector<Index>, std::greater<>> front_;
};

}  // namespace remanifold::detail
