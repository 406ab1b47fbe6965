// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/verify.hpp"

#include "complex/simplex_rows.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/topology.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace remanifold {
namespace {

/// How far inner products of basis vectors may be from those of orthonormal ones.
constexpr double kOrthonormal = 1e-8;
/// Rounding of barycentric sums, and of distances relative to the coordinates.
constexpr double kRounding = 1e-9;

void require(bool holds, const char* step, const std::string& what) {
  if (!holds) {
    throw std::logic_error(std::string(step) + ": " + what);
  }
}

std::string at(const char* what, Offset i) {
  return std::string(what) + " " + std::to_string(i);
}

}  // namespace

void verify_neighborhoods(const Samples& samples, const Neighborhoods& neighborhoods) {
  constexpr const char* kStep = "neighborhoods";
  const Index count = neighborhoods.count;
  require(
      neighborhoods.indices.size() == static_cast<std::size_t>(samples.size()) * count,
      kStep, "there are not as many rows as samples");
  std::vector<Index> seen;
  for (Index x = 0; x < samples.size(); ++x) {
    const Index* row = neighborhoods.of(x);
    seen.assign(row, row + count);
    std::sort(seen.begin(), seen.end());
    require(std::adjacent_find(seen.begin(), seen.end()) == seen.end(), kStep,
            at("a neighbor is twice in row", x));
    double last = 0;
    for (Index k = 0; k < count; ++k) {
      require(row[k] >= 0 && row[k] < samples.size() && row[k] != x, kStep,
              at("no other sample in row", x));
      const double squared = samples.squared_distance(x, row[k]);
      require(squared >= last, kStep, at("distances descend in row", x));
      last = squared;
    }
  }
}

void verify_tangent_spaces(const Samples& samples, const TangentSpaces& tangents) {
  constexpr const char* kStep = "tangent spaces";
  require(tangents.boundary.size() == static_cast<std::size_t>(samples.size()), kStep,
          "there are not as many as samples");
  if (tangents.bases.empty()) {
    return;
  }
  const auto ambient = static_cast<std::size_t>(samples.ambient_dim());
  const auto dim = static_cast<std::size_t>(tangents.dim);
  for (Index x = 0; x < samples.size(); ++x) {
    if (tangents.boundary[x] != 0) {
      continue;
    }
    const double* basis = tangents.bases.data() + x * dim * ambient;
    for (std::size_t i = 0; i < dim; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double product = 0;
        for (std::size_t k = 0; k < ambient; ++k) {
          product += basis[i * ambient + k] * basis[j * ambient + k];
        }
        require(std::abs(product - (i == j ? 1 : 0)) <= kOrthonormal, kStep,
                at("no orthonormal basis at sample", x));
      }
    }
  }
}

void verify_local_regions(const LocalRegions& regions) {
  constexpr const char* kStep = "local regions";
  const int dim = regions.dim;
  const Offset count = regions.edge_sets.rows();
  require(static_cast<Offset>(regions.star_offsets.size()) == count + 1, kStep,
          "stars and edge sets differ in number");
  std::map<std::vector<Index>, int> facets;
  std::vector<Index> rows;
  for (Offset x = 0; x < count; ++x) {
    const Index* begin = regions.edge_sets.begin(x);
    const Index* end = regions.edge_sets.end(x);
    require(std::is_sorted(begin, end) && std::adjacent_find(begin, end) == end, kStep,
            at("no ascending edge set at sample", x));
    require(!std::binary_search(begin, end, static_cast<Index>(x)), kStep,
            at("in its own edge set is sample", x));
    facets.clear();
    rows.clear();
    regions.star(x).append_to(rows);
    for (auto next = rows.begin(); next != rows.end(); next += dim) {
      const Index* row = &*next;
      for (int i = 0; i < dim; ++i) {
        require(i == 0 || row[i - 1] < row[i], kStep,
                at("no ascending star simplex at sample", x));
        std::vector<Index> facet(row, row + dim);
        facet.erase(facet.begin() + i);
        ++facets[facet];
      }
      require(next == rows.begin() || detail::row_less(row - dim, row, dim), kStep,
              at("no sorted star at sample", x));
    }
    if (std::isfinite(regions.squared_radii[x])) {
      for (const auto& [facet, cofaces] : facets) {
        // For K = 1 the facets at x are x itself.
        require(cofaces == 2, kStep, at("the star is not closed around sample", x));
      }
    }
  }
}

