// SPDX-License-Identifier: GPL-3.0-or-later
// Incremental convex hull of points around the origin of R^K, decided by CGAL's exact
// predicates on the coordinates as given. One implementation a dimension and a file, so
// that no other file pays for CGAL's headers.
//
// The hull starts as a tiny simplex around the origin, whose vertices have the ids
// -1 .. -(K+1). It stands for the origin: a facet with a negative id is a direction in
// which the dual region has no end. The origin alone would leave it to rounding whether
// points on a common ray, as all rows of a grid are, count as extreme.
#pragma once

#include "remanifold/types.hpp"

#include <memory>
#include <vector>

namespace remanifold::detail {

class ConvexHull {
 public:
  virtual ~ConvexHull() = default;

  /// Coordinate `axis` of vertex `which` (0 .. K) of the simplex at the start: the unit
  /// vectors and minus their sum.
  static double start_coordinate(int dim, int which, int axis) {
    return which == dim ? -1.0 : which == axis ? 1.0 : 0.0;
  }
  static bool is_start(Index id) { return id < 0; }
  static Index start_id(int which) { return -1 - which; }
  static int start_vertex(Index id) { return -1 - id; }

  /// Back to the simplex at the start, scaled by `size`.
  void restart(int dim, double size) {
    clear();
    facets_.clear();
    vertices_.clear();
    std::vector<double>& point = start_point_;
    for (int which = 0; which <= dim; ++which) {
      point.clear();
      for (int axis = 0; axis < dim; ++axis) {
        point.push_back(size * start_coordinate(dim, which, axis));
      }
      insert(point.data(), start_id(which));
    }
  }
  /// Points may repeat, and may lie inside.
  virtual void insert(const double* point, Index id) = 0;
  /// Brings the members below up to date with the points inserted.
  virtual void update() = 0;

  /// K ids a facet.
  const std::vector<Index>& facets() const { return facets_; }
  /// Ids of the extreme points, without those of the start.
  const std::vector<Index>& vertices() const { return vertices_; }

 protected:
  virtual void clear() = 0;

  std::vector<Index> facets_;
  std::vector<Index> vertices_;

 private:
  std::vector<double> start_point_;
};

/// K = 2 has a hull of its own, in convex_hull_2.hpp.
std::unique_ptr<ConvexHull> make_convex_hull(int dim);
std::unique_ptr<ConvexHull> make_convex_hull_3();
std::unique_ptr<ConvexHull> make_convex_hull_d(int dim);

}  // namespace remanifold::detail
