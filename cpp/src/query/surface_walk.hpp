// SPDX-License-Identifier: GPL-3.0-or-later
// A surface of triangles by one walk around each vertex, from triangle to triangle: whether
// all links are circles and arcs, and then the edges, their triangles and which are open,
// with no edge sorted.
#pragma once

#include "base/parallel.hpp"
#include "base/parallel_csr.hpp"
#include "base/prefetch.hpp"
#include "remanifold/facets.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <utility>
#include <vector>

namespace remanifold::detail {

/// \tparam Number  of facets, as of facet_neighbors()
template <class Number>
struct SurfaceWalk {
  Offset num_vertices = 0;
  Offset num_edges = 0;
  SimplexArray open_edges{2, {}};
  std::vector<Number> neighbors;  ///< what facet_neighbors() gives
};

/// The triangles around one vertex. One for each thread.
class UmbrellaWalk {
 public:
  /// More triangles at a vertex are left to others.
  static constexpr std::size_t kMost = 512;

  /// \param ends    of the edges opposite to the vertex, two by two
  /// \param pair    called with two places in `ends` that are the same vertex
  /// \param open    called with a place whose vertex has no other
  /// \returns whether the edges make one circle or one arc
  template <class Pair, class Open>
  bool walk(std::size_t num_edges, const Pair& pair, const Open& open) {
    padded_ = (2 * num_edges + kLanes - 1) / kLanes * kLanes;
    std::fill(ends.begin() + static_cast<std::ptrdiff_t>(2 * num_edges),
              ends.begin() + static_cast<std::ptrdiff_t>(padded_), Index{-1});
    std::size_t passed = 1;
    // From the second end of the first edge, then from the first.
    for (const std::size_t start : {std::size_t{1}, std::size_t{0}}) {
      std::size_t at = start;
      for (;;) {
        const auto [count, sum] = places_of(ends[at]);
        if (count > 2) {
          return false;
        }
        if (count == 1) {
          open(at);
          break;
        }
        const std::size_t other = static_cast<std::size_t>(sum) - at;
        pair(at, other);
        if (other / 2 == 0) {
          return other == 0 && passed == num_edges;  // around
        }
        if (++passed > num_edges) {
          return false;
        }
        at = other ^ 1U;
      }
    }
    return passed == num_edges;
  }

  std::array<Index, 2 * kMost> ends;

 private:
  static constexpr std::size_t kLanes = 4;

  struct Places {
    std::int32_t count;
    std::int32_t sum;
  };
  Places places_of(Index vertex) const {
    std::int32_t counts[kLanes] = {};
    std::int32_t sums[kLanes] = {};
    for (std::size_t j = 0; j < padded_; j += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::int32_t same = ends[j + lane] == vertex ? -1 : 0;
        counts[lane] -= same;
        sums[lane] += same & static_cast<std::int32_t>(j + lane);
      }
    }
    return {(counts[0] + counts[1]) + (counts[2] + counts[3]),
            (sums[0] + sums[1]) + (sums[2] + sums[3])};
  }

  std::size_t padded_ = 0;
};

/// \param triangles       with ascending columns
/// \returns nothing where some link is neither a circle nor an arc, or too large
template <class Number>
std::optional<SurfaceWalk<Number>> walk_surface(const SimplexArray& triangles,
                                                Index num_vertices,
                                                const Execution& execution) {
  // Each vertex with the facets opposite to it.
  const auto stars = ragged_of<Number>(num_vertices, execution, [&](const auto& add) {
    const auto count = static_cast<FacetNumber>(triangles.vertices.size());
    for (FacetNumber f = 0; f < count; ++f) {
      add(triangles.vertices[f], static_cast<Number>(f));
    }
  });
  SurfaceWalk<Number> result;
  result.neighbors.assign(triangles.vertices.size(), Number{kOpen});
  std::atomic<bool> good{true};
  std::atomic<Offset> num_used{0};
  std::atomic<Offset> num_edges{0};
  constexpr Offset block = 1024;
  std::vector<std::vector<Index>> open_edges(num_vertices / block + 1);
  for_each_block(num_vertices, block, execution, [&](Offset begin, Offset end) {
    std::vector<Index>& open = open_edges[begin / block];
    UmbrellaWalk umbrella;
    std::array<Number, 2 * UmbrellaWalk::kMost> facets;
    constexpr Offset ahead = 8;
    Offset used = 0;
    Offset edges = 0;
    for (Offset v = begin; v < end && good.load(std::memory_order_relaxed); ++v) {
      // Numbers of vertices may say nothing of where their triangles are in memory.
      if (v + ahead < end) {
        for (const Number* f = stars.begin(v + ahead); f != stars.end(v + ahead); ++f) {
          prefetch(triangles.vertices.data() + *f);
          prefetch(result.neighbors.data() + *f);
        }
      }
      const auto size = static_cast<std::size_t>(stars.size(v));
      if (size == 0) {
        continue;
      }
      ++used;
      if (size > UmbrellaWalk::kMost) {
        good = false;
        break;
      }
      for (std::size_t k = 0; k < size; ++k) {
        const Number opposite = stars.begin(v)[k];
        const Number triangle = opposite / 3;
        const int own = static_cast<int>(opposite % 3);
        const int first = own == 0 ? 1 : 0;
        const int second = own == 2 ? 1 : 2;
        umbrella.ends[2 * k] = triangles[triangle][first];
        umbrella.ends[2 * k + 1] = triangles[triangle][second];
        // The facet on the way to one end leaves out the other.
        facets[2 * k] = static_cast<Number>(3 * triangle + second);
        facets[2 * k + 1] = static_cast<Number>(3 * triangle + first);
      }
      // Each edge at its lower end.
      const bool whole = umbrella.walk(
          size,
          [&](std::size_t a, std::size_t b) {
            if (umbrella.ends[a] > v) {
              ++edges;
              result.neighbors[facets[a]] = facets[b];
              result.neighbors[facets[b]] = facets[a];
            }
          },
          [&](std::size_t a) {
            if (umbrella.ends[a] > v) {
              ++edges;
              open.push_back(static_cast<Index>(v));
              open.push_back(umbrella.ends[a]);
            }
          });
      if (!whole) {
        good = false;
      }
    }
    num_used += used;
    num_edges += edges;
  });
  if (!good) {
    return std::nullopt;
  }
  result.num_vertices = num_used;
  result.num_edges = num_edges;
  for (const std::vector<Index>& edges : open_edges) {
    result.open_edges.vertices.insert(result.open_edges.vertices.end(), edges.begin(),
                                      edges.end());
  }
  return result;
}

}  // namespace remanifold::detail