void verify_simplices(const SimplexArray& simplices, Index num_vertices) {
  constexpr const char* kStep = "simplices";
  for (Offset s = 0; s < simplices.size(); ++s) {
    const Index* row = simplices[s];
    for (int i = 0; i < simplices.arity; ++i) {
      require(row[i] >= 0 && row[i] < num_vertices, kStep,
              at("a vertex is out of range in row", s));
      require(i == 0 || row[i - 1] < row[i], kStep, at("columns descend in row", s));
    }
    require(s == 0 || detail::row_less(simplices[s - 1], row, simplices.arity), kStep,
            at("rows do not ascend at", s));
  }
}

void verify_manifold_complex(const ManifoldComplex& complex, Index num_samples,
                             const Execution& execution) {
  constexpr const char* kStep = "manifold complex";
  const SimplexArray& simplices = complex.simplices;
  const ManifoldReport& report = complex.report;
  verify_simplices(simplices, num_samples);
  const Faces facets = faces_of(simplices, simplices.arity - 2, execution);
  SimplexArray open{simplices.arity - 1, {}};
  SimplexArray branching{simplices.arity - 1, {}};
  for (Offset f = 0; f < facets.simplices.size(); ++f) {
    if (facets.cofaces[f] == 1) {
      detail::append_row(open, facets.simplices[f]);
    } else if (facets.cofaces[f] > 2) {
      detail::append_row(branching, facets.simplices[f]);
    }
  }
  require(open.vertices == report.open_facets.vertices, kStep,
          "the report has other open facets");
  require(branching.vertices == report.branching_facets.vertices, kStep,
          "the report has other branching facets");
  const Topology topology = compute_topology(simplices, num_samples, execution);
  require(topology.singular_vertices == report.singular, kStep,
          "the report has other singular vertices");
  std::vector<std::uint8_t> used(num_samples, 0);
  for (const Index v : simplices.vertices) {
    used[v] = 1;
  }
  std::vector<Index> unused;
  for (Index x = 0; x < num_samples; ++x) {
    if (used[x] == 0) {
      unused.push_back(x);
    }
  }
  require(unused == report.outliers, kStep, "the report has other unused samples");

  const OrientedPatches& patches = complex.patches;
  const auto count = static_cast<std::size_t>(simplices.size());
  require(patches.patch.size() == count && patches.sign.size() == count, kStep,
          "not every simplex has a patch");
  const std::vector<FacetNumber> neighbors =
      facet_neighbors(simplices, num_samples, execution);
  for (std::size_t f = 0; f < neighbors.size(); ++f) {
    const FacetNumber other = neighbors[f];
    if (other < 0) {
      continue;
    }
    const auto a = static_cast<Offset>(f) / simplices.arity;
    const Offset b = other / simplices.arity;
    require(patches.patch[a] == patches.patch[b], kStep,
            at("a patch ends inside, at simplex", a));
    if (patches.orientable[patches.patch[a]] != 0) {
      const int product = patches.sign[a] * patches.sign[b];
      const bool turned =
          flips_across(static_cast<FacetNumber>(f), other, simplices.arity);
      require(product == (turned ? -1 : 1), kStep,
              at("orientations disagree at simplex", a));
    }
  }
}

void verify_projections(const Projections& projections, MatrixView queries) {
  constexpr const char* kStep = "projections";
  const auto count = static_cast<std::size_t>(queries.rows);
  require(
      projections.simplices.size() == count && projections.distances.size() == count,
      kStep, "there are not as many as queries");
  const std::size_t arity = count == 0 ? 0 : projections.barycentric.size() / count;
  for (std::size_t q = 0; q < count; ++q) {
    double sum = 0;
    for (std::size_t i = 0; i < arity; ++i) {
      const double weight = projections.barycentric[q * arity + i];
      require(weight >= 0, kStep, at("a weight is negative at query", q));
      sum += weight;
    }
    require(std::abs(sum - 1) <= kRounding, kStep,
            at("weights do not sum to one at query", q));
    double size = 0;
    double away = 0;
    for (Offset k = 0; k < queries.cols; ++k) {
      const double place = queries.row(q)[k];
      const double point = projections.points[q * queries.cols + k];
      size = std::max({size, std::abs(place), std::abs(point)});
      away = std::hypot(away, place - point);
    }
    require(std::abs(away - projections.distances[q]) <= kRounding * size, kStep,
            at("the distance is another at query", q));
  }
}

}  // namespace remanifold
