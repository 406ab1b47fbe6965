// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/topology.hpp"

#include "base/csr.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "complex/simplex_rows.hpp"
#include "remanifold/facets.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

/// Columns of a simplex of the given arity that make up each of its faces; for facets
/// the i-th face leaves out column i.
std::vector<std::vector<int>> face_columns(int arity, int face_arity) {
  std::vector<std::vector<int>> result;
  std::vector<int> columns(face_arity);
  std::iota(columns.begin(), columns.end(), 0);
  for (;;) {
    result.push_back(columns);
    int i = face_arity - 1;
    while (i >= 0 && columns[i] == arity - face_arity + i) {
      --i;
    }
    if (i < 0) {
      break;
    }
    ++columns[i];
    for (int j = i + 1; j < face_arity; ++j) {
      columns[j] = columns[j - 1] + 1;
    }
  }
  std::reverse(result.begin(), result.end());
  return result;
}

/// Every face once, with the simplices that have it. An instance s * faces_per_simplex + i
/// is the i-th face of simplex s.
struct FaceTable {
  SimplexArray faces;
  Offset faces_per_simplex = 0;
  std::vector<Offset> offsets{0};
  std::vector<Offset> instances;

  Offset size() const { return static_cast<Offset>(offsets.size()) - 1; }
  Offset cofaces(Offset face) const { return offsets[face + 1] - offsets[face]; }
};

/// Where there are about as many vertices as faces, sorts them into buckets by the first
/// vertex, then each bucket on its own.
template <class Instance>
void sort_by_face(std::vector<Instance>& instances) {
  Index last = -1;
  for (const Instance& instance : instances) {
    last = std::max(last, instance.face[0]);
  }
  if (last < 0 || static_cast<std::size_t>(last) > instances.size()) {
    std::sort(instances.begin(), instances.end());
    return;
  }
  detail::Ragged<Instance> sorted =
      detail::ragged_of<Instance>(Offset{last} + 1, [&](const auto& add) {
        for (const Instance& instance : instances) {
          add(instance.face[0], instance);
        }
      });
  for (Offset v = 0; v < sorted.rows(); ++v) {
    std::sort(sorted.values.begin() + sorted.offsets[v],
              sorted.values.begin() + sorted.offsets[v + 1]);
  }
  instances.swap(sorted.values);
}

/// \tparam Arity  at least that of the table; columns beyond that are padding
template <int Arity>
void group_faces(const SimplexArray& simplices,
                 const std::vector<std::vector<int>>& columns, FaceTable& table) {
  struct Instance {
    std::array<Index, Arity> face;
    Offset number;
    bool operator<(const Instance& other) const {
      return face != other.face ? face < other.face : number < other.number;
    }
  };
  std::vector<Instance> instances;
  instances.reserve(simplices.size() * columns.size());
  for (Offset s = 0; s < simplices.size(); ++s) {
    for (const std::vector<int>& face : columns) {
      Instance instance{{}, static_cast<Offset>(instances.size())};
      for (int i = 0; i < Arity; ++i) {
        instance.face[i] = simplices[s][face[i]];
      }
      instances.push_back(instance);
    }
  }
  sort_by_face(instances);
  table.instances.resize(instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i) {
    table.instances[i] = instances[i].number;
    if (i + 1 == instances.size() || instances[i].face != instances[i + 1].face) {
      table.offsets.push_back(static_cast<Offset>(i) + 1);
      detail::append_row(table.faces, instances[i].face.data());
    }
  }
}

FaceTable make_face_table(const SimplexArray& simplices, int dim) {
  FaceTable table;
  table.faces.arity = dim + 1;
  const std::vector<std::vector<int>> columns =
      face_columns(simplices.arity, table.faces.arity);
  table.faces_per_simplex = static_cast<Offset>(columns.size());
  switch (table.faces.arity) {
    case 1:
      group_faces<1>(simplices, columns, table);
      break;
    case 2:
      group_faces<2>(simplices, columns, table);
      break;
    case 3:
      group_faces<3>(simplices, columns, table);
      break;
    case 4:
      group_faces<4>(simplices, columns, table);
      break;
    default: {
      // Arity beyond four is rare and small: pad to sixteen.
      constexpr int padded = 16;
      if (table.faces.arity > padded) {
        throw std::invalid_argument("faces of more than 16 vertices are not supported");
      }
      const int arity = table.faces.arity;
      SimplexArray wide{padded, {}};
      std::vector<std::vector<int>> identity(1, std::vector<int>(padded));
      std::iota(identity[0].begin(), identity[0].end(), 0);
      for (Offset s = 0; s < simplices.size(); ++s) {
        for (const std::vector<int>& face : columns) {
          for (int i = 0; i < padded; ++i) {
            wide.vertices.push_back(i < arity ? simplices[s][face[i]] : -1);
          }
        }
      }
      group_faces<padded>(wide, identity, table);
    }
  }
  return table;
}

