// SPDX-License-Identifier: GPL-3.0-or-later
// The method of Freedman (2002), from top to bottom: tangent spaces, local regions, edge
// sets, the cliques of their graph.
#include "base/parallel.hpp"
#include "cleaning/clean_samples.hpp"
#include "complex/simplex_rows.hpp"
#include "first_steps.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/reconstruct.hpp"
#include "remanifold/topology.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace remanifold {

PaperReconstruction reconstruct_paper(const Samples& given,
                                      const ReconstructOptions& options,
                                      const Execution& execution) {
  const TangentOptions tangent{
      options.dim,
      options.num_neighbors > 0 ? options.num_neighbors : paper_neighbors(options.dim),
      options.estimator.value_or(Estimator::kEnclosure)};
  detail::CleanSamples clean(given, options, options.outlier_distance.value_or(0),
                             execution);
  detail::FirstSteps steps = detail::take_first_steps(clean, tangent, execution);
  const Samples& samples = clean.samples();
  const LocalRegions& regions = steps.regions;
  PaperReconstruction result;
  result.dim = tangent.dim;
  result.search = clean.search().method();
  result.cleaning = clean.take_report();
  result.recall = steps.recall;
  result.seconds = steps.seconds;
  detail::Stopwatch watch;

  result.edge_sets = edge_sets_to_input(samples, regions, execution);
  result.stars = stars_to_input(samples, regions, execution);
  const Csr graph = edge_graph(result.edge_sets, options.edges, execution);
  result.edges = graph_edges(graph);
  result.simplices = clique_complex(graph, tangent.dim, execution);

  result.seconds.complex = watch.lap();
  TangentSpaces mapped = to_input(samples, steps.tangents, execution);
  result.tangent_simplices = std::move(mapped.simplices);
  result.boundary = std::move(mapped.boundary);
  detail::write_tangents(samples, std::move(mapped), result.tangents, result.frames);
  for (const Index i : samples.canonical_indices()) {
    const bool unbounded =
        i >= 0 && regions.squared_radii[i] == std::numeric_limits<double>::infinity();
    result.unbounded.push_back(unbounded ? 1 : 0);
  }
  result.representatives = samples.representatives();
  result.neighbors_used = regions.neighbors_used;
  result.vacuous_constraints = regions.vacuous_constraints;
  const double written = watch.lap();
  result.seconds.coordinates += written;
  result.seconds.neighborhoods += written;
  return result;
}

PaperReport paper_report(const SimplexArray& simplices, const Csr& edge_sets,
                         const Csr& stars, const std::vector<std::uint8_t>& boundary,
                         const Execution& execution) {
  PaperReport report;
  const int dim = simplices.arity - 1;
  const Faces faces = faces_of(simplices, dim - 1, execution);
  report.callous_faces.arity = dim;
  for (Offset f = 0; f < faces.simplices.size(); ++f) {
    if (faces.cofaces[f] > 2) {
      detail::append_row(report.callous_faces, faces.simplices[f]);
    }
  }

  report.unstarred_simplices.arity = dim + 1;
  std::vector<Index> others(dim);
  for (Offset s = 0; s < simplices.size(); ++s) {
    const Index* simplex = simplices[s];
    bool starred = false;
    for (int i = 0; i <= dim && !starred; ++i) {
      std::copy_if(simplex, simplex + dim + 1, others.begin(),
                   [&](Index v) { return v != simplex[i]; });
      for (Offset t = stars.offsets[simplex[i]]; t < stars.offsets[simplex[i] + 1];
           ++t) {
        const Index* star = stars.indices.data() + t * (dim + 1);
        starred = starred || std::equal(others.begin(), others.end(), star + 1);
      }
    }
    if (!starred) {
      detail::append_row(report.unstarred_simplices, simplex);
    }
  }

  std::vector<std::uint8_t> at_boundary = boundary;
  for (Offset i = 0; i < edge_sets.rows(); ++i) {
    if (std::any_of(edge_sets.begin(i), edge_sets.end(i),
                    [&](Index j) { return boundary[j] != 0; })) {
      at_boundary[i] = 1;
    }
  }
  OpenFaces open = find_open_faces(faces, at_boundary);
  report.hole_faces.arity = dim;
  for (Offset f = 0; f < open.faces.size(); ++f) {
    if (open.hole[open.set[f]] != 0) {
      detail::append_row(report.hole_faces, open.faces[f]);
    }
  }
  report.open_faces = std::move(open.faces);
  report.num_holes =
      static_cast<Index>(std::count(open.hole.begin(), open.hole.end(), 1));
  report.num_boundary_components =
      static_cast<Index>(open.hole.size()) - report.num_holes;
  return report;
}

}  // namespace remanifold
