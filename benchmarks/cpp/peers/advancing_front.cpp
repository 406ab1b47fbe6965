// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's advancing front surface reconstruction, by its defaults.
#include "peers.hpp"

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <array>
#include <iterator>

namespace peers {

Result advancing_front(const Points& points) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  std::vector<Point> input;
  input.reserve(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    const double* p = &points.coordinates[3 * i];
    input.emplace_back(p[0], p[1], p[2]);
  }
  Result result;
  std::vector<std::array<std::size_t, 3>> facets;
  const Stopwatch stopwatch;
  CGAL::advancing_front_surface_reconstruction(input.begin(), input.end(),
                                               std::back_inserter(facets));
  stopwatch.stop(result);
  for (const auto& facet : facets) {
    for (const std::size_t vertex : facet) {
      result.simplices.push_back(static_cast<int>(vertex));
    }
  }
  return result;
}

}  // namespace peers
