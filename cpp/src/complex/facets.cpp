// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/facets.hpp"

#include "base/csr.hpp"
#include "base/dispatch.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "base/signed_sets.hpp"
#include "complex/simplex_rows.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>

namespace remanifold {
namespace {

constexpr Offset kBlock = 4096;

/// Position j of facet i of a simplex, whose i-th vertex is left out.
Index facet_vertex(const Index* simplex, int i, int j) {
  return simplex[j < i ? j : j + 1];
}

struct Entry {
  Index second;  // vertex of the facet
  FacetNumber facet;
};

/// Sorts entries, equal ones by their number.
template <class Compare>
void sort_entries(std::vector<Entry>& entries, const Compare& compare) {
  detail::sort_few(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
    const int order = compare(a, b);
    return order != 0 ? order < 0 : a.facet < b.facet;
  });
}

/// Visits each group of equal ones among sorted entries.
/// \param start  position of the first
template <class Compare, class Visit>
void visit_groups(const std::vector<Entry>& entries, const Compare& compare,
                  Offset start, const Visit& visit) {
  std::size_t first = 0;
  for (std::size_t i = 1; i <= entries.size(); ++i) {
    if (i == entries.size() || compare(entries[first], entries[i]) != 0) {
      visit(start + static_cast<Offset>(first), entries.data() + first,
            static_cast<Offset>(i - first));
      first = i;
    }
  }
}

/// The same as sort_facets() without a look at vertices that have none.
template <class Visit>
void sort_few_facets(const SimplexArray& simplices, const Visit& visit) {
  const int arity = simplices.arity;
  std::vector<Entry> entries;
  entries.reserve(simplices.vertices.size());
  for (FacetNumber f = 0; f < simplices.size() * arity; ++f) {
    entries.push_back({0, f});
  }
  const auto compare = [&](const Entry& a, const Entry& b) {
    const Index* row_a = simplices[a.facet / arity];
    const Index* row_b = simplices[b.facet / arity];
    for (int k = 0; k + 1 < arity; ++k) {
      const Index va = facet_vertex(row_a, static_cast<int>(a.facet % arity), k);
      const Index vb = facet_vertex(row_b, static_cast<int>(b.facet % arity), k);
      if (va != vb) {
        return va < vb ? -1 : 1;
      }
    }
    return 0;
  };
  sort_entries(entries, compare);
  visit_groups(entries, compare, 0, visit);
}

/// The entries of one bucket of triangles, sorted: as numbers that hold both members, which
/// takes half the time.
class TriangleEntries {
 public:
  static bool can_hold(const SimplexArray& triangles) {
    return triangles.arity == 3 &&
           triangles.vertices.size() <= std::numeric_limits<std::uint32_t>::max();
  }

  void clear() { keys_.clear(); }
  void add(Index second, FacetNumber facet) {
    keys_.push_back(static_cast<std::uint64_t>(second) << 32 |
                    static_cast<std::uint64_t>(facet));
  }
  void sort_into(std::vector<Entry>& entries) {
    detail::sort_few(keys_.begin(), keys_.end(), std::less<>());
    entries.resize(keys_.size());
    std::transform(keys_.begin(), keys_.end(), entries.begin(), [](std::uint64_t key) {
      return Entry{static_cast<Index>(key >> 32),
                   static_cast<FacetNumber>(key & 0xffffffffU)};
    });
  }

