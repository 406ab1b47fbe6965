// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "options.hpp"
#include "run.hpp"

namespace remanifold::python {
namespace {

py::dict reconstruct_paper(const std::string& kind, const InputArray<double>& matrix,
                           int dim, Index num_neighbors, const std::string& estimator,
                           const std::string& edges, const std::string& search,
                           int checks, int num_threads, const py::object& progress) {
  ReconstructOptions options;
  options.tangent = {dim, num_neighbors, estimator_of(estimator)};
  options.search = search_options(search, checks);
  options.edges = edge_rule(edges);
  const MatrixView input = view(matrix);
  Reconstruction result = run(num_threads, progress, [&](const Execution& execution) {
    const Samples samples = make_samples(kind, input, execution);
    return reconstruct(samples, options, execution);
  });
  const py::ssize_t rows = matrix.shape(0);
  const auto star_count = static_cast<py::ssize_t>(result.stars.offsets.back());
  py::dict out;
  out["simplices"] = to_numpy(std::move(result.simplices));
  out["edges"] = to_numpy(std::move(result.edges));
  out["edge_set_offsets"] = to_numpy(std::move(result.edge_sets.offsets));
  out["edge_set_indices"] = to_numpy(std::move(result.edge_sets.indices));
  out["star_offsets"] = to_numpy(std::move(result.stars.offsets));
  out["star_simplices"] =
      to_numpy(std::move(result.stars.indices), {star_count, dim + 1});
  if (kind == "points") {
    out["tangents"] =
        to_numpy(std::move(result.tangents), {rows, dim, matrix.shape(1)});
  } else {
    out["tangents"] = py::none();
  }
  out["tangent_simplices"] =
      to_numpy(std::move(result.tangent_simplices), {rows, dim + 1});
  out["boundary"] = to_bool_array(std::move(result.boundary));
  out["unbounded"] = to_bool_array(std::move(result.unbounded));
  out["representatives"] = to_numpy(std::move(result.representatives));
  out["search"] = search_name(result.search);
  out["recall"] = result.recall;
  out["neighbors_used"] = result.neighbors_used;
  out["vacuous_constraints"] = result.vacuous_constraints;
  py::dict seconds;
  seconds["neighborhoods"] = result.seconds.neighborhoods;
  seconds["tangent_spaces"] = result.seconds.tangent_spaces;
  seconds["local_regions"] = result.seconds.local_regions;
  seconds["complex"] = result.seconds.complex;
  out["timings"] = seconds;
  return out;
}

}  // namespace

void bind_reconstruct(py::module_& module) {
  module.def("reconstruct_paper", &reconstruct_paper, py::arg("kind"),
             py::arg("matrix").noconvert(), py::arg("dim"), py::arg("num_neighbors"),
             py::arg("estimator"), py::arg("edges"), py::arg("search"),
             py::arg("checks"), py::arg("num_threads"), py::arg("progress"));
}

}  // namespace remanifold::python
