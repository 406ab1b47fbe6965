// SPDX-License-Identifier: GPL-3.0-or-later
// The chain alone: cavities that given simplices leave, filled with given candidates.
#include "arrays.hpp"
#include "program_solver.hpp"
#include "remanifold/cavities.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/manifold_complex.hpp"
#include "remanifold/minimum_chain.hpp"
#include "remanifold/neighborhoods.hpp"
#include "run.hpp"

namespace remanifold::python {
namespace {

SimplexArray rows_of(const InputArray<Index>& simplices) {
  SimplexArray rows;
  rows.arity = static_cast<int>(simplices.shape(1));
  rows.vertices = to_vector(simplices);
  return rows;
}

/// What the cavities are is returned as well, so that others can say what is best.
py::dict fill(const InputArray<double>& points, const InputArray<Index>& fixed,
              const InputArray<Index>& candidates, double hole_radius,
              const ChainOptions& options, const py::object& solve, int num_threads,
              const py::object& progress) {
  struct Result {
    Cavities cavities;
    ChainFill chain;
  };
  Result result = run(num_threads, progress, [&](const Execution& execution) {
    const Samples samples = Samples::from_points(view(points), execution);
    const SimplexArray given = to_canonical(samples, rows_of(fixed));
    const int dim = given.arity - 1;
    const NeighborSearch index(samples, {}, execution);
    const std::vector<double> scales = local_scales(
        samples, find_neighborhoods(samples, index, scale_neighbors(dim), execution),
        dim, execution);
    SimplexRuler ruler(samples, scales);
    const FacetPrice price = [&](const Index* facet) {
      return open_price(dim, hole_radius) * ruler.facet_size(facet, dim);
    };
    Result out;
    out.cavities = find_cavities(given, std::vector<std::uint8_t>(samples.size(), 1),
                                 to_canonical(samples, rows_of(candidates)), ruler,
                                 price, false, execution);
    out.chain = fill_cavities(out.cavities, given, samples.size(), options,
                              program_solver(solve, execution), execution);
    for (Index& v : out.cavities.candidates.vertices) {
      v = samples.input_index(v);
    }
    return out;
  });
  const py::ssize_t arity = result.cavities.candidates.arity;
  const py::ssize_t rows = result.cavities.candidates.size();
  py::dict out;
  out["candidates"] = to_numpy(std::move(result.cavities.candidates));
  out["energies"] = to_numpy(std::move(result.cavities.energies));
  out["facets"] = to_numpy(std::move(result.cavities.facets_of), {rows, arity});
  out["prices"] = to_numpy(std::move(result.cavities.prices));
  out["rims"] = to_numpy(std::move(result.cavities.rims));
  out["chosen"] = to_numpy(std::move(result.chain.chosen));
  out["num_cavities"] = result.cavities.count();
  out["num_searched"] = result.chain.searched;
  out["num_cut"] = result.chain.cut;
  out["num_programs"] = result.chain.programs;
  out["num_integer_programs"] = result.chain.integer_programs;
  out["num_refills"] = result.chain.refills;
  out["num_refilled"] = result.chain.refilled;
  out["largest_program"] = result.chain.largest_program;
  out["num_unsolved"] = result.chain.unsolved;
  return out;
}

}  // namespace

void bind_chain(py::module_& module) {
  using py::arg;
  const ChainOptions defaults;
  module.def(
      "fill_cavities",
      [](const InputArray<double>& points, const InputArray<Index>& fixed,
         const InputArray<Index>& candidates, double hole_radius,
         Index search_candidates, bool search_oriented, Index largest_program,
         Index window, Index refill, const py::object& solve, int num_threads,
         const py::object& progress) {
        ChainOptions options;
        options.search_candidates = search_candidates;
        options.search_oriented = search_oriented;
        options.largest_program = largest_program;
        options.window = window;
        options.refill = refill;
        return fill(points, fixed, candidates, hole_radius, options, solve, num_threads,
                    progress);
      },
      arg("points").noconvert(), arg("fixed").noconvert(),
      arg("candidates").noconvert(), py::kw_only(), arg("hole_radius"),
      arg("search_candidates") = defaults.search_candidates,
      arg("search_oriented") = defaults.search_oriented,
      arg("largest_program") = defaults.largest_program,
      arg("window") = defaults.window, arg("refill") = defaults.refill, arg("solve"),
      arg("num_threads"), arg("progress"));
}

}  // namespace remanifold::python