 private:
  std::vector<std::uint64_t> keys_;
};

/// Sorts facets by their vertices. visit(position, entries, count) is called, in parallel,
/// for each group that has the same, with the group's position in the order of all.
template <class Visit>
void sort_facets(const SimplexArray& simplices, Index num_vertices,
                 const Execution& execution, const Visit& visit) {
  if (simplices.size() < num_vertices / detail::kSparse) {
    sort_few_facets(simplices, visit);
    return;
  }
  const int arity = simplices.arity;
  const auto vertex_of = [&](FacetNumber f, int position) {
    return facet_vertex(simplices[f / arity], static_cast<int>(f % arity), position);
  };
  // Buckets by the lowest vertex, then each sorted on its own, most by the second alone.
  // A facet's lowest vertex is the first of its simplex or, without that, the second.
  const detail::Buckets by_first(simplices, 0, num_vertices, execution);
  const detail::Buckets by_second(simplices, 1, num_vertices, execution);
  const bool packed = TriangleEntries::can_hold(simplices);
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
        TriangleEntries triangle_entries;
        for (Offset v = begin; v < end; ++v) {
          const Offset start = by_first.begin(v) * (arity - 1) + by_second.begin(v);
          entries.clear();
          if (packed) {
            triangle_entries.clear();
            for (Offset i = by_first.begin(v); i < by_first.end(v); ++i) {
              const Offset s = by_first.row(i);
              triangle_entries.add(simplices[s][2], 3 * s + 1);
              triangle_entries.add(simplices[s][1], 3 * s + 2);
            }
            for (Offset i = by_second.begin(v); i < by_second.end(v); ++i) {
              const Offset s = by_second.row(i);
              triangle_entries.add(simplices[s][2], 3 * s);
            }
            triangle_entries.sort_into(entries);
            visit_groups(entries, compare, start, visit);
            continue;
          }
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
          sort_entries(entries, compare);
          visit_groups(entries, compare, start, visit);
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
  groups.offsets.reserve(1 + std::count(ends.begin(), ends.end(), 1));
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i] != 0) {
      groups.offsets.push_back(static_cast<Offset>(i));
    }
  }
  return groups;
}

UnpairedFacets unpaired_facets(const SimplexArray& simplices,
                               const std::vector<std::uint8_t>& inside,
                               const Execution& execution) {
  // Few, beside all facets in groups.
  struct Found {
    Offset position;
    FacetNumber facet;
    bool open;
  };
  struct Scratch {
    std::vector<Found> found;
    std::vector<Index> facet;
  };
  const int dim = simplices.arity - 1;
  detail::ThreadScratch<Scratch> scratch([&] {
    return Scratch{{}, std::vector<Index>(dim)};
  });
  sort_facets(simplices, static_cast<Index>(inside.size()), execution,
              [&](Offset position, const Entry* entries, Offset cofaces) {
                if (cofaces == 2) {
                  return;
                }
                scratch.use([&](Scratch& local) {
                  copy_facet(simplices, entries[0].facet, local.facet.data());
                  if (std::all_of(local.facet.begin(), local.facet.end(),
                                  [&](Index v) { return inside[v] != 0; })) {
                    local.found.push_back({position, entries[0].facet, cofaces == 1});
                  }
                });
              });
  std::vector<Found> all;
  scratch.for_each([&](const Scratch& local) {
    all.insert(all.end(), local.found.begin(), local.found.end());
  });
  std::sort(all.begin(), all.end(),
            [](const Found& a, const Found& b) { return a.position < b.position; });
  UnpairedFacets result;
  result.open.arity = result.branching.arity = dim;
  std::vector<Index> facet(dim);
  for (const Found& found : all) {
    copy_facet(simplices, found.facet, facet.data());
    detail::append_row(found.open ? result.open : result.branching, facet.data());
  }
  return result;
}

SimplexArray edges_of(const SimplexArray& simplices, Index num_vertices) {
  const int arity = simplices.arity;
  // By the lower end.
  Csr upper = detail::csr_of(num_vertices, [&](const auto& add) {
    for (Offset s = 0; s < simplices.size(); ++s) {
      for (int i = 0; i < arity; ++i) {
        for (int j = i + 1; j < arity; ++j) {
          add(std::min(simplices[s][i], simplices[s][j]),
              std::max(simplices[s][i], simplices[s][j]));
        }
      }
    }
  });
  SimplexArray edges{2, {}};
  for (Index v = 0; v < num_vertices; ++v) {
    const auto first = upper.indices.begin() + upper.offsets[v];
    const auto last = upper.indices.begin() + upper.offsets[v + 1];
    std::sort(first, last);
    const auto end = std::unique(first, last);
    for (auto w = first; w != end; ++w) {
      edges.vertices.push_back(v);
      edges.vertices.push_back(*w);
    }
  }
  return edges;
}