Offset euler_characteristic(const std::vector<Offset>& face_counts) {
  Offset result = 0;
  for (std::size_t d = 0; d < face_counts.size(); ++d) {
    result += d % 2 == 0 ? face_counts[d] : -face_counts[d];
  }
  return result;
}

/// The faces opposite to vertex number v of the table of vertices.
SimplexArray link_of(const SimplexArray& simplices, const FaceTable& vertices,
                     Offset v) {
  const Index vertex = vertices.faces[v][0];
  SimplexArray link{simplices.arity - 1, {}};
  link.vertices.reserve(vertices.cofaces(v) * link.arity);
  for (Offset i = vertices.offsets[v]; i < vertices.offsets[v + 1]; ++i) {
    const Index* simplex = simplices[vertices.instances[i] / simplices.arity];
    std::copy_if(simplex, simplex + simplices.arity, std::back_inserter(link.vertices),
                 [&](Index w) { return w != vertex; });
  }
  return link;
}

bool is_connected(const SimplexArray& simplices) {
  const FaceTable vertices = make_face_table(simplices, 0);
  detail::DisjointSets sets(simplices.size());
  for (Offset v = 0; v < vertices.size(); ++v) {
    const Offset first = vertices.instances[vertices.offsets[v]] / simplices.arity;
    for (Offset i = vertices.offsets[v]; i < vertices.offsets[v + 1]; ++i) {
      sets.join(first, vertices.instances[i] / simplices.arity);
    }
  }
  for (Offset s = 0; s < simplices.size(); ++s) {
    if (sets.find(s) != 0) {
      return false;
    }
  }
  return true;
}

/// A connected graph of degrees one and two.
bool is_path_or_cycle(const SimplexArray& graph) {
  std::vector<Index> ends = graph.vertices;
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 2; i < ends.size(); ++i) {
    if (ends[i] == ends[i - 2]) {
      return false;
    }
  }
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  detail::DisjointSets sets(static_cast<Offset>(ends.size()));
  const auto number = [&](Index v) {
    return std::lower_bound(ends.begin(), ends.end(), v) - ends.begin();
  };
  std::size_t tree_edges = 0;
  for (Offset e = 0; e < graph.size(); ++e) {
    const Offset a = sets.find(number(graph[e][0]));
    const Offset b = sets.find(number(graph[e][1]));
    if (a != b) {
      sets.join(a, b);
      ++tree_edges;
    }
  }
  return tree_edges + 1 == ends.size();
}

/// The vertices of the table that are marked and have links that are neither spheres nor
/// balls.
/// \param for_each_block  runs a body(begin, end) on all of the table
template <class Loop>
std::vector<Index> find_singular(const SimplexArray& simplices,
                                 const FaceTable& vertices,
                                 const std::vector<std::uint8_t>& marked,
                                 const Loop& for_each_block) {
  std::vector<std::uint8_t> singular(vertices.size(), 0);
  for_each_block([&](Offset begin, Offset end) {
    for (Offset v = begin; v < end; ++v) {
      if (marked[vertices.faces[v][0]] != 0) {
        singular[v] = is_sphere_or_ball(link_of(simplices, vertices, v)) ? 0 : 1;
      }
    }
  });
  std::vector<Index> result;
  for (Offset v = 0; v < vertices.size(); ++v) {
    if (singular[v] != 0) {
      result.push_back(vertices.faces[v][0]);
    }
  }
  return result;
}

