// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/facets.hpp"

#include "detail/dispatch.hpp"
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

/// The rows of an array by the vertex in one column; rows in that order are not copied.
class Buckets {
 public:
  Buckets(const SimplexArray& simplices, int column, Index num_vertices)
      : starts_(static_cast<std::size_t>(num_vertices) + 1, 0) {
    bool sorted = true;
    Index last = 0;
    for (Offset s = 0; s < simplices.size(); ++s) {
      const Index v = simplices[s][column];
      sorted = sorted && v >= last;
      last = v;
      ++starts_[v + 1];
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    if (sorted) {
      return;
    }
    rows_.resize(simplices.size());
    std::vector<Offset> next(starts_.begin(), starts_.end() - 1);
    for (Offset s = 0; s < simplices.size(); ++s) {
      rows_[next[simplices[s][column]]++] = s;
    }
  }

  Offset begin(Offset v) const { return starts_[v]; }
  Offset end(Offset v) const { return starts_[v + 1]; }
  Offset row(Offset i) const { return rows_.empty() ? i : rows_[i]; }

 private:
  std::vector<Offset> starts_;
  std::vector<Offset> rows_;
};

struct Entry {
  Index second;  // vertex of the facet
  FacetNumber facet;
};

/// Sorts facets by their vertices. visit(position, entries, count) is called, in parallel,
/// for each group that has the same, with the group's position in the order of all.
template <class Visit>
void sort_facets(const SimplexArray& simplices, Index num_vertices,
                 const Execution& execution, const Visit& visit) {
  const int arity = simplices.arity;
  const auto vertex_of = [&](FacetNumber f, int position) {
    return facet_vertex(simplices[f / arity], static_cast<int>(f % arity), position);
  };
  // Buckets by the lowest vertex, then each sorted on its own, most by the second alone.
  // A facet's lowest vertex is the first of its simplex or, without that, the second.
  const Buckets by_first(simplices, 0, num_vertices);
  const Buckets by_second(simplices, 1, num_vertices);
  const auto compare = [&](const Entry& a, const Entry& b) {
    if (a.second != b.second) {
      return a.second < b.second ? -1 : 1;
    }
    for (int k = 2; k + 1 < arity; ++k) {
      const Index va = vertex_of(a.facet, k);
      const Index vb = vertex_of(b.facet, k);
      if (va != vb) {
        return va < vb ? -1 : 1;
      }
    }
    return 0;
  };
  detail::for_each_block_uncounted(
      num_vertices, kBlock, execution, [&](Offset begin, Offset end) {
        std::vector<Entry> entries;
        for (Offset v = begin; v < end; ++v) {
          entries.clear();
          const auto add = [&](Offset s, int leave) {
            entries.push_back({arity > 2 ? facet_vertex(simplices[s], leave, 1) : 0,
                               s * arity + leave});
          };
          for (Offset i = by_first.begin(v); i < by_first.end(v); ++i) {
            for (int leave = 1; leave < arity; ++leave) {
              add(by_first.row(i), leave);
            }
          }
          for (Offset i = by_second.begin(v); i < by_second.end(v); ++i) {
            add(by_second.row(i), 0);
          }
          detail::sort_few(entries.begin(), entries.end(),
                           [&](const Entry& a, const Entry& b) {
                             const int order = compare(a, b);
                             return order != 0 ? order < 0 : a.facet < b.facet;
                           });
          const Offset start = by_first.begin(v) * (arity - 1) + by_second.begin(v);
          std::size_t first = 0;
          for (std::size_t i = 1; i <= entries.size(); ++i) {
            if (i == entries.size() || compare(entries[first], entries[i]) != 0) {
              visit(start + static_cast<Offset>(first), entries.data() + first,
                    static_cast<Offset>(i - first));
              first = i;
            }
          }
        }
      });
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
  const std::size_t count = simplices.vertices.size();  // as many facets
  std::vector<std::uint8_t> ends(count + 1, 0);
  FacetGroups groups;
  groups.facets.resize(count);
  sort_facets(simplices, num_vertices, execution,
              [&](Offset position, const Entry* entries, Offset cofaces) {
                for (Offset i = 0; i < cofaces; ++i) {
                  groups.facets[position + i] = entries[i].facet;
                }
                ends[position + cofaces] = 1;
              });
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i] != 0) {
      groups.offsets.push_back(static_cast<Offset>(i));
    }
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
  std::vector<FacetNumber> neighbors(simplices.vertices.size(), kOpen);
  sort_facets(simplices, num_vertices, execution,
              [&](Offset, const Entry* entries, Offset cofaces) {
                if (cofaces == 2) {
                  neighbors[entries[0].facet] = entries[1].facet;
                  neighbors[entries[1].facet] = entries[0].facet;
                } else if (cofaces > 2) {
                  for (Offset i = 0; i < cofaces; ++i) {
                    neighbors[entries[i].facet] = kBranching;
                  }
                }
              });
  return neighbors;
}

namespace {

/// Divisions by a number known to the compiler are what this costs least with.
template <int K>
OrientedPatches orient_simplices(const std::vector<FacetNumber>& neighbors, int dim) {
  const int arity = (K == Eigen::Dynamic ? dim : K) + 1;
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

}  // namespace

OrientedPatches orient_patches(const std::vector<FacetNumber>& neighbors, int arity) {
  return detail::dispatch_dim(arity - 1, [&](auto k) {
    return orient_simplices<decltype(k)::value>(neighbors, arity - 1);
  });
}

}  // namespace remanifold
