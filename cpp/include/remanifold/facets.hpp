// SPDX-License-Identifier: GPL-3.0-or-later
// The facets, (K-1)-faces, of K-simplices: which simplices share them, and orientations
// that agree across them.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace remanifold {

/// Facet i of simplex s, the one that leaves out its i-th vertex, has the number
/// s * arity + i.
using FacetNumber = Offset;

/// Facet numbers in groups that stand for the same vertices. Groups follow each other in
/// lexicographic order of the vertices, numbers ascend within each.
struct FacetGroups {
  std::vector<Offset> offsets{0};
  std::vector<FacetNumber> facets;

  Offset size() const { return static_cast<Offset>(offsets.size()) - 1; }
  Offset cofaces(Offset group) const { return offsets[group + 1] - offsets[group]; }
};
/// Columns of the simplices must ascend.
FacetGroups group_facets(const SimplexArray& simplices, Index num_vertices,
                         const Execution& execution = {});

/// The vertices of a facet.
void copy_facet(const SimplexArray& simplices, FacetNumber facet, Index* out);

/// Facets, all of whose vertices are inside, that not exactly two simplices share.
struct UnpairedFacets {
  SimplexArray open;       ///< with one coface
  SimplexArray branching;  ///< with more than two
};
/// \param inside  of each sample; all simplices on facets inside must be given
UnpairedFacets unpaired_facets(const SimplexArray& simplices,
                               const std::vector<std::uint8_t>& inside,
                               const Execution& execution = {});

/// The edges of the simplices, i < j, sorted.
SimplexArray edges_of(const SimplexArray& simplices, Index num_vertices);

/// For each facet the facet of the only other simplex that has it; kOpen where no other
/// has it, kBranching where several have.
constexpr FacetNumber kOpen = -1;
constexpr FacetNumber kBranching = -2;
/// \tparam Number  FacetNumber, or std::int32_t where has_few_facets()
template <class Number = FacetNumber>
std::vector<Number> facet_neighbors(const SimplexArray& simplices, Index num_vertices,
                                    const Execution& execution = {});

/// Whether facets can be numbered in 32 bits, which halves what their neighbors take.
inline bool has_few_facets(const SimplexArray& simplices) {
  return simplices.vertices.size() <=
         static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
}

/// Whether two simplices on a facet, named by the facet's numbers, must have opposite
/// signs to be oriented alike; the sign of an ascending simplex is +1.
inline bool flips_across(FacetNumber a, FacetNumber b, int arity) {
  return (a % arity + b % arity) % 2 == 0;
}

/// Patches: simplices connected through facets.
struct OrientedPatches {
  std::vector<Index> patch;       ///< of each simplex, in order of the first
  std::vector<std::int8_t> sign;  ///< +1 or -1, alike across facets where possible
  std::vector<Offset> sizes;      ///< simplices of each patch
  std::vector<std::uint8_t> orientable;  ///< of each patch
  std::vector<std::uint8_t> closed;      ///< of each patch: no facet is open
};
/// \param neighbors  by facet_neighbors()
template <class Number>
OrientedPatches orient_patches(const std::vector<Number>& neighbors, int arity,
                               const Execution& execution = {});
/// The same of the simplices themselves.
OrientedPatches orient_patches(const SimplexArray& simplices, Index num_vertices,
                               const Execution& execution = {});

/// The same for simplices most of which are known with their patches, at the cost of the
/// others and what is around them.
/// \param known       rows of which the first `num_known` count and are sorted
/// \param patches     theirs
/// \param simplices   sorted rows
/// \param around      of each sample: all vertices of facets that were open among the
///                    known, and of simplices that are new
/// \returns nothing where a known simplex is missing
std::optional<OrientedPatches> extend_patches(const SimplexArray& known,
                                              Offset num_known,
                                              const OrientedPatches& patches,
                                              const SimplexArray& simplices,
                                              const std::vector<std::uint8_t>& around,
                                              const Execution& execution = {});

}  // namespace remanifold
