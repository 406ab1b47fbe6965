// SPDX-License-Identifier: GPL-3.0-or-later
// The default method, from top to bottom: tangent spaces, local regions, what the stars
// agree on, the chain of least energy through the rest, orientation.
#include "base/free_memory.hpp"
#include "base/parallel.hpp"
#include "base/sort_unique.hpp"
#include "base/tolerance.hpp"
#include "cleaning/clean_samples.hpp"
#include "complex/simplex_rows.hpp"
#include "first_steps.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/link_repair.hpp"
#include "remanifold/reconstruct.hpp"
#include "remanifold/topology.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace remanifold {
namespace {

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

/// Signs of simplices with ascending columns: alike across facets, and with a positive
/// volume where there is one to speak of. 0 where a patch has no orientation.
std::vector<std::int8_t> orient(const Samples& samples, const SimplexArray& simplices,
                                const OrientedPatches& patches) {
  const int arity = simplices.arity;
  const int dim = arity - 1;
  const auto num_patches = patches.sizes.size();
  const std::vector<int>& axes = samples.varying_axes();
  const auto ambient_dim = static_cast<int>(axes.size());
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
          edges(i, j) = cone ? p[axes[j]] : p[axes[j]] - origin[axes[j]];
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

/// Those of a fit, but no more than half of all samples: the others of a closed manifold are
/// on its other side.
Index few_neighbors(const Samples& samples, int dim) {
  return static_cast<Index>(std::min<Offset>(
      jet_neighbors(dim), std::max<Offset>(dim + 1, (samples.whole_size() - 1) / 2)));
}

/// Where samples differ in no more than K coordinates: the determinant of the edges from the
/// first vertex, and the product of their lengths.
std::pair<double, double> volume_of(const Samples& samples, const Index* simplex,
                                    int arity) {
  const std::vector<int>& axes = samples.varying_axes();
  const auto dim = static_cast<int>(axes.size());
  if (dim < arity - 1) {
    return {0.0, 1.0};
  }
  Eigen::MatrixXd edges(dim, dim);
  for (int i = 0; i < dim; ++i) {
    for (int j = 0; j < dim; ++j) {
      edges(i, j) =
          samples.point(simplex[i + 1])[axes[j]] - samples.point(simplex[0])[axes[j]];
    }
  }
  return {dim == 3 ? Eigen::Matrix3d(edges).determinant() : edges.determinant(),
          edges.rowwise().norm().prod()};
}

/// On a line, edges that other samples lie on. A closed curve has as much length on one
/// side as on the other.
std::vector<std::uint8_t> edges_across(const Samples& samples,
                                       const SimplexArray& edges) {
  if (samples.varying_axes().empty()) {
    return std::vector<std::uint8_t>(edges.size(), 0);
  }
  const int axis = samples.varying_axes().front();
  std::vector<Index> order(samples.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return samples.point(a)[axis] < samples.point(b)[axis];
  });
  std::vector<Index> rank(samples.size());
  for (Index i = 0; i < samples.size(); ++i) {
    rank[order[i]] = i;
  }
  std::vector<std::uint8_t> across(edges.size(), 0);
  for (Offset e = 0; e < edges.size(); ++e) {
    across[e] = std::abs(rank[edges[e][0]] - rank[edges[e][1]]) > 1 ? 1 : 0;
  }
  return across;
}

/// Simplices that are flat, or have their volume on the other side than their patch.
std::vector<std::uint8_t> turned_over(const Samples& samples,
                                      const ManifoldComplex& complex) {
  const SimplexArray& simplices = complex.simplices;
  const auto size = static_cast<std::size_t>(simplices.size());
  std::vector<double> volumes(size);
  std::vector<double> of_patch(complex.patches.sizes.size(), 0.0);
  std::vector<std::uint8_t> turned(size, 0);
  for (std::size_t s = 0; s < size; ++s) {
    const auto [volume, lengths] =
        volume_of(samples, simplices[static_cast<Offset>(s)], simplices.arity);
    const bool flat = !(std::abs(volume) > detail::kFlatSimplex * lengths);
    volumes[s] = flat ? 0 : volume * complex.patches.sign[s];
    of_patch[complex.patches.patch[s]] += volumes[s];
  }
  for (std::size_t s = 0; s < size; ++s) {
    const Index patch = complex.patches.patch[s];
    turned[s] = !(volumes[s] * of_patch[patch] > 0);
  }
  return turned;
}

/// With K = D a simplex fills space, to the side that its patch does. What does not is left
/// out, and what is no manifold without it: samples in planes have no K-dimensional
/// neighborhood. That is in the report.
void leave_out_flat(const Samples& samples, ManifoldComplex& complex,
                    const Execution& execution) {
  SimplexArray& simplices = complex.simplices;
  const auto size = static_cast<std::size_t>(simplices.size());
  const std::vector<std::uint8_t> dropped = simplices.arity == 2
                                                ? edges_across(samples, simplices)
                                                : turned_over(samples, complex);
  if (std::find(dropped.begin(), dropped.end(), 1) == dropped.end()) {
    return;
  }
  const int arity = simplices.arity;
  ManifoldReport& report = complex.report;
  SimplexArray filled;
  filled.arity = arity;
  SimplexArray kept;
  kept.arity = arity;
  std::vector<std::uint8_t> used(samples.size(), 0);
  std::vector<std::uint8_t> beside(samples.size(), 0);
  for (std::size_t s = 0; s < size; ++s) {
    const Index* simplex = simplices[static_cast<Offset>(s)];
    for (int i = 0; i < arity; ++i) {
      used[simplex[i]] = 1;
      beside[simplex[i]] |= dropped[s];
    }
    if (dropped[s] == 0) {
      detail::append_row(kept, simplex);
    }
  }
  const std::vector<Index> cut = cut_links(samples, beside, kept, execution);
  report.cut_vertices.insert(report.cut_vertices.end(), cut.begin(), cut.end());
  detail::sort_unique(report.cut_vertices);
  for (const Index v : kept.vertices) {
    used[v] = 2;
  }
  for (Offset s = 0; s < report.filled.size(); ++s) {
    if (detail::find_row(kept, report.filled[s]) >= 0) {
      detail::append_row(filled, report.filled[s]);
    }
  }
  for (Index v = 0; v < samples.size(); ++v) {
    if (used[v] == 1) {
      report.outliers.push_back(v);
    }
  }
  std::sort(report.outliers.begin(), report.outliers.end());
  report.filled = std::move(filled);
  simplices = std::move(kept);

  const std::vector<std::uint8_t> all(samples.size(), 1);
  UnpairedFacets unpaired = unpaired_facets(simplices, all, execution);
  report.open_facets = std::move(unpaired.open);
  report.branching_facets = std::move(unpaired.branching);
  report.singular = singular_vertices(simplices, all, execution);
  complex.patches = orient_patches(simplices, samples.size(), execution);
}

/// Samples that no simplex has room for are outliers as well, as long as they are few and
/// not a part of their own: what is left of clutter among the samples, and around solids.
void drop_strays(const Samples& samples, ManifoldReport& report,
                 std::vector<Index>& outliers) {
  constexpr Index fewest_others = 5;  // to one of them
  if (samples.size() / fewest_others < static_cast<Index>(report.outliers.size())) {
    return;
  }
  std::vector<std::uint8_t> stray(samples.size(), 0);
  for (const Index v : report.outliers) {
    stray[v] = 1;
  }
  for (const Opening& opening : report.openings) {
    if (opening.kind == OpeningKind::kPart) {
      for (const Index v : opening.samples) {
        stray[v] = 0;
      }
    }
  }
  report.outliers.erase(std::remove_if(report.outliers.begin(), report.outliers.end(),
                                       [&](Index v) { return stray[v] != 0; }),
                        report.outliers.end());
  const std::vector<Index> canonical = samples.canonical_indices();
  for (Index i = 0; i < samples.input_size(); ++i) {
    if (canonical[i] >= 0 && stray[canonical[i]] != 0) {
      outliers.push_back(i);
    }
  }
  std::sort(outliers.begin(), outliers.end());
}

/// In the caller's numbering.
PartReport part_report(const Samples& samples, PartReport part) {
  part.sharp_folds = to_input(samples, std::move(part.sharp_folds));
  part.stretched = to_input(samples, std::move(part.stretched));
  for (auto* lists : {&part.opened, &part.unmended}) {
    for (std::vector<Index>& list : *lists) {
      list = to_input(samples, std::move(list));
    }
  }
  for (Index v = 0; v < samples.size(); ++v) {
    part.order.push_back(samples.input_index(v));
  }
  return part;
}

}  // namespace