template <class Number>
std::vector<Number> facet_neighbors(const SimplexArray& simplices, Index num_vertices,
                                    const Execution& execution) {
  std::vector<Number> neighbors(simplices.vertices.size(), Number{kOpen});
  sort_facets(simplices, num_vertices, execution,
              [&](Offset, const Entry* entries, Offset cofaces) {
                if (cofaces == 2) {
                  neighbors[entries[0].facet] = static_cast<Number>(entries[1].facet);
                  neighbors[entries[1].facet] = static_cast<Number>(entries[0].facet);
                } else if (cofaces > 2) {
                  for (Offset i = 0; i < cofaces; ++i) {
                    neighbors[entries[i].facet] = Number{kBranching};
                  }
                }
              });
  return neighbors;
}

template std::vector<std::int32_t> facet_neighbors(const SimplexArray&, Index,
                                                   const Execution&);
template std::vector<FacetNumber> facet_neighbors(const SimplexArray&, Index,
                                                  const Execution&);

namespace {

/// Simplices of one task.
constexpr Offset kPatchBlock = 1 << 15;

/// Blocks of simplices each on their own, then across blocks. Divisions by a number known
/// to the compiler are what this costs least with.
/// \returns nothing where some patch has no orientation
template <int K, class Number>
std::optional<OrientedPatches> orient_all(const std::vector<Number>& neighbors, int dim,
                                          const Execution& execution) {
  const int arity = (K == Eigen::Dynamic ? dim : K) + 1;
  const Offset count = static_cast<Offset>(neighbors.size()) / arity;
  detail::SignedSets<Number> sets(count);
  struct Block {
    std::vector<FacetNumber> across;
    bool orientable = true;
  };
  std::vector<Block> blocks((count + kPatchBlock - 1) / kPatchBlock);
  const auto join = [&](FacetNumber a, FacetNumber b) {
    return sets.join(a / arity, b / arity, flips_across(a, b, arity) ? -1 : 1);
  };
  detail::for_each_block_uncounted(
      count, kPatchBlock, execution, [&](Offset begin, Offset end) {
        Block& block = blocks[begin / kPatchBlock];
        for (FacetNumber f = begin * arity; f < end * arity; ++f) {
          const FacetNumber other = neighbors[f];
          if (other >= end * arity) {
            block.across.push_back(f);
          } else if (other > f) {
            block.orientable = join(f, other) && block.orientable;
          }
        }
      });
  for (const Block& block : blocks) {
    bool orientable = block.orientable;
    for (const FacetNumber f : block.across) {
      orientable = join(f, neighbors[f]) && orientable;
    }
    if (!orientable) {
      return std::nullopt;
    }
  }
  OrientedPatches result;
  result.patch.resize(count);
  result.sign.resize(count);
  for (Offset s = 0; s < count; ++s) {
    const Offset parent = sets.parent(s);
    if (parent == s) {
      result.patch[s] = static_cast<Index>(result.sizes.size());
      result.sign[s] = 1;
      result.sizes.push_back(0);
      result.closed.push_back(1);
    } else {
      result.patch[s] = result.patch[parent];
      result.sign[s] = static_cast<std::int8_t>(sets.sign(s) * result.sign[parent]);
    }
    ++result.sizes[result.patch[s]];
    for (FacetNumber f = s * arity; f < (s + 1) * arity; ++f) {
      if (neighbors[f] == kOpen) {
        result.closed[result.patch[s]] = 0;
      }
    }
  }
  result.orientable.assign(result.sizes.size(), 1);
  return result;
}

/// One simplex after the other along facets: the signs where there is no orientation depend
/// on the way.
template <int K, class Number>
OrientedPatches walk_patches(const std::vector<Number>& neighbors, int dim) {
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
    bool closed = true;
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
          closed = closed && other != kOpen;
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
    result.closed.push_back(closed ? 1 : 0);
  }
  return result;
}

}  // namespace

template <class Number>
OrientedPatches orient_patches(const std::vector<Number>& neighbors, int arity,
                               const Execution& execution) {
  return detail::dispatch_dim(arity - 1, [&](auto k) {
    constexpr int dim = decltype(k)::value;
    std::optional<OrientedPatches> patches =
        orient_all<dim>(neighbors, arity - 1, execution);
    return patches ? std::move(*patches) : walk_patches<dim>(neighbors, arity - 1);
  });
}

template OrientedPatches orient_patches(const std::vector<std::int32_t>&, int,
                                        const Execution&);
template OrientedPatches orient_patches(const std::vector<FacetNumber>&, int,
                                        const Execution&);

