// SPDX-License-Identifier: GPL-3.0-or-later
// Local region LR(x) = ATS(x) cut by the bisecting halfspaces of x with all other
// samples (Freedman 2002, section 3.2). In an orthonormal basis of ATS(x) the halfspace
// of q reads <t, lambda> <= b, with t the tangent coordinates of q - x and
// b = (|q - x|^2 + w_x - w_q) / 2, so that LR(x) is dual to the hull of the points t / b
// and the origin: hull vertices are the edge set ES(x), hull facets that avoid the origin
// are the vertices of LR(x), each dual to a K-simplex at x (the star of x); a facet at the
// origin is a direction in which LR(x) is unbounded.
//
// - Exact over all samples at local cost: a sample farther than twice the radius of the
//   region cannot cut it (security radius); more neighbors are asked for until then.
// - The weights w (tie_weights) are 1e-7 of the squared spacing at most. They decide
//   ties of cocircular samples the same way in every region.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/tangent_space.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

/// Neighbors that certify most local regions of a random sample of a K-manifold.
Index certifying_count(int dim);

/// Neighbors to look for with this search: nearly all regions of a random sample are
/// certified by them where each query looks at all samples, and asking again is dear.
Index certifying_count(int dim, const NeighborSearch& search);

/// A weight per sample: 1e-7 times the squared distance to its nearest neighbor times a
/// hash of its position in [0, 1), or of its distances where it has none.
std::vector<double> tie_weights(const Samples& samples,
                                const Neighborhoods& neighborhoods,
                                const Execution& execution = {});

/// The simplices at a sample, K vertices each, ascending, the sample itself left out; rows
/// sorted. They are kept as places in its edge set, which are in the same order and take a
/// byte where that has no more than 256 members, as nearly all have.
class Star {
 public:
  /// Bytes of a place in an edge set of so many.
  static int width_of(Offset edges) {
    return edges <= 256 ? 1 : edges <= 65536 ? 2 : 4;
  }
  /// Appends rows of vertices that are members of the edge set.
  static void pack(const std::vector<Index>& rows, const Index* edge_set, Offset edges,
                   std::vector<std::uint8_t>& out);

  Star(const std::uint8_t* places, const Index* edge_set, Offset edges, Offset size,
       int dim)
      : places_(places),
        edge_set_(edge_set),
        edges_(edges),
        size_(size),
        dim_(dim),
        width_(width_of(edges)) {}

  Offset size() const { return size_; }
  Index vertex(Offset row, int i) const { return edge_set_[place(row, i)]; }
  /// Whether it has the simplex of these vertices, ascending.
  bool has(const Index* vertices) const;
  /// Appends all rows.
  void append_to(std::vector<Index>& rows) const;

 private:
  Offset place(Offset row, int i) const;

  const std::uint8_t* places_;
  const Index* edge_set_;
  Offset edges_;
  Offset size_;
  int dim_;
  int width_;
};

struct LocalRegions {
  int dim = 0;
  Csr edge_sets;                        ///< ES(x), ascending
  std::vector<Offset> star_offsets{0};  ///< simplices of all stars before
  std::vector<Offset> star_starts{0};   ///< the same in bytes of `stars`
  std::vector<std::uint8_t> stars;      ///< packed; to be read by star()
  std::vector<double> squared_radii;  ///< of LR(x); infinite where unbounded, NaN on BD
  Offset neighbors_used = 0;          ///< samples looked at by all regions together
  Offset vacuous_constraints = 0;     ///< samples straight above x: no constraint
  double coordinate_seconds = 0;      ///< thread time spent on coordinates

  Star star(Offset x) const {
    return {stars.data() + star_starts[x], edge_sets.begin(x), edge_sets.size(x),
            star_offsets[x + 1] - star_offsets[x], dim};
  }
};

LocalRegions compute_local_regions(const Samples& samples, const NeighborSearch& search,
                                   const Neighborhoods& neighborhoods,
                                   const TangentSpaces& tangents,
                                   const Execution& execution = {});

}  // namespace remanifold