void validate(const SimplexArray& simplices, Index num_vertices) {
  if (simplices.arity < 2) {
    throw std::invalid_argument("simplices have " + std::to_string(simplices.arity) +
                                " vertices each, expected at least 2");
  }
  if (num_vertices < 0) {
    throw std::invalid_argument("num_vertices is negative");
  }
  for (Offset s = 0; s < simplices.size(); ++s) {
    const Index* simplex = simplices[s];
    for (int i = 0; i < simplices.arity; ++i) {
      if (simplex[i] < 0 || simplex[i] >= num_vertices) {
        throw std::invalid_argument("simplices[" + std::to_string(s) + ", " +
                                    std::to_string(i) + "] is " +
                                    std::to_string(simplex[i]) + ", expected 0 to " +
                                    std::to_string(num_vertices - 1));
      }
      if (i > 0 && simplex[i - 1] >= simplex[i]) {
        throw std::invalid_argument("simplices[" + std::to_string(s) +
                                    "] does not ascend");
      }
    }
  }
}

/// Patches: simplices connected through facets with two cofaces.
struct Patches {
  Index closed = 0;
  Index closed_orientable = 0;
  bool orientable = true;
};

Patches find_patches(const SimplexArray& simplices, const FaceTable& facets) {
  const int arity = simplices.arity;
  std::vector<FacetNumber> neighbors(simplices.vertices.size(), kOpen);
  for (Offset f = 0; f < facets.size(); ++f) {
    if (facets.cofaces(f) == 2) {
      const Offset a = facets.instances[facets.offsets[f]];
      const Offset b = facets.instances[facets.offsets[f] + 1];
      neighbors[a] = b;
      neighbors[b] = a;
    }
  }
  const OrientedPatches oriented = orient_patches(neighbors, arity);
  Patches patches;
  for (std::size_t p = 0; p < oriented.sizes.size(); ++p) {
    const bool closed = oriented.closed[p] != 0;
    const bool orientable = oriented.orientable[p] != 0;
    patches.closed += closed ? 1 : 0;
    patches.closed_orientable += closed && orientable ? 1 : 0;
    patches.orientable = patches.orientable && orientable;
  }
  return patches;
}

}  // namespace

bool is_sphere_or_ball(const SimplexArray& link) {
  const int dim = link.arity - 1;
  if (dim == 0) {
    return link.size() <= 2;
  }
  if (dim == 1) {
    return is_path_or_cycle(link);
  }
  std::vector<Offset> counts;
  bool closed = true;
  for (int d = 0; d <= dim; ++d) {
    const FaceTable table = make_face_table(link, d);
    counts.push_back(table.size());
    if (d == dim - 1) {
      for (Offset f = 0; f < table.size(); ++f) {
        if (table.cofaces(f) > 2) {
          return false;
        }
        closed = closed && table.cofaces(f) == 2;
      }
    }
  }
  const Offset expected = closed && dim % 2 == 0 ? 2 : closed ? 0 : 1;
  if (euler_characteristic(counts) != expected || !is_connected(link)) {
    return false;
  }
  const FaceTable vertices = make_face_table(link, 0);
  for (Offset v = 0; v < vertices.size(); ++v) {
    if (!is_sphere_or_ball(link_of(link, vertices, v))) {
      return false;
    }
  }
  return true;
}

Faces faces_of(const SimplexArray& simplices, int dim, const Execution& execution) {
  if (dim < 0 || dim >= simplices.arity) {
    throw std::invalid_argument("dim is " + std::to_string(dim) + ", expected 0 to " +
                                std::to_string(simplices.arity - 1));
  }
  execution.poll();
  FaceTable table = make_face_table(simplices, dim);
  Faces faces;
  faces.cofaces.resize(table.size());
  for (Offset f = 0; f < table.size(); ++f) {
    faces.cofaces[f] = static_cast<Index>(table.cofaces(f));
  }
  faces.simplices = std::move(table.faces);
  return faces;
}

Components connected_components(const SimplexArray& simplices, Index num_vertices) {
  detail::DisjointSets sets(num_vertices);
  Components result;
  result.labels.assign(num_vertices, -1);
  for (Offset s = 0; s < simplices.size(); ++s) {
    for (int i = 0; i < simplices.arity; ++i) {
      sets.join(simplices[s][0], simplices[s][i]);
      result.labels[simplices[s][i]] = 0;
    }
  }
  for (Index v = 0; v < num_vertices; ++v) {
    if (result.labels[v] < 0) {
      continue;
    }
    const auto root = static_cast<Index>(sets.find(v));
    result.labels[v] = root == v ? result.count++ : result.labels[root];
  }
  return result;
}

