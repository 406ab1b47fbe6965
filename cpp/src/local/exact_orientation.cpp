// SPDX-License-Identifier: GPL-3.0-or-later
// Exact signs of orientation by CGAL, in a file of their own: its headers take the compiler
// longer than the hulls that ask for them.
#include "local/convex_hull.hpp"

#include <CGAL/Epick_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <vector>

namespace remanifold::detail {

int exact_orientation(int dim, const double* const* points) {
  const auto& p = points;
  if (dim == 2) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
    return static_cast<int>(CGAL::orientation(
        Point(p[0][0], p[0][1]), Point(p[1][0], p[1][1]), Point(p[2][0], p[2][1])));
  }
  if (dim == 3) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
    return static_cast<int>(CGAL::orientation(
        Point(p[0][0], p[0][1], p[0][2]), Point(p[1][0], p[1][1], p[1][2]),
        Point(p[2][0], p[2][1], p[2][2]), Point(p[3][0], p[3][1], p[3][2])));
  }
  using Kernel = CGAL::Epick_d<CGAL::Dynamic_dimension_tag>;
  std::vector<Kernel::Point_d> all;
  all.reserve(dim + 1);
  for (int i = 0; i <= dim; ++i) {
    all.emplace_back(dim, p[i], p[i] + dim);
  }
  return static_cast<int>(Kernel(dim).orientation_d_object()(all.begin(), all.end()));
}

}  // namespace remanifold::detail
