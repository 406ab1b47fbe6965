// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "options.hpp"
#include "program_solver.hpp"
#include "run.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <utility>
#include <vector>

namespace remanifold::python {
namespace {

py::dict timings(const StepSeconds& seconds) {
  py::dict out;
  out["neighborhoods"] = seconds.neighborhoods;
  out["cleaning"] = seconds.cleaning;
  out["tangent_spaces"] = seconds.tangent_spaces;
  out["local_regions"] = seconds.local_regions;
  out["complex"] = seconds.complex;
  return out;
}

/// The bases; or (coefficients, neighbors, scale), which tangent_bases() turns into them.
py::object tangents_of(std::vector<double>&& bases, TangentFrames&& frames,
                       py::ssize_t rows, py::ssize_t dim, py::ssize_t ambient_dim) {
  const py::ssize_t count = frames.num_coefficients;
  if (count == 0) {
    return to_numpy(std::move(bases), {rows, dim, ambient_dim});
  }
  return py::make_tuple(to_numpy(std::move(frames.coefficients), {rows, dim, count}),
                        to_numpy(std::move(frames.neighbors), {rows, count}),
                        frames.scale);
}

py::list openings_of(std::vector<Opening>&& openings) {
  py::list out;
  for (Opening& opening : openings) {
    py::dict one;
    one["kind"] = name_of(kOpeningKinds, opening.kind);
    one["open"] = opening.open;
    one["given"] = opening.given;
    one["simplices"] = to_numpy(std::move(opening.simplices));
    one["volume"] = opening.volume;
    one["spacing"] = opening.spacing;
    one["missing"] = opening.missing;
    one["dispersion"] = opening.dispersion;
    one["expected"] = opening.expected;
    one["significance"] = opening.significance();
    one["samples"] = to_numpy(std::move(opening.samples));
    out.append(std::move(one));
  }
  return out;
}

/// Samples, ascending, and whether the place that they surround is open.
using Decision = std::pair<std::vector<Index>, bool>;

/// None stands for the default of the method.
ReconstructOptions make_options(int dim, Index num_neighbors,
                                const std::optional<std::string>& estimator,
                                const std::string& edges, const std::string& boundary,
                                const std::optional<InputArray<bool>>& boundary_samples,
                                double hole_radius, double significance,
                                std::optional<double> outlier_distance, bool smooth,
                                Index smoothing_neighbors, bool only_noise,
                                const std::string& search, int checks,
                                const std::vector<Decision>& decisions) {
  ReconstructOptions options;
  options.dim = dim;
  options.num_neighbors = num_neighbors;
  if (estimator) {
    options.estimator = value_of(kEstimators, *estimator, "estimator");
  }
  options.edges = value_of(kEdgeRules, edges, "edges");
  options.manifold.boundary = value_of(kBoundaryRules, boundary, "boundary");
  if (boundary_samples) {
    options.manifold.boundary_samples.assign(
        boundary_samples->data(), boundary_samples->data() + boundary_samples->size());
  }
  options.manifold.hole_radius = hole_radius;
  options.manifold.significance = significance;
  options.outlier_distance = outlier_distance;
  options.smooth = smooth;
  options.smoothing.num_neighbors = smoothing_neighbors;
  options.smoothing.only_noise = only_noise;
  options.search = search_options(search, checks);
  for (const auto& [samples, open] : decisions) {
    options.manifold.decisions.push_back({samples, open});
  }
  return options;
}

py::dict to_dict(Cleaning&& cleaning, py::ssize_t ambient_dim) {
  py::dict out;
  out["outliers"] = to_numpy(std::move(cleaning.outliers));
  const auto rows =
      static_cast<py::ssize_t>(cleaning.displacements.size()) / ambient_dim;
  out["displacements"] =
      to_numpy(std::move(cleaning.displacements), {rows, ambient_dim});
  out["num_neighbors"] = cleaning.smoothing_neighbors;
  out["rounds"] = cleaning.smoothing_rounds;
  out["noise"] = cleaning.noise;
  out["prediction_error"] = cleaning.prediction_error;
  out["remaining_error"] = cleaning.remaining_error;
  out["drowned"] = cleaning.drowned;
  out["layers"] = cleaning.layers;
  out["growth"] = cleaning.growth;
  out["fitting_dim"] = cleaning.fitting_dim;
  out["resolution"] = cleaning.resolution;
  out["attached"] = to_numpy(std::move(cleaning.attached));
  return out;
}

py::dict clean_samples(const Input& input, const ReconstructOptions& options,
                       int num_threads, const py::object& progress) {
  return to_dict(run(num_threads, progress,
                     [&](const Execution& execution) {
                       return clean(input.samples(execution), options, execution);
                     }),
                 input.columns());
}

py::dict paper(const Input& input, const ReconstructOptions& options, int num_threads,
               const py::object& progress) {
  PaperReconstruction result =
      run(num_threads, progress, [&](const Execution& execution) {
        return reconstruct_paper(input.samples(execution), options, execution);
      });
  const int dim = options.dim;
  const py::ssize_t rows = input.rows();
  const auto star_count = static_cast<py::ssize_t>(result.stars.offsets.back());
  py::dict out;
  out["simplices"] = to_numpy(std::move(result.simplices));
  out["edges"] = to_numpy(std::move(result.edges));
  out["edge_set_offsets"] = to_numpy(std::move(result.edge_sets.offsets));
  out["edge_set_indices"] = to_numpy(std::move(result.edge_sets.indices));
  out["star_offsets"] = to_numpy(std::move(result.stars.offsets));
  out["star_simplices"] =
      to_numpy(std::move(result.stars.indices), {star_count, dim + 1});
  if (input.points()) {
    out["tangents"] = tangents_of(std::move(result.tangents), std::move(result.frames),
                                  rows, dim, input.columns());
  } else {
    out["tangents"] = py::none();
  }
  out["tangent_simplices"] =
      to_numpy(std::move(result.tangent_simplices), {rows, dim + 1});
  out["boundary"] = to_bool_array(std::move(result.boundary));
  out["unbounded"] = to_bool_array(std::move(result.unbounded));
  out["representatives"] = to_numpy(std::move(result.representatives));
  out["search"] = name_of(kSearches, result.search);
  out["recall"] = result.recall;
  out["neighbors_used"] = result.neighbors_used;
  out["vacuous_constraints"] = result.vacuous_constraints;
  out["cleaning"] = to_dict(std::move(result.cleaning), input.columns());
  out["timings"] = timings(result.seconds);
  return out;
}

/// Samples here, and points elsewhere.
using OpenElsewhere = std::pair<std::vector<Index>, InputArray<double>>;

py::dict to_dict(PartReport&& part) {
  py::dict out;
  out["agreed_orientable"] = part.agreed_orientable;
  out["sharp_folds"] = to_numpy(std::move(part.sharp_folds));
  out["stretched"] = to_numpy(std::move(part.stretched));
  for (const auto& [name, lists] :
       {std::pair{"opened", &part.opened}, std::pair{"unmended", &part.unmended}}) {
    py::list arrays;
    for (std::vector<Index>& list : *lists) {
      arrays.append(to_numpy(std::move(list)));
    }
    out[name] = arrays;
  }
  out["order"] = to_numpy(std::move(part.order));
  return out;
}

py::dict manifold(const Input& input, const ReconstructOptions& given,
                  const py::object& solve, const py::object& on_other_dim,
                  const std::optional<GlobalStatistics>& whole,
                  const std::optional<OpenElsewhere>& open_region, int num_threads,
                  const py::object& progress) {
  ReconstructOptions options = given;
  if (open_region) {
    const auto& [here, points] = *open_region;
    options.manifold.open_region =
        OpenRegion{here, {points.data(), points.data() + points.size()}};
  }
  if (!on_other_dim.is_none()) {
    options.on_other_dim = [function = on_other_dim.ptr()](int dim) {
      const py::gil_scoped_acquire acquire;
      const py::handle call(function);
      call(dim);
    };
  }
  Reconstruction result = run(num_threads, progress, [&](const Execution& execution) {
    return reconstruct(whole ? input.part(*whole, execution) : input.samples(execution),
                       options, program_solver(solve, execution), execution);
  });
  const int dim = options.dim;
  py::dict out;
  out["simplices"] = to_numpy(std::move(result.simplices));
  if (input.points()) {
    out["tangents"] = tangents_of(std::move(result.tangents), std::move(result.frames),
                                  input.rows(), dim, input.columns());
  } else {
    out["tangents"] = py::none();
  }
  out["boundary"] = to_bool_array(std::move(result.boundary));
  out["representatives"] = to_numpy(std::move(result.representatives));
  out["search"] = name_of(kSearches, result.search);
  out["recall"] = result.recall;
  ManifoldReport& report = result.report;
  py::dict repair;
  repair["disputed_simplices"] = to_numpy(std::move(report.disputed));
  repair["filled_simplices"] = to_numpy(std::move(report.filled));
  repair["open_faces"] = to_numpy(std::move(report.open_facets));
  repair["callous_faces"] = to_numpy(std::move(report.branching_facets));
  repair["singular_vertices"] = to_numpy(std::move(report.singular));
  repair["inserted_vertices"] = to_numpy(std::move(report.inserted));
  repair["cut_vertices"] = to_numpy(std::move(report.cut_vertices));
  repair["unused_vertices"] = to_numpy(std::move(report.outliers));
  repair["hole_radius"] = report.hole_radius;
  repair["hole_size"] = report.hole_size;
  out["openings"] = openings_of(std::move(report.openings));
  repair["num_agreed"] = report.agreed;
  repair["num_cavities"] = report.cavities;
  repair["num_cut_cavities"] = report.cut;
  repair["num_programs"] = report.programs;
  repair["num_integer_programs"] = report.integer_programs;
  repair["largest_program"] = report.largest_program;
  repair["num_unsolved"] = report.unsolved;
  out["repair"] = repair;
  out["cleaning"] = to_dict(std::move(result.cleaning), input.columns());
  out["timings"] = timings(result.seconds);
  if (whole) {
    out["part"] = to_dict(std::move(result.part));
    out["part"]["open_region"] = to_numpy(std::move(result.open_region));
  }
  return out;
}

}  // namespace

void bind_reconstruct(py::module_& module) {
  using py::arg;
  const ReconstructOptions defaults;
  py::class_<ReconstructOptions>(module, "Options")
      .def(py::init(&make_options), py::kw_only(), arg("dim"),
           arg("num_neighbors") = defaults.num_neighbors, arg("estimator") = py::none(),
           arg("edges") = name_of(kEdgeRules, defaults.edges),
           arg("boundary") = name_of(kBoundaryRules, defaults.manifold.boundary),
           arg("boundary_samples") = py::none(),
           arg("hole_radius") = defaults.manifold.hole_radius,
           arg("significance") = defaults.manifold.significance,
           arg("outlier_distance") = py::none(), arg("smooth") = defaults.smooth,
           arg("smoothing_neighbors") = defaults.smoothing.num_neighbors,
           arg("only_noise") = defaults.smoothing.only_noise,
           arg("search") = name_of(kSearches, defaults.search.method),
           arg("checks") = defaults.search.checks,
           arg("decisions") = std::vector<Decision>{});
  module.def("clean", &clean_samples, arg("samples"), arg("options"), py::kw_only(),
             arg("num_threads"), arg("progress"));
  module.def("reconstruct", &manifold, arg("samples"), arg("options"), py::kw_only(),
             arg("solve"), arg("on_other_dim"), arg("whole") = py::none(),
             arg("open_region") = py::none(), arg("num_threads"), arg("progress"));
  module.def("reconstruct_paper", &paper, arg("samples"), arg("options"), py::kw_only(),
             arg("num_threads"), arg("progress"));
}

}  // namespace remanifold::python
