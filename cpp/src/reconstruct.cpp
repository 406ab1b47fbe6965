// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that calls all steps.
#include "remanifold/reconstruct.hpp"

#include "base/parallel.hpp"
#include "complex/simplex_rows.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/topology.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace remanifold {
namespace {

constexpr Index kRecallQueries = 200;

int thread_count(const Execution& execution) {
  return execution.num_threads > 0
             ? execution.num_threads
             : tbb::task_arena(tbb::task_arena::automatic).max_concurrency();
}

/// +1 where the input numbers of the vertices are an even permutation of ascending ones.
int sign_of_input_order(const Samples& samples, const Index* simplex, int arity) {
  int sign = 1;
  for (int i = 0; i < arity; ++i) {
    for (int j = 0; j < i; ++j) {
      if (samples.input_index(simplex[j]) > samples.input_index(simplex[i])) {
        sign = -sign;
      }
    }
  }
  return sign;
}

/// Outliers left out and the others smoothed, as far as asked for.
class CleanSamples {
 public:
  CleanSamples(const Samples& given, const ReconstructOptions& options,
               const Execution& execution)
      : given_(given), options_(options), execution_(execution) {
    search_.emplace(given, options.search, execution);
  }
  CleanSamples(const CleanSamples&) = delete;
  CleanSamples& operator=(const CleanSamples&) = delete;

  const Samples& samples() const { return changed_ ? *changed_ : given_; }
  const NeighborSearch& search() const { return *search_; }
  const Neighborhoods& neighborhoods() const { return neighborhoods_; }
  Cleaning take_report() { return std::move(report_); }
  double neighborhood_seconds() const { return neighborhood_seconds_; }
  double cleaning_seconds() const { return cleaning_seconds_; }

  /// \param count  of neighborhoods, 0 where the caller has no use for them
  void run(Index count) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    report_.noise = report_.prediction_error = nan;
    if (count > 0 || options_.outlier_distance > 0) {
      find(std::max<Index>(count, 2 * options_.tangent.dim + 2));
    }
    bool stale = false;
    if (options_.outlier_distance > 0) {
      const detail::Timed timed(cleaning_seconds_);
      detail::begin_step(execution_, Step::kOutliers, 0);
      const std::vector<Index> outliers =
          find_outliers(given_, *search_, neighborhoods_,
                        {options_.tangent.dim, options_.outlier_distance}, execution_);
      if (!outliers.empty()) {
        leave_out(outliers);
        stale = true;
      }
    }
    if (options_.smooth) {
      const detail::Timed timed(cleaning_seconds_);
      SmoothingOptions smoothing = options_.smoothing;
      smoothing.dim = options_.tangent.dim;
      smoothing.search = options_.search;
      Smoothing smoothed = smooth(samples(), *search_, smoothing, execution_);
      report_.noise = smoothed.noise * given_.scale();
      report_.prediction_error = smoothed.prediction_error * given_.scale();
      report_.smoothing_neighbors = smoothed.num_neighbors;
      report_.smoothing_rounds = smoothed.rounds;
      if (!smoothed.points.empty()) {
        move(smoothed.points);
        stale = true;
      }
    }
    if (stale && count > 0) {
      find(count);
    }
  }

 private:
  void find(Index count) {
    const detail::Timed timed(neighborhood_seconds_);
    neighborhoods_ = find_neighborhoods(samples(), *search_, count, execution_);
  }

  void change(Samples samples) {
    search_.reset();
    changed_ = std::move(samples);
    search_.emplace(*changed_, options_.search, execution_);
  }

  void leave_out(const std::vector<Index>& outliers) {
    std::vector<std::uint8_t> marked(given_.size(), 0);
    for (const Index x : outliers) {
      marked[x] = 1;
    }
    const std::vector<Index> canonical = given_.canonical_indices();
    for (Index i = 0; i < given_.input_size(); ++i) {
      if (marked[canonical[i]] != 0) {
        report_.outliers.push_back(i);
      }
    }
    change(given_.without(outliers));
  }

