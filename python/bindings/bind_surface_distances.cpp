// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "remanifold/intrinsic_delaunay.hpp"
#include "remanifold/surface_distances.hpp"
#include "run.hpp"

#include <utility>
#include <vector>

namespace remanifold::python {
namespace {

py::array distances(const InputArray<Index>& triangles,
                    const InputArray<double>& lengths, Index num_vertices,
                    const InputArray<Index>& sources) {
  const SimplexArray surface{3, to_vector(triangles)};
  const std::vector<double> sides = to_vector(lengths);
  const std::vector<Index> starts = to_vector(sources);
  std::vector<double> result = run(1, py::none(), [&](const Execution& execution) {
    return surface_distances(surface, sides, num_vertices, starts, execution);
  });
  return to_numpy(std::move(result), {sources.shape(0), num_vertices});
}

py::tuple delaunay(const InputArray<Index>& triangles,
                   const InputArray<double>& lengths, bool both_sides) {
  const SimplexArray surface{3, to_vector(triangles)};
  const std::vector<double> sides = to_vector(lengths);
  IntrinsicTriangulation result = run(1, py::none(), [&](const Execution& execution) {
    return intrinsic_delaunay(surface, sides, both_sides, execution);
  });
  const auto count = static_cast<py::ssize_t>(result.triangles.size());
  return py::make_tuple(to_numpy(std::move(result.triangles)),
                        to_numpy(std::move(result.lengths), {count, 3}),
                        result.num_flips, result.complete);
}

}  // namespace

void bind_surface_distances(py::module_& module) {
  module.def("surface_distances", &distances, py::arg("triangles").noconvert(),
             py::arg("lengths").noconvert(), py::arg("num_vertices"),
             py::arg("sources").noconvert());
  module.def("intrinsic_delaunay", &delaunay, py::arg("triangles").noconvert(),
             py::arg("lengths").noconvert(), py::arg("both_sides") = false);
}

}  // namespace remanifold::python