Reconstruction reconstruct(const Samples& given, const ReconstructOptions& options,
                           const ProgramSolver& solver, const Execution& execution) {
  const int dim = options.dim;
  const TangentOptions tangent{
      dim,
      options.num_neighbors > 0 ? options.num_neighbors : few_neighbors(given, dim),
      options.estimator.value_or(Estimator::kJet)};
  const double outlier_distance = options.outlier_distance.value_or(kOutlierDistance);
  detail::CleanSamples clean(given, options, outlier_distance, execution);
  clean.set_thinning();
  detail::FirstSteps steps = detail::take_first_steps(clean, tangent, execution);
  const Samples& samples = clean.samples();
  detail::Stopwatch watch;
  Reconstruction result;
  result.dim = dim;
  result.search = clean.search().method();
  Neighborhoods neighborhoods = clean.take_neighborhoods();
  result.cleaning = clean.take_report();
  result.recall = steps.recall;
  result.seconds = steps.seconds;
  result.representatives = samples.representatives();

  ManifoldOptions manifold = options.manifold;
  manifold.among_clutter = result.cleaning.clutter;
  if (manifold.boundary == BoundaryRule::kGiven) {
    manifold.boundary_samples = flags_to_canonical(samples, manifold.boundary_samples);
  }
  for (OpeningDecision& decision : manifold.decisions) {
    std::vector<std::uint8_t> flags(samples.input_size(), 0);
    for (const Index v : decision.samples) {
      flags.at(v) = 1;
    }
    flags = flags_to_canonical(samples, flags);
    decision.samples.clear();
    for (Index v = 0; v < samples.size(); ++v) {
      if (flags[v] != 0) {
        decision.samples.push_back(v);
      }
    }
  }
  if (manifold.open_region) {
    std::vector<Index>& here = manifold.open_region->here;
    const std::vector<Index> canonical = samples.canonical_indices();
    for (Index& v : here) {
      v = canonical.at(v);
    }
    std::sort(here.begin(), here.end());
    for (double& value : manifold.open_region->elsewhere) {
      value /= samples.scale();
    }
  }
  // Nobody asks what encloses the samples.
  std::vector<Index>().swap(steps.tangents.simplices);
  detail::begin_step(execution, Step::kComplex, 0);
  // The same ones whatever the search knows.
  const Index count = std::max(tangent.num_neighbors, certifying_count(dim));
  Neighborhoods fewer =
      count < neighborhoods.count ? nearest_of(neighborhoods, count) : Neighborhoods{};
  ManifoldComplex complex = build_manifold(
      samples.knowing(neighborhoods), fewer.count > 0 ? fewer : neighborhoods,
      steps.tangents, std::move(steps.regions), manifold, solver, execution);
  // Whoever allows for more than the chain does wants to see what is left over.
  if (outlier_distance > 0 && outlier_distance <= manifold.outlier_distance) {
    drop_strays(samples, complex.report, result.cleaning.outliers);
  }
  if (samples.has_points() && static_cast<int>(samples.varying_axes().size()) <= dim) {
    leave_out_flat(samples, complex, execution);
  }
  const std::size_t freed = neighborhoods.indices.size() * sizeof(Index);
  neighborhoods = {};
  fewer = {};
  result.open_region = to_input(samples, std::move(complex.open_region));
  if (samples.whole() != nullptr) {
    result.part = part_report(samples, std::move(complex.part));
  }
  const std::vector<std::int8_t> signs =
      orient(samples, complex.simplices, complex.patches);
  complex.patches = {};
  detail::give_back_memory(freed);
  result.simplices = to_input(samples, std::move(complex.simplices), signs, execution);
  ManifoldReport& report = complex.report;
  for (SimplexArray* simplices : {&report.disputed, &report.filled, &report.open_facets,
                                  &report.branching_facets}) {
    *simplices = to_input(samples, std::move(*simplices), {});
  }
  for (std::vector<Index>* vertices :
       {&report.singular, &report.inserted, &report.cut_vertices, &report.outliers}) {
    *vertices = to_input(samples, std::move(*vertices));
  }
  report.hole_size *= samples.scale();
  for (Opening& opening : report.openings) {
    opening.samples = to_input(samples, std::move(opening.samples));
    opening.simplices.arity = dim + 1;
    opening.simplices = to_input(samples, std::move(opening.simplices), {});
    opening.volume *= std::pow(samples.scale(), dim);
    opening.spacing *= samples.scale();
  }
  result.report = std::move(report);
  result.boundary.assign(samples.input_size(), 0);
  for (const Index v : result.report.open_facets.vertices) {
    result.boundary[v] = 1;
  }
  result.seconds.complex = watch.lap();
  detail::write_tangents(samples, to_input(samples, steps.tangents, execution),
                         result.tangents, result.frames);
  const double written = watch.lap();
  result.seconds.coordinates += written;
  result.seconds.neighborhoods += written;
  return result;
}

}  // namespace remanifold
