// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "options.hpp"
#include "run.hpp"

#include <algorithm>
#include <utility>

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

/// \param outlier_distance  0 keeps all samples
/// \param smoothing  -1: none, 0: by cross-validation, or neighbors
/// \param only_noise  leaves samples without noise alone
void set_cleaning(double outlier_distance, Index smoothing, bool only_noise,
                  ReconstructOptions& options) {
  options.outlier_distance = outlier_distance;
  options.smooth = smoothing >= 0;
  options.smoothing.num_neighbors = std::max<Index>(0, smoothing);
  options.smoothing.only_noise = only_noise;
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
  return out;
}

py::dict clean_samples(const std::string& kind, const InputArray<double>& matrix,
                       int dim, double outlier_distance, Index smoothing,
                       bool only_noise, const std::string& search, int checks,
                       int num_threads, const py::object& progress) {
  ReconstructOptions options;
  options.tangent.dim = dim;
  options.search = search_options(search, checks);
  set_cleaning(outlier_distance, smoothing, only_noise, options);
  const MatrixView input = view(matrix);
  return to_dict(run(num_threads, progress,
                     [&](const Execution& execution) {
                       const Samples samples = make_samples(kind, input, execution);
                       return clean(samples, options, execution);
                     }),
                 matrix.shape(1));
}

py::dict reconstruct_paper(const std::string& kind, const InputArray<double>& matrix,
                           int dim, Index num_neighbors, const std::string& estimator,
                           const std::string& edges, double outlier_distance,
                           Index smoothing, bool only_noise, const std::string& search,
                           int checks, int num_threads, const py::object& progress) {
  ReconstructOptions options;
  options.tangent = {dim, num_neighbors, estimator_of(estimator)};
  options.search = search_options(search, checks);
  set_cleaning(outlier_distance, smoothing, only_noise, options);
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
    out["tangents"] = tangents_of(std::move(result.tangents), std::move(result.frames),
                                  rows, dim, matrix.shape(1));
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
  out["cleaning"] = to_dict(std::move(result.cleaning), matrix.shape(1));
  out["timings"] = timings(result.seconds);
  return out;
}

/// A Python function of the program's arrays and a function that says whether to stop;
/// returns x, or an empty array.
ProgramSolver program_solver(const py::object& function, const Execution& execution) {
  if (function.is_none()) {
    return {};
  }
  return [function = function.ptr(), &execution](const LinearProgram& program) {
    const auto copy = [](const auto& values) {
      using T = typename std::decay_t<decltype(values)>::value_type;
      return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
    };
    std::vector<double> x;
    {
      const py::gil_scoped_acquire acquire;
      const py::cpp_function cancelled([&execution] {
        return execution.progress != nullptr && execution.progress->cancel.load();
      });
      const py::object result = py::handle(function)(
          copy(program.costs), copy(program.upper), copy(program.integral),
          copy(program.row_lower), copy(program.row_upper), copy(program.offsets),
          copy(program.columns), copy(program.values), cancelled);
      x = to_vector(py::cast<InputArray<double>>(result));
    }
    execution.poll();
    return x;
  };
}

py::dict reconstruct_with_chain(
    const std::string& kind, const InputArray<double>& matrix, int dim,
    Index num_neighbors, const std::string& estimator, const std::string& boundary,
    const InputArray<bool>& boundary_samples, double hole_radius,
    double outlier_distance, Index smoothing, bool only_noise,
    const std::string& search, int checks, const py::object& solve, int num_threads,
    const py::object& progress) {
  ReconstructOptions options;
  options.tangent = {dim, num_neighbors, estimator_of(estimator)};
  options.search = search_options(search, checks);
  set_cleaning(outlier_distance, smoothing, only_noise, options);
  ManifoldOptions manifold;
  manifold.boundary = boundary_rule(boundary);
  manifold.boundary_samples.assign(boundary_samples.data(),
                                   boundary_samples.data() + boundary_samples.size());
  manifold.hole_radius = hole_radius;
  const MatrixView input = view(matrix);
  ManifoldReconstruction result =
      run(num_threads, progress, [&](const Execution& execution) {
        const Samples samples = make_samples(kind, input, execution);
        return reconstruct_manifold(samples, options, manifold,
                                    program_solver(solve, execution), execution);
      });
  py::dict out;
  out["simplices"] = to_numpy(std::move(result.simplices));
  if (kind == "points") {
    out["tangents"] = tangents_of(std::move(result.tangents), std::move(result.frames),
                                  matrix.shape(0), dim, matrix.shape(1));
  } else {
    out["tangents"] = py::none();
  }
  out["boundary"] = to_bool_array(std::move(result.boundary));
  out["representatives"] = to_numpy(std::move(result.representatives));
  out["search"] = search_name(result.search);
  out["recall"] = result.recall;
  ManifoldReport& report = result.report;
  py::dict repair;
  repair["disputed_simplices"] = to_numpy(std::move(report.disputed));
  repair["filled_simplices"] = to_numpy(std::move(report.filled));
  repair["open_faces"] = to_numpy(std::move(report.open_facets));
  repair["callous_faces"] = to_numpy(std::move(report.branching_facets));
  repair["singular_vertices"] = to_numpy(std::move(report.singular));
  repair["inserted_vertices"] = to_numpy(std::move(report.inserted));
  repair["unused_vertices"] = to_numpy(std::move(report.outliers));
  repair["hole_radius"] = report.hole_radius;
  repair["num_agreed"] = report.agreed;
  repair["num_cavities"] = report.cavities;
  repair["num_programs"] = report.programs;
  repair["num_integer_programs"] = report.integer_programs;
  repair["num_unsolved"] = report.unsolved;
  out["repair"] = repair;
  out["cleaning"] = to_dict(std::move(result.cleaning), matrix.shape(1));
  out["timings"] = timings(result.seconds);
  return out;
}

}  // namespace

void bind_reconstruct(py::module_& module) {
  module.def("clean", &clean_samples, py::arg("kind"), py::arg("matrix").noconvert(),
             py::arg("dim"), py::arg("outlier_distance"), py::arg("smoothing"),
             py::arg("only_noise"), py::arg("search"), py::arg("checks"),
             py::arg("num_threads"), py::arg("progress"));
  module.def("reconstruct_paper", &reconstruct_paper, py::arg("kind"),
             py::arg("matrix").noconvert(), py::arg("dim"), py::arg("num_neighbors"),
             py::arg("estimator"), py::arg("edges"), py::arg("outlier_distance"),
             py::arg("smoothing"), py::arg("only_noise"), py::arg("search"),
             py::arg("checks"), py::arg("num_threads"), py::arg("progress"));
  module.def("reconstruct_manifold", &reconstruct_with_chain, py::arg("kind"),
             py::arg("matrix").noconvert(), py::arg("dim"), py::arg("num_neighbors"),
             py::arg("estimator"), py::arg("boundary"),
             py::arg("boundary_samples").noconvert(), py::arg("hole_radius"),
             py::arg("outlier_distance"), py::arg("smoothing"), py::arg("only_noise"),
             py::arg("search"), py::arg("checks"), py::arg("solve"),
             py::arg("num_threads"), py::arg("progress"));
}

}  // namespace remanifold::python
