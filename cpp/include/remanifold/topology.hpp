// SPDX-License-Identifier: GPL-3.0-or-later
// What a pure simplicial complex is, exactly and read-only: faces by number of cofaces,
// Euler characteristic, components, links, orientability, holes.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

/// The faces of dimension `dim` of the simplices, columns ascending, rows sorted, and in
/// how many simplices each lies. Columns of the simplices must ascend.
struct Faces {
  SimplexArray simplices;
  std::vector<Index> cofaces;
};
Faces faces_of(const SimplexArray& simplices, int dim, const Execution& execution = {});

/// Connected components of the simplices (sharing any vertex); a label for each of
/// num_vertices vertices in order of the lowest vertex, -1 for vertices in no simplex.
struct Components {
  Index count = 0;
  std::vector<Index> labels;
};
Components connected_components(const SimplexArray& simplices, Index num_vertices);

struct Topology {
  std::vector<Offset> face_counts;  ///< faces of dimension 0 .. K
  Offset euler_characteristic = 0;
  Index components = 0;
  std::vector<Offset> coface_counts;  ///< (K-1)-faces by number of cofaces; [0] is 0
  bool pseudomanifold = false;        ///< no (K-1)-face has more than two cofaces
  Index boundary_components = 0;      ///< connected sets of facets with one coface
  bool closed = false;                ///< every (K-1)-face has exactly two cofaces
  bool orientable = false;            ///< false where it is no pseudomanifold
  /// Sets of simplices connected through facets with two cofaces, that have no others;
  /// they count the top homology of a pseudomanifold: all over Z2, the orientable ones
  /// over other fields.
  Index closed_patches = 0;
  Index closed_orientable_patches = 0;
  /// Vertices whose link is neither a sphere nor a ball. Exact for K <= 3. For K > 3 only
  /// those found by conditions that are necessary: the link is a connected pseudomanifold,
  /// has the Euler characteristic of a sphere or, where it has a boundary, of a ball, and
  /// the links of its own vertices satisfy the same.
  std::vector<Index> singular_vertices;
  /// Vertices that are not singular by these conditions and whose links were not proved to
  /// be spheres or balls by collapsing them. None for K <= 3.
  std::vector<Index> undecided_vertices;
};

/// \throws std::invalid_argument  vertex out of range, columns that do not ascend
Topology compute_topology(const SimplexArray& simplices, Index num_vertices,
                          const Execution& execution = {});

/// Whether a complex is a sphere or a ball. Decisive up to dimension 2; above, connected
/// pseudomanifolds of such links with the Euler characteristic of one pass.
bool is_sphere_or_ball(const SimplexArray& simplices);

/// The singular vertices among those marked.
std::vector<Index> singular_vertices(const SimplexArray& simplices,
                                     const std::vector<std::uint8_t>& marked,
                                     const Execution& execution = {});

/// Faces with one coface, in connected sets (sharing a (K-2)-face; for K = 1 each on its
/// own). A set none of whose vertices is marked as boundary is a hole.
struct OpenFaces {
  SimplexArray faces;
  std::vector<Index> set;          ///< of each face
  std::vector<std::uint8_t> hole;  ///< of each set
};
OpenFaces find_open_faces(const Faces& faces,
                          const std::vector<std::uint8_t>& boundary);

}  // namespace remanifold
