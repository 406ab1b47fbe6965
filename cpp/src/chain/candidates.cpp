// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/candidates.hpp"

#include "base/csr.hpp"
#include "base/parallel.hpp"
#include "base/sort_unique.hpp"
#include "complex/clique_expansion.hpp"
#include "complex/simplex_rows.hpp"
#include "remanifold/clique_complex.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <utility>

namespace remanifold::detail {
namespace {

constexpr Offset kBlock = 64;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

template <std::size_t Arity>
void append_faces(const std::vector<std::array<Index, Arity>>& cells, int dim,
                  SimplexArray& out) {
  const int arity = dim + 1;
  for (std::array<Index, Arity> cell : cells) {
    std::sort(cell.begin(), cell.end());
    for (unsigned subset = 0; subset < 1U << Arity; ++subset) {
      if (__builtin_popcount(subset) != arity) {
        continue;
      }
      for (std::size_t i = 0; i < Arity; ++i) {
        if ((subset >> i & 1U) != 0) {
          out.vertices.push_back(cell[i]);
        }
      }
    }
  }
}

/// Calls with the coordinates of each sample and its number, of those that are not here one
/// that no sample has.
template <class Function>
void for_each_point(const Samples& samples, const std::vector<Index>& vertices,
                    const std::vector<double>& elsewhere, Function&& function) {
  for (const Index v : vertices) {
    function(samples.point(v), v);
  }
  const auto dim = static_cast<std::size_t>(samples.ambient_dim());
  for (std::size_t i = 0; i < elsewhere.size(); i += dim) {
    function(elsewhere.data() + i, samples.size());
  }
}

void delaunay_2(const Samples& samples, const std::vector<Index>& vertices,
                const std::vector<double>& elsewhere, int dim, SimplexArray& out) {
  using Vertex = CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>;
  using Structure = CGAL::Triangulation_data_structure_2<Vertex>;
  using Triangulation = CGAL::Delaunay_triangulation_2<Kernel, Structure>;
  const std::vector<int>& axes = samples.varying_axes();
  std::vector<std::pair<Kernel::Point_2, Index>> points;
  for_each_point(samples, vertices, elsewhere, [&](const double* p, Index v) {
    points.emplace_back(Kernel::Point_2(p[axes[0]], p[axes[1]]), v);
  });
  const Triangulation triangulation(points.begin(), points.end());
  std::vector<std::array<Index, 3>> cells;
  for (auto f = triangulation.finite_faces_begin();
       f != triangulation.finite_faces_end(); ++f) {
    cells.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  }
  append_faces(cells, dim, out);
  if (dim == 1 && triangulation.dimension() == 1) {
    for (auto e = triangulation.finite_edges_begin();
         e != triangulation.finite_edges_end(); ++e) {
      const Index a = e->first->vertex(triangulation.cw(e->second))->info();
      const Index b = e->first->vertex(triangulation.ccw(e->second))->info();
      out.vertices.push_back(std::min(a, b));
      out.vertices.push_back(std::max(a, b));
    }
  }
}

void delaunay_3(const Samples& samples, const std::vector<Index>& vertices,
                const std::vector<double>& elsewhere, int dim, SimplexArray& out) {
  using Vertex = CGAL::Triangulation_vertex_base_with_info_3<Index, Kernel>;
  using Cell = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
  using Structure = CGAL::Triangulation_data_structure_3<Vertex, Cell>;
  using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
  const std::vector<int>& axes = samples.varying_axes();
  std::vector<std::pair<Kernel::Point_3, Index>> points;
  for_each_point(samples, vertices, elsewhere, [&](const double* p, Index v) {
    points.emplace_back(Kernel::Point_3(p[axes[0]], p[axes[1]], p[axes[2]]), v);
  });
  const Triangulation triangulation(points.begin(), points.end());
  if (triangulation.dimension() == 3) {
    std::vector<std::array<Index, 4>> cells;
    for (auto c = triangulation.finite_cells_begin();
         c != triangulation.finite_cells_end(); ++c) {
      cells.push_back({c->vertex(0)->info(), c->vertex(1)->info(), c->vertex(2)->info(),
                       c->vertex(3)->info()});
    }
    append_faces(cells, dim, out);
  } else if (triangulation.dimension() == 2 && dim <= 2) {
    std::vector<std::array<Index, 3>> cells;
    for (auto f = triangulation.finite_facets_begin();
         f != triangulation.finite_facets_end(); ++f) {
      std::array<Index, 3> cell{};
      for (int i = 0, k = 0; i < 4; ++i) {
        if (i != f->second) {
          cell[k++] = f->first->vertex(i)->info();
        }
      }
      cells.push_back(cell);
    }
    append_faces(cells, dim, out);
  }
}

}  // namespace

void append_edges(const SimplexArray& simplices,
                  const std::vector<std::uint8_t>& marked, std::vector<Index>& pairs) {
  for (Offset s = 0; s < simplices.size(); ++s) {
    const Index* simplex = simplices[s];
    for (int i = 0; i < simplices.arity; ++i) {
      for (int j = i + 1; j < simplices.arity; ++j) {
        if (marked[simplex[i]] != 0 && marked[simplex[j]] != 0) {
          pairs.push_back(simplex[i]);
          pairs.push_back(simplex[j]);
        }
      }
    }
  }
}

void append_neighbor_edges(const Neighborhoods& neighborhoods, Index count,
                           const std::vector<Index>& vertices,
                           const std::vector<std::uint8_t>& marked,
                           std::vector<Index>& pairs) {
  count = std::min(count, neighborhoods.count);
  for (const Index v : vertices) {
    for (Index k = 0; k < count; ++k) {
      const Index w = neighborhoods.of(v)[k];
      if (marked[w] != 0) {
        pairs.push_back(std::min(v, w));
        pairs.push_back(std::max(v, w));
      }
    }
  }
}

SimplexArray cliques_of(const std::vector<Index>& pairs, int dim, std::size_t max_count,
                        const Execution& execution) {
  std::vector<Index> vertices = pairs;
  sort_unique(vertices);
  const auto number = [&](Index v) {
    return static_cast<Index>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                              vertices.begin());
  };
  const SimplexArray edges = sorted_unique({2, pairs});
  const Csr directed =
      csr_of(static_cast<Offset>(vertices.size()), [&](const auto& add) {
        for (Offset e = 0; e < edges.size(); ++e) {
          add(number(edges[e][0]), number(edges[e][1]));
        }
      });
  const Csr graph = edge_graph(directed, EdgeRule::kEither, execution);
  const Offset n = graph.rows();
  std::vector<std::vector<Index>> blocks((n + kBlock - 1) / kBlock);
  std::atomic<std::size_t> found{0};
  const std::size_t most = max_count * (dim + 1);
  for_each_block_uncounted(n, kBlock, execution, [&](Offset begin, Offset end) {
    CliqueExpansion expansion(graph, dim + 1, execution);
    for (Offset v = begin; v < end && found <= most; ++v) {
      const std::size_t before = blocks[begin / kBlock].size();
      expansion.expand_from(static_cast<Index>(v), blocks[begin / kBlock], most);
      found += blocks[begin / kBlock].size() - before;
    }
  });
  SimplexArray cliques{dim + 1, {}};
  if (found > most) {
    return cliques;
  }
  for (const std::vector<Index>& block : blocks) {
    for (const Index v : block) {
      cliques.vertices.push_back(vertices[v]);
    }
  }
  return cliques;
}

SimplexArray delaunay_faces(const Samples& samples, const std::vector<Index>& vertices,
                            const std::vector<double>& elsewhere, int dim) {
  SimplexArray faces{dim + 1, {}};
  if (samples.varying_axes().size() == 2) {
    delaunay_2(samples, vertices, elsewhere, dim, faces);
  } else if (samples.varying_axes().size() == 3) {
    delaunay_3(samples, vertices, elsewhere, dim, faces);
  }
  if (!elsewhere.empty()) {
    std::vector<std::uint8_t> dropped(faces.size(), 0);
    for (Offset f = 0; f < faces.size(); ++f) {
      dropped[f] =
          *std::max_element(faces[f], faces[f] + faces.arity) < samples.size() ? 0 : 1;
    }
    erase_rows(faces, dropped);
  }
  return sorted_unique(faces);
}

}  // namespace remanifold::detail
