// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/convex_hull_2.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace remanifold::detail {

int exact_orientation(PlanePoint a, PlanePoint b, PlanePoint c) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  return static_cast<int>(
      CGAL::orientation(Point(a.x, a.y), Point(b.x, b.y), Point(c.x, c.y)));
}

}  // namespace remanifold::detail