  void move(const std::vector<double>& points) {
    const Samples& before = samples();
    const auto dim = static_cast<std::size_t>(before.ambient_dim());
    report_.displacements.assign(before.input_size() * dim, 0.0);
    const std::vector<Index> canonical = before.canonical_indices();
    for (std::size_t i = 0; i < canonical.size(); ++i) {
      if (canonical[i] >= 0) {
        const double* from = before.point(canonical[i]);
        const double* to = points.data() + canonical[i] * dim;
        for (std::size_t axis = 0; axis < dim; ++axis) {
          report_.displacements[i * dim + axis] =
              (to[axis] - from[axis]) * before.scale();
        }
      }
    }
    change(before.moved_to({points.data(), before.size(), before.ambient_dim()},
                           execution_));
  }

  const Samples& given_;
  const ReconstructOptions& options_;
  const Execution& execution_;
  std::optional<Samples> changed_;
  std::optional<NeighborSearch> search_;
  Neighborhoods neighborhoods_;
  Cleaning report_;
  double neighborhood_seconds_ = 0;
  double cleaning_seconds_ = 0;
};

/// What both methods begin with.
struct Regions {
  TangentSpaces tangents;
  LocalRegions regions;
  double recall = 1;
  StepSeconds seconds;
};

Regions compute_regions(CleanSamples& clean, const TangentOptions& tangent,
                        const Execution& execution) {
  const double threads = thread_count(execution);
  Regions result;
  clean.run(
      std::max(tangent.num_neighbors, certifying_count(tangent.dim, clean.search())));
  const Samples& samples = clean.samples();
  const NeighborSearch& search = clean.search();
  const Neighborhoods& neighborhoods = clean.neighborhoods();
  result.seconds.neighborhoods = clean.neighborhood_seconds();
  result.seconds.cleaning = clean.cleaning_seconds();
  if (search.method() == SearchMethod::kApproximate) {
    result.recall =
        measure_recall(samples, search, neighborhoods.count, kRecallQueries, execution);
  }
  detail::Stopwatch watch;
  result.tangents = compute_tangent_spaces(samples, neighborhoods, tangent, execution);
  result.seconds.tangent_spaces = watch.lap();
  result.regions =
      compute_local_regions(samples, search, neighborhoods, result.tangents, execution);
  result.seconds.local_regions = watch.lap();

  // Thread time over threads stands for wall time.
  StepSeconds& seconds = result.seconds;
  const double in_tangents = result.tangents.coordinate_seconds / threads;
  const double in_regions = result.regions.coordinate_seconds / threads;
  seconds.coordinates = in_tangents + in_regions;
  seconds.neighborhoods += seconds.coordinates;
  seconds.tangent_spaces -= std::min(seconds.tangent_spaces, in_tangents);
  seconds.local_regions -= std::min(seconds.local_regions, in_regions);
  return result;
}

/// Signs of simplices with ascending columns: alike across facets, and with a positive
/// volume where there is one to speak of. 0 where a patch has no orientation.
std::vector<std::int8_t> orient(const Samples& samples, const SimplexArray& simplices,
                                const OrientedPatches& patches) {
  const int arity = simplices.arity;
  const int dim = arity - 1;
  const auto num_patches = patches.sizes.size();
  const int ambient_dim = samples.has_points() ? samples.ambient_dim() : 0;
  std::vector<double> volume(num_patches, 0.0);
  std::vector<double> first(num_patches, 0.0);
  Eigen::MatrixXd edges(ambient_dim, ambient_dim);
  for (Offset s = 0; s < simplices.size(); ++s) {
    const Index patch = patches.patch[s];
    const double sign = patches.sign[s];
    if (first[patch] == 0) {
      first[patch] = sign * sign_of_input_order(samples, simplices[s], arity);
    }
    // With K = D - 1 the volume of the cone over the simplex from the origin.
    if (ambient_dim == dim || (ambient_dim == dim + 1 && patches.closed[patch] != 0)) {
      const bool cone = ambient_dim > dim;
      for (int i = 0; i < ambient_dim; ++i) {
        const double* p = samples.point(simplices[s][cone ? i : i + 1]);
        const double* origin = samples.point(simplices[s][0]);
        for (int j = 0; j < ambient_dim; ++j) {
          edges(i, j) = cone ? p[j] : p[j] - origin[j];
        }
      }
      volume[patch] += sign * (ambient_dim == 3 ? Eigen::Matrix3d(edges).determinant()
                                                : edges.determinant());
    }
  }
  std::vector<std::int8_t> signs(simplices.size(), 0);
  for (Offset s = 0; s < simplices.size(); ++s) {
    const Index patch = patches.patch[s];
    if (patches.orientable[patch] != 0) {
      const double turn = volume[patch] != 0 ? volume[patch] : first[patch];
      signs[s] =
          static_cast<std::int8_t>(turn < 0 ? -patches.sign[s] : patches.sign[s]);
    }
  }
  return signs;
}

