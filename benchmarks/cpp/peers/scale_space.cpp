// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's scale space surface reconstruction as in its manual: four times smoothed, then
// meshed, by the defaults of the class.
#include "peers.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Scale_space_surface_reconstruction_3.h>
#include <CGAL/version.h>

namespace peers {

Result scale_space(const Points& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> input;
  input.reserve(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    const double* p = &points.coordinates[3 * i];
    input.emplace_back(p[0], p[1], p[2]);
  }
  Result result;
  const Stopwatch stopwatch;
  CGAL::Scale_space_surface_reconstruction_3<Kernel> reconstruction(input.begin(),
                                                                    input.end());
  reconstruction.increase_scale(4);
  reconstruction.reconstruct_surface();
  stopwatch.stop(result);
  for (auto it = reconstruction.facets_begin(); it != reconstruction.facets_end();
       ++it) {
    for (const std::size_t vertex : *it) {
      result.simplices.push_back(static_cast<int>(vertex));
    }
  }
  return result;
}

std::string cgal_version() { return CGAL_VERSION_STR; }

}  // namespace peers