OrientedPatches orient_patches(const SimplexArray& simplices, Index num_vertices,
                               const Execution& execution) {
  const auto orient = [&](auto number) {
    return orient_patches(
        facet_neighbors<decltype(number)>(simplices, num_vertices, execution),
        simplices.arity, execution);
  };
  return has_few_facets(simplices) ? orient(std::int32_t{}) : orient(FacetNumber{});
}

std::optional<OrientedPatches> extend_patches(const SimplexArray& known,
                                              Offset num_known,
                                              const OrientedPatches& patches,
                                              const SimplexArray& simplices,
                                              const std::vector<std::uint8_t>& around,
                                              const Execution& execution) {
  const int arity = simplices.arity;
  const Offset count = simplices.size();
  // Nodes: the known patches, and each new simplex on its own.
  auto num_nodes = static_cast<Offset>(patches.sizes.size());
  std::vector<Index> node(count);
  std::vector<std::int8_t> sign(count, 1);
  Offset next = 0;
  for (Offset s = 0; s < count; ++s) {
    const Index* simplex = simplices[s];
    if (next < num_known && detail::row_equal(known[next], simplex, arity)) {
      node[s] = patches.patch[next];
      sign[s] = patches.sign[next];
      ++next;
    } else {
      node[s] = static_cast<Index>(num_nodes++);
    }
  }
  if (next < num_known) {
    return std::nullopt;
  }
  detail::SignedSets<Offset> sets(num_nodes);
  std::vector<std::uint8_t> twisted(num_nodes, 0);
  std::vector<std::uint8_t> open(num_nodes, 0);
  for (std::size_t p = 0; p < patches.orientable.size(); ++p) {
    twisted[p] = patches.orientable[p] == 0 ? 1 : 0;
  }
  const std::vector<Offset> rows =
      detail::rows_near(simplices, around, arity - 1, execution);
  const SimplexArray near = detail::select_rows(simplices, rows);
  const FacetGroups groups =
      group_facets(near, static_cast<Index>(around.size()), execution);
  std::vector<Index> facet(arity - 1);
  for (Offset g = 0; g < groups.size(); ++g) {
    const FacetNumber* facets = groups.facets.data() + groups.offsets[g];
    const Offset a = rows[facets[0] / arity];
    copy_facet(near, facets[0], facet.data());
    if (!std::all_of(facet.begin(), facet.end(),
                     [&](Index v) { return around[v] != 0; })) {
      continue;
    }
    if (groups.cofaces(g) == 1) {
      open[node[a]] = 1;
    } else if (groups.cofaces(g) == 2) {
      const Offset b = rows[facets[1] / arity];
      const int flip = flips_across(facets[0], facets[1], arity) ? -1 : 1;
      if (!sets.join(node[a], node[b], flip * sign[a] * sign[b])) {
        twisted[node[a]] = 1;
      }
    }
  }

  OrientedPatches result;
  result.patch.resize(count);
  result.sign.resize(count);
  std::vector<Index> label(num_nodes, -1);      // of each root
  std::vector<std::int8_t> turn(num_nodes, 1);  // so that the first of a patch is +1
  std::vector<std::pair<Offset, int>> root(num_nodes);
  for (Offset n = 0; n < num_nodes; ++n) {
    root[n] = sets.find(n);
  }
  for (Offset s = 0; s < count; ++s) {
    const auto [r, relative] = root[node[s]];
    const int own = relative * sign[s];
    if (label[r] < 0) {
      label[r] = static_cast<Index>(result.sizes.size());
      turn[r] = static_cast<std::int8_t>(own);
      result.sizes.push_back(0);
      result.orientable.push_back(1);
      result.closed.push_back(1);
    }
    result.patch[s] = label[r];
    result.sign[s] = static_cast<std::int8_t>(own * turn[r]);
    ++result.sizes[label[r]];
  }
  for (Offset n = 0; n < num_nodes; ++n) {
    const Index patch = label[root[n].first];
    if (patch >= 0) {
      result.orientable[patch] = result.orientable[patch] != 0 && twisted[n] == 0;
      result.closed[patch] = result.closed[patch] != 0 && open[n] == 0;
    }
  }
  return result;
}

}  // namespace remanifold
