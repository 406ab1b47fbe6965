// SPDX-License-Identifier: GPL-3.0-or-later
// Each step on its own, in the caller's numbering of the samples.
#include "arrays.hpp"
#include "options.hpp"
#include "run.hpp"

#include <cmath>
#include <limits>

namespace remanifold::python {
namespace {

py::tuple neighborhoods(const Input& input, Index num_neighbors,
                        const std::string& search, int checks, int num_threads,
                        const py::object& progress) {
  struct Result {
    Index count = 0;
    std::vector<Index> indices;
    std::vector<double> distances;
    SearchMethod method = SearchMethod::kAuto;
    double recall = 1.0;
  };
  const SearchOptions options = search_options(search, checks);
  Result result = run(num_threads, progress, [&](const Execution& execution) {
    const Samples samples = input.samples(execution);
    const NeighborSearch index(samples, options, execution);
    const Neighborhoods found =
        find_neighborhoods(samples, index, num_neighbors, execution);
    const std::vector<Index> canonical = samples.canonical_indices();
    Result out;
    out.count = found.count;
    out.indices.reserve(canonical.size() * found.count);
    out.distances.reserve(canonical.size() * found.count);
    for (const Index i : canonical) {
      for (Index k = 0; k < found.count; ++k) {
        const Index j = found.of(i)[k];
        out.indices.push_back(samples.input_index(j));
        out.distances.push_back(std::sqrt(samples.squared_distance(i, j)) *
                                samples.scale());
      }
    }
    out.method = index.method();
    if (out.method == SearchMethod::kApproximate) {
      out.recall =
          measure_recall(samples, index, num_neighbors, kRecallQueries, execution);
    }
    return out;
  });
  const py::ssize_t rows = input.rows();
  const py::ssize_t columns = result.count;
  return py::make_tuple(to_numpy(std::move(result.indices), {rows, columns}),
                        to_numpy(std::move(result.distances), {rows, columns}),
                        name_of(kSearches, result.method), result.recall);
}

py::tuple tangent_spaces(const Input& input, int dim, Index num_neighbors,
                         const std::string& estimator, const std::string& search,
                         int checks, int num_threads, const py::object& progress) {
  const TangentOptions tangent{dim, num_neighbors,
                               value_of(kEstimators, estimator, "estimator")};
  const SearchOptions options = search_options(search, checks);
  TangentSpaces result = run(num_threads, progress, [&](const Execution& execution) {
    const Samples samples = input.samples(execution);
    const NeighborSearch index(samples, options, execution);
    const Neighborhoods found =
        find_neighborhoods(samples, index, num_neighbors, execution);
    TangentSpaces out =
        to_input(samples, compute_tangent_spaces(samples, found, tangent, execution));
    if (!out.neighbors.empty()) {
      out.bases = tangent_bases(input.view(), dim, out.coefficients.data(),
                                out.neighbors.data(), out.num_coefficients,
                                samples.scale(), execution);
    }
    return out;
  });
  const py::ssize_t rows = input.rows();
  py::object bases = py::none();
  if (input.points()) {
    bases = to_numpy(std::move(result.bases), {rows, dim, input.columns()});
  }
  return py::make_tuple(bases, to_numpy(std::move(result.simplices), {rows, dim + 1}),
                        to_bool_array(std::move(result.boundary)));
}

py::array bases_of(const InputArray<double>& points,
                   const InputArray<double>& coefficients,
                   const InputArray<Index>& neighbors, double scale, int num_threads,
                   const py::object& progress) {
  const MatrixView input = view(points);
  const auto dim = static_cast<int>(coefficients.shape(1));
  const auto count = static_cast<Index>(coefficients.shape(2));
  const double* values = coefficients.data();
  const Index* indices = neighbors.data();
  return to_numpy(run(num_threads, progress,
                      [&](const Execution& execution) {
                        return tangent_bases(input, dim, values, indices, count, scale,
                                             execution);
                      }),
                  {points.shape(0), dim, points.shape(1)});
}

py::tuple local_regions(const InputArray<double>& points,
                        const InputArray<double>& bases,
                        const InputArray<bool>& boundary, const std::string& search,
                        int checks, int num_threads, const py::object& progress) {
  struct Result {
    Csr edge_sets;
    Csr stars;
    std::vector<double> radii;
  };
  const SearchOptions options = search_options(search, checks);
  const MatrixView input = view(points);
  const auto dim = static_cast<int>(bases.shape(1));
  const auto size = static_cast<std::size_t>(dim) * input.cols;
  const double* given = bases.data();
  const bool* excluded = boundary.data();
  Result result = run(num_threads, progress, [&](const Execution& execution) {
    const Samples samples = Samples::from_points(input, execution);
    const NeighborSearch index(samples, options, execution);
    const Neighborhoods found =
        find_neighborhoods(samples, index, certifying_count(dim, index), execution);
    TangentSpaces tangents;
    tangents.dim = dim;
    tangents.bases.resize(samples.size() * size);
    tangents.boundary.resize(samples.size());
    for (Index i = 0; i < samples.size(); ++i) {
      const Index from = samples.input_index(i);
      std::copy_n(given + from * size, size, tangents.bases.data() + i * size);
      tangents.boundary[i] = excluded[from] ? 1 : 0;
    }
    const LocalRegions regions =
        compute_local_regions(samples, index, found, tangents, execution);
    Result out;
    out.edge_sets = edge_sets_to_input(samples, regions, execution);
    out.stars = stars_to_input(samples, regions, execution);
    for (const Index i : samples.canonical_indices()) {
      out.radii.push_back(std::sqrt(regions.squared_radii[i]) * samples.scale());
    }
    return out;
  });
  const auto star_count = static_cast<py::ssize_t>(result.stars.offsets.back());
  return py::make_tuple(
      to_numpy(std::move(result.edge_sets.offsets)),
      to_numpy(std::move(result.edge_sets.indices)),
      to_numpy(std::move(result.stars.offsets)),
      to_numpy(std::move(result.stars.indices), {star_count, dim + 1}),
      to_numpy(std::move(result.radii)));
}

py::array cliques(const InputArray<Offset>& offsets, const InputArray<Index>& indices,
                  int dim, const std::string& edges, int num_threads,
                  const py::object& progress) {
  const EdgeRule rule = value_of(kEdgeRules, edges, "edges");
  const Csr edge_sets{to_vector(offsets), to_vector(indices)};
  return to_numpy(run(num_threads, progress, [&](const Execution& execution) {
    return clique_complex(edge_graph(edge_sets, rule, execution), dim, execution);
  }));
}

}  // namespace

void bind_steps(py::module_& module) {
  using py::arg;
  module.def("neighborhoods", &neighborhoods, arg("samples"), py::kw_only(),
             arg("num_neighbors"), arg("search"), arg("checks"), arg("num_threads"),
             arg("progress"));
  module.def("tangent_spaces", &tangent_spaces, arg("samples"), py::kw_only(),
             arg("dim"), arg("num_neighbors"), arg("estimator"), arg("search"),
             arg("checks"), arg("num_threads"), arg("progress"));
  module.def("tangent_bases", &bases_of, arg("points").noconvert(),
             arg("coefficients").noconvert(), arg("neighbors").noconvert(),
             arg("scale"), py::kw_only(), arg("num_threads"), arg("progress"));
  module.def("local_regions", &local_regions, arg("points").noconvert(),
             arg("bases").noconvert(), arg("boundary").noconvert(), py::kw_only(),
             arg("search"), arg("checks"), arg("num_threads"), arg("progress"));
  module.def("clique_complex", &cliques, arg("offsets").noconvert(),
             arg("indices").noconvert(), py::kw_only(), arg("dim"), arg("edges"),
             arg("num_threads"), arg("progress"));
}

}  // namespace remanifold::python