Topology compute_topology(const SimplexArray& simplices, Index num_vertices,
                          const Execution& execution) {
  validate(simplices, num_vertices);
  const int dim = simplices.arity - 1;
  detail::begin_step(execution, Step::kTopology, 0);
  Topology result;
  FaceTable facets;
  for (int d = 0; d < dim; ++d) {
    execution.poll();
    FaceTable table = make_face_table(simplices, d);
    result.face_counts.push_back(table.size());
    if (d == dim - 1) {
      facets = std::move(table);
    }
  }
  result.face_counts.push_back(simplices.size());
  result.euler_characteristic = euler_characteristic(result.face_counts);
  result.components = connected_components(simplices, num_vertices).count;

  result.coface_counts.assign(1, 0);
  for (Offset f = 0; f < facets.size(); ++f) {
    const Offset cofaces = facets.cofaces(f);
    if (cofaces >= static_cast<Offset>(result.coface_counts.size())) {
      result.coface_counts.resize(cofaces + 1, 0);
    }
    ++result.coface_counts[cofaces];
  }
  result.pseudomanifold = result.coface_counts.size() <= 3;
  result.closed = simplices.size() > 0 && result.coface_counts.size() == 3 &&
                  result.coface_counts[1] == 0;

  Faces all;
  all.simplices = facets.faces;
  all.cofaces.resize(facets.size());
  for (Offset f = 0; f < facets.size(); ++f) {
    all.cofaces[f] = static_cast<Index>(facets.cofaces(f));
  }
  result.boundary_components = static_cast<Index>(
      find_open_faces(all, std::vector<std::uint8_t>(num_vertices, 0)).hole.size());

  execution.poll();
  const Patches patches = find_patches(simplices, facets);
  result.closed_patches = patches.closed;
  result.closed_orientable_patches = patches.closed_orientable;
  result.orientable = result.pseudomanifold && patches.orientable;

  execution.poll();
  const FaceTable vertices = make_face_table(simplices, 0);
  detail::begin_step(execution, Step::kTopology, vertices.size());
  result.singular_vertices =
      find_singular(simplices, vertices, std::vector<std::uint8_t>(num_vertices, 1),
                    [&](const auto& body) {
                      detail::for_each_block(vertices.size(), 256, execution, body);
                    });
  return result;
}

std::vector<Index> singular_vertices(const SimplexArray& simplices,
                                     const std::vector<std::uint8_t>& marked,
                                     const Execution& execution) {
  const SimplexArray near = detail::select_rows(
      simplices, detail::rows_near(simplices, marked, 1, execution));
  const FaceTable vertices = make_face_table(near, 0);
  return find_singular(near, vertices, marked, [&](const auto& body) {
    detail::for_each_block_uncounted(vertices.size(), 64, execution, body);
  });
}

OpenFaces find_open_faces(const Faces& faces,
                          const std::vector<std::uint8_t>& boundary) {
  OpenFaces result;
  result.faces.arity = faces.simplices.arity;
  for (Offset f = 0; f < faces.simplices.size(); ++f) {
    if (faces.cofaces[f] == 1) {
      detail::append_row(result.faces, faces.simplices[f]);
    }
  }
  const Offset count = result.faces.size();
  detail::DisjointSets sets(count);
  if (result.faces.arity > 1) {
    const FaceTable ridges = make_face_table(result.faces, result.faces.arity - 2);
    for (Offset r = 0; r < ridges.size(); ++r) {
      const Offset first =
          ridges.instances[ridges.offsets[r]] / ridges.faces_per_simplex;
      for (Offset i = ridges.offsets[r]; i < ridges.offsets[r + 1]; ++i) {
        sets.join(first, ridges.instances[i] / ridges.faces_per_simplex);
      }
    }
  }
  result.set.resize(count);
  for (Offset f = 0; f < count; ++f) {
    const Offset root = sets.find(f);
    if (root == f) {
      result.set[f] = static_cast<Index>(result.hole.size());
      result.hole.push_back(1);
    } else {
      result.set[f] = result.set[root];
    }
    const Index* face = result.faces[f];
    if (std::any_of(face, face + result.faces.arity,
                    [&](Index v) { return boundary[v] != 0; })) {
      result.hole[result.set[f]] = 0;
    }
  }
  return result;
}

}  // namespace remanifold