/// Tangent spaces in the form they were found in.
void write_tangents(const Samples& samples, TangentSpaces mapped,
                    std::vector<double>& bases, TangentFrames& frames) {
  bases = std::move(mapped.bases);
  frames = {mapped.num_coefficients, std::move(mapped.coefficients),
            std::move(mapped.neighbors), samples.scale()};
}

}  // namespace

Cleaning clean(const Samples& samples, const ReconstructOptions& options,
               const Execution& execution) {
  CleanSamples clean(samples, options, execution);
  clean.run(0);
  return clean.take_report();
}

Reconstruction reconstruct(const Samples& given, const ReconstructOptions& options,
                           const Execution& execution) {
  TangentOptions tangent = options.tangent;
  if (tangent.num_neighbors == 0) {
    tangent.num_neighbors = 10 * tangent.dim;
  }
  CleanSamples clean(given, options, execution);
  Regions steps = compute_regions(clean, tangent, execution);
  const Samples& samples = clean.samples();
  const LocalRegions& regions = steps.regions;
  Reconstruction result;
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
  write_tangents(samples, std::move(mapped), result.tangents, result.frames);
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

ManifoldReconstruction reconstruct_manifold(const Samples& given,
                                            const ReconstructOptions& options,
                                            ManifoldOptions manifold,
                                            const ProgramSolver& solver,
                                            const Execution& execution) {
  TangentOptions tangent = options.tangent;
  const int dim = tangent.dim;
  if (tangent.num_neighbors == 0) {
    tangent.num_neighbors = jet_neighbors(dim);
  }
  CleanSamples clean(given, options, execution);
  Regions steps = compute_regions(clean, tangent, execution);
  const Samples& samples = clean.samples();
  const Neighborhoods& neighborhoods = clean.neighborhoods();
  detail::Stopwatch watch;
  ManifoldReconstruction result;
  result.dim = dim;
  result.search = clean.search().method();
  result.cleaning = clean.take_report();
  result.recall = steps.recall;
  result.seconds = steps.seconds;
  result.representatives = samples.representatives();

  if (manifold.boundary == BoundaryRule::kGiven) {
    std::vector<std::uint8_t> mask(samples.size(), 0);
    const std::vector<Index> canonical = samples.canonical_indices();
    for (std::size_t i = 0; i < canonical.size(); ++i) {
      if (canonical[i] >= 0) {
        mask[canonical[i]] |= manifold.boundary_samples[i];
      }
    }
    manifold.boundary_samples = std::move(mask);
  }
  steps.regions.edge_sets = {};  // the stars are all that is needed
  detail::begin_step(execution, Step::kComplex, 0);
  ManifoldComplex complex =
      build_manifold(samples.knowing(neighborhoods), neighborhoods, steps.tangents,
                     steps.regions, manifold, solver, execution);
  steps.regions = {};
  const std::vector<std::int8_t> signs =
      orient(samples, complex.simplices, complex.patches);
  result.simplices = to_input(samples, complex.simplices, signs, execution);
  ManifoldReport& report = complex.report;
  for (SimplexArray* simplices : {&report.disputed, &report.filled, &report.open_facets,
                                  &report.branching_facets}) {
    *simplices = to_input(samples, *simplices, {});
  }
  for (std::vector<Index>* vertices :
       {&report.singular, &report.inserted, &report.outliers}) {
    for (Index& v : *vertices) {
      v = samples.input_index(v);
    }
    std::sort(vertices->begin(), vertices->end());
  }
  result.report = std::move(report);
  result.boundary.assign(samples.input_size(), 0);
  for (const Index v : result.report.open_facets.vertices) {
    result.boundary[v] = 1;
  }
  result.seconds.complex = watch.lap();
  write_tangents(samples, to_input(samples, steps.tangents, execution), result.tangents,
                 result.frames);
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
