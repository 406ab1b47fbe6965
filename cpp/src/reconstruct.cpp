// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that calls all steps.
#include "remanifold/reconstruct.hpp"

#include "detail/parallel.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/topology.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>

namespace remanifold {
namespace {

constexpr Index kRecallQueries = 200;

int thread_count(const Execution& execution) {
  return execution.num_threads > 0
             ? execution.num_threads
             : tbb::task_arena(tbb::task_arena::automatic).max_concurrency();
}

}  // namespace

Reconstruction reconstruct(const Samples& samples, const ReconstructOptions& options,
                           const Execution& execution) {
  TangentOptions tangent = options.tangent;
  if (tangent.num_neighbors == 0) {
    tangent.num_neighbors = 10 * tangent.dim;
  }
  Reconstruction result;
  result.dim = tangent.dim;
  const double threads = thread_count(execution);
  detail::Stopwatch watch;

  const NeighborSearch search(samples, options.search, execution);
  const Neighborhoods neighborhoods = find_neighborhoods(
      samples, search,
      std::max(tangent.num_neighbors, certifying_count(tangent.dim, search)),
      execution);
  result.search = search.method();
  result.seconds.neighborhoods = watch.lap();
  if (result.search == SearchMethod::kApproximate) {
    result.recall =
        measure_recall(samples, search, neighborhoods.count, kRecallQueries, execution);
    watch.lap();
  }

  const TangentSpaces tangents =
      compute_tangent_spaces(samples, neighborhoods, tangent, execution);
  result.seconds.tangent_spaces = watch.lap();
  const LocalRegions regions =
      compute_local_regions(samples, search, neighborhoods, tangents, execution);
  result.seconds.local_regions = watch.lap();

  // Thread time over threads stands for wall time.
  const double in_tangents = tangents.coordinate_seconds / threads;
  const double in_regions = regions.coordinate_seconds / threads;
  result.seconds.coordinates = in_tangents + in_regions;
  result.seconds.neighborhoods += result.seconds.coordinates;
  result.seconds.tangent_spaces -= std::min(result.seconds.tangent_spaces, in_tangents);
  result.seconds.local_regions -= std::min(result.seconds.local_regions, in_regions);

  result.edge_sets = edge_sets_to_input(samples, regions, execution);
  result.stars = stars_to_input(samples, regions, execution);
  const Csr graph = edge_graph(result.edge_sets, options.edges, execution);
  result.edges = graph_edges(graph);
  result.simplices = clique_complex(graph, tangent.dim, execution);

  result.seconds.complex = watch.lap();
  TangentSpaces mapped = to_input(samples, tangents);
  result.tangents = std::move(mapped.bases);
  result.tangent_simplices = std::move(mapped.simplices);
  result.boundary = std::move(mapped.boundary);
  for (const Index i : samples.canonical_indices()) {
    result.unbounded.push_back(
        regions.squared_radii[i] == std::numeric_limits<double>::infinity() ? 1 : 0);
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
      const Index* face = faces.simplices[f];
      report.callous_faces.vertices.insert(report.callous_faces.vertices.end(), face,
                                           face + dim);
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
      report.unstarred_simplices.vertices.insert(
          report.unstarred_simplices.vertices.end(), simplex, simplex + dim + 1);
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
  report.open_faces = std::move(open.faces);
  report.num_holes =
      static_cast<Index>(std::count(open.hole.begin(), open.hole.end(), 1));
  report.num_boundary_components =
      static_cast<Index>(open.hole.size()) - report.num_holes;
  return report;
}

}  // namespace remanifold
