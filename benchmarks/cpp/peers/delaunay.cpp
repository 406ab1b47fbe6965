// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's Delaunay triangulation of R^3, which sorts the points along a curve first: what
// cells of samples of a solid, K = D = 3, are to be compared with.
#include "peers.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <utility>

namespace peers {

Result delaunay(const Points& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Structure = CGAL::Triangulation_data_structure_3<
      CGAL::Triangulation_vertex_base_with_info_3<int, Kernel>,
      CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
  std::vector<std::pair<Kernel::Point_3, int>> input;
  input.reserve(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    const double* p = &points.coordinates[3 * i];
    input.emplace_back(Kernel::Point_3(p[0], p[1], p[2]), static_cast<int>(i));
  }
  Result result;
  const Stopwatch stopwatch;
  const CGAL::Delaunay_triangulation_3<Kernel, Structure> triangulation(input.begin(),
                                                                        input.end());
  stopwatch.stop(result);
  for (const auto& cell : triangulation.finite_cell_handles()) {
    for (int i = 0; i < 4; ++i) {
      result.simplices.push_back(cell->vertex(i)->info());
    }
  }
  return result;
}

}  // namespace peers
