// SPDX-License-Identifier: GPL-3.0-or-later
// Incremental convex hull of the origin and points in R^K, decided by CGAL's exact
// predicates on the coordinates as given. One implementation a dimension and a file, so
// that no other file pays for CGAL's headers.
#pragma once

#include <memory>
#include <vector>

#include "remanifold/types.hpp"

namespace remanifold::detail {

class ConvexHull {
 public:
  static constexpr Index kOrigin = -1;

  virtual ~ConvexHull() = default;
  /// Back to the origin alone.
  virtual void clear() = 0;
  /// Points may repeat, and may lie inside.
  virtual void insert(const double* point, Index id) = 0;
  /// Brings the members below up to date with the points inserted.
  virtual void update() = 0;

  /// False while the points and the origin lie in a hyperplane; then there are no facets.
  bool full_dimensional() const { return full_dimensional_; }
  /// K ids a facet.
  const std::vector<Index>& facets() const { return facets_; }
  /// Ids of the extreme points, without the origin.
  const std::vector<Index>& vertices() const { return vertices_; }

 protected:
  bool full_dimensional_ = false;
  std::vector<Index> facets_;
  std::vector<Index> vertices_;
};

std::unique_ptr<ConvexHull> make_convex_hull(int dim);
std::unique_ptr<ConvexHull> make_convex_hull_2();
std::unique_ptr<ConvexHull> make_convex_hull_3();
std::unique_ptr<ConvexHull> make_convex_hull_d(int dim);

}  // namespace remanifold::detail
