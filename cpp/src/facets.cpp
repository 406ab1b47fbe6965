// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/facets.hpp"

#include "detail/parallel.hpp"
#include "detail/simplex_rows.hpp"

#include <algorithm>
#include <numeric>

namespace remanifold {
namespace {

constexpr Offset kBlock = 4096;

/// Position j of facet i of a simplex, whose i-th vertex is left out.
Index facet_vertex(const Index* simplex, int i, int j) {
  return simplex[j < i ? j : j + 1];
}

int compare_facets(const SimplexArray& simplices, FacetNumber a, FacetNumber b) {
  const int arity = simplices.arity;
  const Index* first = simplices[a / arity];
  const Index* second = simplices[b / arity];
  const int i = static_cast<int>(a % arity);
  const int j = static_cast<int>(b % arity);
  for (int k = 0; k + 1 < arity; ++k) {
    const Index difference = facet_vertex(first, i, k) - facet_vertex(second, j, k);
    if (difference != 0) {
      return difference;
    }
  }
  return 0;
}

}  // namespace

void copy_facet(const SimplexArray& simplices, FacetNumber facet, Index* out) {
  const int arity = simplices.arity;
  const Index* simplex = simplices[facet / arity];
  for (int k = 0; k + 1 < arity; ++k) {
    out[k] = facet_vertex(simplex, static_cast<int>(facet % arity), k);
  }
}

FacetGroups group_facets(const SimplexArray& simplices, Index num_vertices,
                         const Execution& execution) {
  const int arity = simplices.arity;
  const Offset count = simplices.size() * arity;
  // Buckets by the lowest vertex, then each sorted on its own.
  std::vector<Offset> buckets(static_cast<std::size_t>(num_vertices) + 1, 0);
  for (FacetNumber f = 0; f < count; ++f) {
    ++buckets[facet_vertex(simplices[f / arity], static_cast<int>(f % arity), 0) + 1];
  }
  std::partial_sum(buckets.begin(), buckets.end(), buckets.begin());
  FacetGroups groups;
  groups.facets.resize(count);
  std::vector<Offset> next(buckets.begin(), buckets.end() - 1);
  for (FacetNumber f = 0; f < count; ++f) {
    const Index lowest =
        facet_vertex(simplices[f / arity], static_cast<int>(f % arity), 0);
    groups.facets[next[lowest]++] = f;
  }
  std::vector<std::uint8_t> starts(static_cast<std::size_t>(count), 0);
  detail::for_each_block_uncounted(
      num_vertices, kBlock, execution, [&](Offset begin, Offset end) {
        for (Offset v = begin; v < end; ++v) {
          const auto first = groups.facets.begin() + buckets[v];
          const auto last = groups.facets.begin() + buckets[v + 1];
          detail::sort_few(first, last, [&](FacetNumber a, FacetNumber b) {
            const int order = compare_facets(simplices, a, b);
            return order != 0 ? order < 0 : a < b;
          });
          for (auto f = first; f != last; ++f) {
            starts[f - groups.facets.begin()] =
                f == first || compare_facets(simplices, *(f - 1), *f) != 0 ? 1 : 0;
          }
        }
      });
  for (Offset i = 1; i < count; ++i) {
    if (starts[i] != 0) {
      groups.offsets.push_back(i);
    }
  }
  if (count > 0) {
    groups.offsets.push_back(count);
  }
  return groups;
}

SimplexArray edges_of(const SimplexArray& simplices, Index num_vertices) {
  // Buckets by the lower end.
  std::vector<Offset> buckets(static_cast<std::size_t>(num_vertices) + 1, 0);
  const int arity = simplices.arity;
  const auto for_each_edge = [&](const auto& body) {
    for (Offset s = 0; s < simplices.size(); ++s) {
      for (int i = 0; i < arity; ++i) {
        for (int j = i + 1; j < arity; ++j) {
          body(std::min(simplices[s][i], simplices[s][j]),
               std::max(simplices[s][i], simplices[s][j]));
        }
      }
    }
  };
  for_each_edge([&](Index a, Index) { ++buckets[a + 1]; });
  std::partial_sum(buckets.begin(), buckets.end(), buckets.begin());
  std::vector<Index> upper(buckets.back());
  std::vector<Offset> next(buckets.begin(), buckets.end() - 1);
  for_each_edge([&](Index a, Index b) { upper[next[a]++] = b; });
  SimplexArray edges{2, {}};
  for (Index v = 0; v < num_vertices; ++v) {
    const auto first = upper.begin() + buckets[v];
    const auto last = upper.begin() + buckets[v + 1];
    std::sort(first, last);
    const auto end = std::unique(first, last);
    for (auto w = first; w != end; ++w) {
      edges.vertices.push_back(v);
      edges.vertices.push_back(*w);
    }
  }
  return edges;
}

std::vector<FacetNumber> facet_neighbors(const SimplexArray& simplices,
                                         Index num_vertices,
                                         const Execution& execution) {
  const FacetGroups groups = group_facets(simplices, num_vertices, execution);
  std::vector<FacetNumber> neighbors(groups.facets.size(), kOpen);
  for (Offset g = 0; g < groups.size(); ++g) {
    const FacetNumber* facets = groups.facets.data() + groups.offsets[g];
    const Offset cofaces = groups.cofaces(g);
    if (cofaces == 2) {
      neighbors[facets[0]] = facets[1];
      neighbors[facets[1]] = facets[0];
    } else if (cofaces > 2) {
      for (Offset i = 0; i < cofaces; ++i) {
        neighbors[facets[i]] = kBranching;
      }
    }
  }
  return neighbors;
}

OrientedPatches orient_patches(const std::vector<FacetNumber>& neighbors, int arity) {
  const Offset count = static_cast<Offset>(neighbors.size()) / arity;
  OrientedPatches result;
  result.patch.assign(count, -1);
  result.sign.assign(count, 0);
  std::vector<Offset> stack;
  for (Offset seed = 0; seed < count; ++seed) {
    if (result.sign[seed] != 0) {
      continue;
    }
    const auto label = static_cast<Index>(result.sizes.size());
    Offset size = 0;
    bool orientable = true;
    result.sign[seed] = 1;
    result.patch[seed] = label;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const Offset s = stack.back();
      stack.pop_back();
      ++size;
      for (FacetNumber f = s * arity; f < (s + 1) * arity; ++f) {
        const FacetNumber other = neighbors[f];
        if (other < 0) {
          continue;
        }
        const auto wanted = static_cast<std::int8_t>(
            flips_across(f, other, arity) ? -result.sign[s] : result.sign[s]);
        std::int8_t& sign = result.sign[other / arity];
        if (sign == 0) {
          sign = wanted;
          result.patch[other / arity] = label;
          stack.push_back(other / arity);
        } else if (sign != wanted) {
          orientable = false;
        }
      }
    }
    result.sizes.push_back(size);
    result.orientable.push_back(orientable ? 1 : 0);
  }
  return result;
}

}  // namespace remanifold
