// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "remanifold/remanifold.hpp"
#include "run.hpp"

#include <algorithm>

namespace remanifold::python {
namespace {

SimplexArray simplex_array(const InputArray<Index>& array) {
  return {static_cast<int>(array.shape(1)), to_vector(array)};
}

py::dict topology(const InputArray<Index>& simplices, Index num_vertices,
                  int num_threads, const py::object& progress) {
  const SimplexArray complex = simplex_array(simplices);
  Topology result = run(num_threads, progress, [&](const Execution& execution) {
    return compute_topology(complex, num_vertices, execution);
  });
  py::dict out;
  out["face_counts"] = to_numpy(std::move(result.face_counts));
  out["euler_characteristic"] = result.euler_characteristic;
  out["components"] = result.components;
  out["coface_counts"] = to_numpy(std::move(result.coface_counts));
  out["pseudomanifold"] = result.pseudomanifold;
  out["boundary_components"] = result.boundary_components;
  out["closed"] = result.closed;
  out["orientable"] = result.orientable;
  out["closed_patches"] = result.closed_patches;
  out["closed_orientable_patches"] = result.closed_orientable_patches;
  out["singular_vertices"] = to_numpy(std::move(result.singular_vertices));
  out["undecided_vertices"] = to_numpy(std::move(result.undecided_vertices));
  return out;
}

py::array component_labels(const InputArray<Index>& simplices, Index num_vertices) {
  return to_numpy(connected_components(simplex_array(simplices), num_vertices).labels);
}

py::array edges(const InputArray<Index>& simplices, Index num_vertices) {
  return to_numpy(edges_of(simplex_array(simplices), num_vertices));
}

/// The connected set each face belongs to, as in OpenFaces.
py::array face_sets(const InputArray<Index>& faces) {
  Faces open{simplex_array(faces), {}};
  open.cofaces.assign(open.simplices.size(), 1);
  const Index largest = open.simplices.vertices.empty()
                            ? 0
                            : *std::max_element(open.simplices.vertices.begin(),
                                                open.simplices.vertices.end());
  OpenFaces sets = find_open_faces(open, std::vector<std::uint8_t>(largest + 1, 0));
  return to_numpy(std::move(sets.set));
}

py::dict report(const InputArray<Index>& simplices,
                const InputArray<Offset>& edge_set_offsets,
                const InputArray<Index>& edge_set_indices,
                const InputArray<Offset>& star_offsets,
                const InputArray<Index>& star_simplices,
                const InputArray<bool>& boundary, int num_threads,
                const py::object& progress) {
  const SimplexArray complex = simplex_array(simplices);
  const Csr edge_sets{to_vector(edge_set_offsets), to_vector(edge_set_indices)};
  const Csr stars{to_vector(star_offsets), to_vector(star_simplices)};
  const std::vector<std::uint8_t> marked(boundary.data(),
                                         boundary.data() + boundary.size());
  PaperReport result = run(num_threads, progress, [&](const Execution& execution) {
    return paper_report(complex, edge_sets, stars, marked, execution);
  });
  py::dict out;
  out["callous_faces"] = to_numpy(std::move(result.callous_faces));
  out["unstarred_simplices"] = to_numpy(std::move(result.unstarred_simplices));
  out["open_faces"] = to_numpy(std::move(result.open_faces));
  out["hole_faces"] = to_numpy(std::move(result.hole_faces));
  out["num_holes"] = result.num_holes;
  out["num_boundary_components"] = result.num_boundary_components;
  return out;
}

}  // namespace

void bind_topology(py::module_& module) {
  module.def("topology", &topology, py::arg("simplices").noconvert(),
             py::arg("num_vertices"), py::arg("num_threads"), py::arg("progress"));
  module.def("component_labels", &component_labels, py::arg("simplices").noconvert(),
             py::arg("num_vertices"));
  module.def("edges", &edges, py::arg("simplices").noconvert(),
             py::arg("num_vertices"));
  module.def("face_sets", &face_sets, py::arg("faces").noconvert());
  module.def(
      "paper_report", &report, py::arg("simplices").noconvert(),
      py::arg("edge_set_offsets").noconvert(), py::arg("edge_set_indices").noconvert(),
      py::arg("star_offsets").noconvert(), py::arg("star_simplices").noconvert(),
      py::arg("boundary").noconvert(), py::arg("num_threads"), py::arg("progress"));
}

}  // namespace remanifold::python
