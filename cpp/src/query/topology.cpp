// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/topology.hpp"

#include "base/disjoint_sets.hpp"
#include "base/mix_bits.hpp"
#include "base/parallel.hpp"
#include "base/parallel_csr.hpp"
#include "base/sort_unique.hpp"
#include "complex/simplex_rows.hpp"
#include "query/collapse.hpp"
#include "query/surface_walk.hpp"
#include "remanifold/facets.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace remanifold {
namespace {

/// Vertices whose links one thread looks at, which share what is known of their faces.
constexpr Offset kLinksOfBlock = 256;
/// Links of more vertices than this have no tables of pairs of them.
constexpr std::size_t kMaxTableVertices = 128;

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

/// The face of a simplex opposite to one of its vertices.
void append_opposite(const Index* simplex, Index vertex, SimplexArray& faces) {
  std::copy_if(simplex, simplex + faces.arity + 1, std::back_inserter(faces.vertices),
               [&](Index w) { return w != vertex; });
}

/// What a link is found to be.
struct LinkShape {
  bool good = false;           // a sphere or a ball; all else is known only of those
  bool certain = false;        // and proved to be one
  std::vector<Offset> counts;  // faces by dimension
  Offset num_open = 0;         // facets with one coface
};

/// A connected graph of degrees one and two.
LinkShape shape_of_graph(const SimplexArray& graph) {
  LinkShape shape;
  std::vector<Index> ends = graph.vertices;
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 2; i < ends.size(); ++i) {
    if (ends[i] == ends[i - 2]) {
      return shape;
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
  shape.good = shape.certain = tree_edges + 1 == ends.size();
  shape.counts = {static_cast<Offset>(ends.size()), graph.size()};
  shape.num_open = 2 * (shape.counts[0] - shape.counts[1]);
  return shape;
}

/// Whether triangles are a sphere or a disc: two at most on each edge, one umbrella on each
/// vertex, connected, Euler characteristic 2 or 1. In a flat table of pairs of vertices:
/// with K = 3 every link is asked for.
class SurfaceLink {
 public:
  explicit SurfaceLink(const SimplexArray& triangles) : triangles_(triangles) {
    number_vertices();
  }

  /// The table grows with its square.
  std::size_t num_vertices() const { return num_vertices_; }

  LinkShape shape() {
    LinkShape shape;
    shape.good = shape.certain = fill_edges() && is_sphere_or_disc();
    shape.counts = {static_cast<Offset>(num_vertices_), static_cast<Offset>(num_edges_),
                    triangles_.size()};
    shape.num_open = static_cast<Offset>(num_open_);
    return shape;
  }

 private:
  static constexpr Index kNone = -1;

  struct Edge {
    Index apex[2] = {kNone, kNone};  // of the triangles on it
  };

  bool is_sphere_or_disc() {
    const auto triangles = static_cast<std::size_t>(triangles_.size());
    const bool closed = num_open_ == 0;
    if (num_vertices_ + triangles != num_edges_ + (closed ? 2 : 1)) {
      return false;
    }
    detail::DisjointSets sets(static_cast<Offset>(num_vertices_));
    for (std::size_t v = 0; v < num_vertices_; ++v) {
      if (!is_umbrella(v, sets)) {
        return false;
      }
    }
    for (std::size_t v = 1; v < num_vertices_; ++v) {
      if (sets.find(static_cast<Offset>(v)) != sets.find(0)) {
        return false;
      }
    }
    return true;
  }

  /// From 0 on, in the order in which they come.
  void number_vertices() {
    std::size_t size = 16;
    while (size < triangles_.vertices.size()) {
      size *= 2;
    }
    struct Slot {
      Index vertex = kNone;
      Index number = kNone;
    };
    std::vector<Slot> slots(size);  // a hash table, less than half full
    corners_.reserve(triangles_.vertices.size());
    for (const Index vertex : triangles_.vertices) {
      // Fibonacci hashing: Knuth, The Art of Computer Programming 3, section 6.4.
      std::size_t at = (static_cast<std::uint32_t>(vertex) * 0x9e3779b9U >> 16) % size;
      while (slots[at].number != kNone && slots[at].vertex != vertex) {
        at = (at + 1) % size;
      }
      if (slots[at].number == kNone) {
        slots[at] = {vertex, static_cast<Index>(num_vertices_++)};
      }
      corners_.push_back(slots[at].number);
    }
  }

  Edge& edge(std::size_t a, std::size_t b) { return edges_[a * num_vertices_ + b]; }

  /// \returns false where an edge has more than two triangles, or one twice
  bool fill_edges() {
    edges_.assign(num_vertices_ * num_vertices_, {});
    counts_.assign(num_vertices_, 0);
    for (Offset t = 0; t < triangles_.size(); ++t) {
      const Index* triangle = corners_.data() + 3 * t;
      for (int i = 0; i < 3; ++i) {
        ++counts_[triangle[i]];
        for (int side = 1; side <= 2; ++side) {
          const Index apex = triangle[(i + 3 - side) % 3];
          Edge& across = edge(triangle[i], triangle[(i + side) % 3]);
          if (across.apex[1] != kNone || across.apex[0] == apex) {
            return false;
          }
          across.apex[across.apex[0] == kNone ? 0 : 1] = apex;
        }
      }
    }
    num_edges_ = num_open_ = 0;
    for (const Edge& known : edges_) {
      num_edges_ += known.apex[0] != kNone ? 1 : 0;
      num_open_ += known.apex[0] != kNone && known.apex[1] == kNone ? 1 : 0;
    }
    // Both ways.
    num_edges_ /= 2;
    num_open_ /= 2;
    return true;
  }

  /// Goes around a vertex and joins it to what is there.
  bool is_umbrella(std::size_t v, detail::DisjointSets& sets) {
    Index first = kNone;
    bool open = false;
    for (std::size_t w = 0; w < num_vertices_ && !open; ++w) {
      const Edge& spoke = edge(v, w);
      if (spoke.apex[0] != kNone) {
        open = spoke.apex[1] == kNone;
        first = open || first == kNone ? static_cast<Index>(w) : first;
      }
    }
    Index before = kNone;
    Index at = first;
    int passed = 0;
    do {
      sets.join(static_cast<Offset>(v), at);
      const Edge& spoke = edge(v, at);
      const Index next = spoke.apex[0] == before ? spoke.apex[1] : spoke.apex[0];
      before = at;
      at = next;
      passed += at != kNone ? 1 : 0;
    } while (at != kNone && at != first);
    return passed == counts_[v];
  }

  const SimplexArray& triangles_;
  std::vector<Index> corners_;  // of the triangles, by number
  std::size_t num_vertices_ = 0;
  std::vector<Edge> edges_;  // by both ends, both ways
  std::vector<int> counts_;  // triangles of each vertex
  std::size_t num_edges_ = 0;
  std::size_t num_open_ = 0;
};

/// Shapes of links of faces. The link of a face is that of each of its vertices in the link
/// of the others: what was found for it is found again, until there is too much of it.
class LinkShapes {
 public:
  /// \param certify  whether proof is looked for beyond dimension 2, by collapsing
  explicit LinkShapes(bool certify = false) : certify_(certify) {}

  /// Of the whole, as the link of what is not among its vertices.
  LinkShape of(const SimplexArray& link);

  /// \param link  of a vertex
  LinkShape of_vertex(Index vertex, const SimplexArray& link) {
    if (known_.size() > kMostKnown) {
      known_.clear();
    }
    face_.assign(1, vertex);
    LinkShape shape = of(link);
    face_.clear();
    return shape;
  }

 private:
  static constexpr std::size_t kMostKnown = std::size_t{1} << 18;

  struct HashOfFace {
    std::size_t operator()(const std::vector<Index>& face) const {
      std::uint64_t hash = 0;
      for (const Index v : face) {
        hash = detail::mix_bits(hash ^ static_cast<std::uint64_t>(v));
      }
      return static_cast<std::size_t>(hash);
    }
  };

  LinkShape of_link(const SimplexArray& around, Index vertex) {
    face_.push_back(vertex);
    std::vector<Index> key = face_;
    std::sort(key.begin(), key.end());
    auto at = known_.find(key);
    if (at == known_.end()) {
      LinkShape shape = of(around);
      at = known_.emplace(std::move(key), std::move(shape)).first;
    }
    face_.pop_back();
    return at->second;
  }

  /// Sorted vertices of a link, and what numbers them.
  class Numbering {
   public:
    Numbering(const SimplexArray& link, std::vector<Index>& places) : places_(places) {
      const Index last = *std::max_element(link.vertices.begin(), link.vertices.end());
      if (last >= kMostPlaces) {
        vertices_ = link.vertices;
        detail::sort_unique(vertices_);
        return;
      }
      places_.assign(static_cast<std::size_t>(last) + 1, -1);
      for (const Index v : link.vertices) {
        if (places_[v] < 0) {
          places_[v] = 0;
          vertices_.push_back(v);
        }
      }
      std::sort(vertices_.begin(), vertices_.end());
      for (std::size_t i = 0; i < vertices_.size(); ++i) {
        places_[vertices_[i]] = static_cast<Index>(i);
      }
      has_places_ = true;
    }

    const std::vector<Index>& vertices() const { return vertices_; }
    Offset operator()(Index v) const {
      return has_places_ ? places_[v]
                         : std::lower_bound(vertices_.begin(), vertices_.end(), v) -
                               vertices_.begin();
    }

   private:
    std::vector<Index> vertices_;
    std::vector<Index>& places_;
    bool has_places_ = false;
  };

  /// Of so many samples the place of each is kept: in many dimensions, where there are many
  /// links and few samples, searching for them took most of the time.
  static constexpr Index kMostPlaces = 4096;

  bool certify_;
  std::vector<Index> places_;
  std::vector<Index> face_;  // whose link is looked at
  std::unordered_map<std::vector<Index>, LinkShape, HashOfFace> known_;
};

/// A complex of dimension 2 and more is a sphere or a ball, as far as this is told, where
/// it is connected, the links of its vertices are spheres and balls and the Euler
/// characteristic is that of one. Every face is counted in the links of its vertices.
LinkShape LinkShapes::of(const SimplexArray& link) {
  const int dim = link.arity - 1;
  if (dim == 0) {
    const bool good = link.size() <= 2;
    return {good, good, {link.size()}, link.size() == 1 ? 1 : 0};
  }
  if (dim == 1) {
    return shape_of_graph(link);
  }
  if (dim == 2) {
    SurfaceLink surface(link);
    if (surface.num_vertices() <= kMaxTableVertices) {
      return surface.shape();
    }
  }
  const Numbering number(link, places_);
  const std::vector<Index>& vertices = number.vertices();
  const auto num_vertices = static_cast<Offset>(vertices.size());
  detail::DisjointSets sets(num_vertices);
  const auto stars = detail::ragged_of<Offset>(num_vertices, [&](const auto& add) {
    for (Offset s = 0; s < link.size(); ++s) {
      for (int i = 0; i < link.arity; ++i) {
        add(number(link[s][i]), s);
      }
    }
  });
  std::vector<Offset> last(link.size(), -1);  // vertex of each simplex gone through
  LinkShape shape;
  shape.counts.assign(dim + 1, 0);
  bool parts_are_certain = true;
  SimplexArray around{dim, {}};
  for (Offset v = 0; v < num_vertices; ++v) {
    around.vertices.clear();
    for (const Offset* s = stars.begin(v); s != stars.end(v); ++s) {
      append_opposite(link[*s], vertices[v], around);
      sets.join(last[*s] < 0 ? v : last[*s], v);
      last[*s] = v;
    }
    const LinkShape part = of_link(around, vertices[v]);
    if (!part.good) {
      return shape;
    }
    parts_are_certain = parts_are_certain && part.certain;
    for (int d = 0; d < dim; ++d) {
      shape.counts[d + 1] += part.counts[d];
    }
    shape.num_open += part.num_open;
  }
  shape.counts[0] = num_vertices;
  for (int d = 1; d <= dim; ++d) {
    shape.counts[d] /= d + 1;
  }
  shape.num_open /= dim;
  const bool closed = shape.num_open == 0;
  const Offset expected = closed && dim % 2 == 0 ? 2 : closed ? 0 : 1;
  shape.good = euler_characteristic(shape.counts) == expected;
  for (Offset v = 1; v < num_vertices && shape.good; ++v) {
    shape.good = sets.find(v) == 0;
  }
  if (shape.good && parts_are_certain) {
    shape.certain = dim == 2 || (certify_ && detail::collapses_to_point(link, closed));
  }
  return shape;
}

struct LinkFindings {
  std::vector<Index> singular;   // neither a sphere nor a ball
  std::vector<Index> undecided;  // not proved to be one
};

/// The links of the marked vertices.
/// \tparam Number         counts the simplices
/// \param certify         as of LinkShapes
/// \param for_each_block  runs a body(begin, end) on all vertices
template <class Number, class Loop>
LinkFindings look_by_stars(const SimplexArray& simplices,
                           const std::vector<std::uint8_t>& marked, bool certify,
                           const Execution& execution, const Loop& for_each_block) {
  const auto num_vertices = static_cast<Offset>(marked.size());
  const auto stars =
      detail::ragged_of<Number>(num_vertices, execution, [&](const auto& add) {
        for (Offset s = 0; s < simplices.size(); ++s) {
          for (int i = 0; i < simplices.arity; ++i) {
            if (marked[simplices[s][i]] != 0) {
              add(simplices[s][i], static_cast<Number>(s));
            }
          }
        }
      });
  constexpr std::uint8_t singular = 1;
  constexpr std::uint8_t undecided = 2;
  std::vector<std::uint8_t> found(marked.size(), 0);
  for_each_block([&](Offset begin, Offset end) {
    SimplexArray link{simplices.arity - 1, {}};
    LinkShapes shapes(certify);
    for (Offset v = begin; v < end; ++v) {
      if (stars.size(v) == 0) {
        continue;
      }
      link.vertices.clear();
      for (const Number* s = stars.begin(v); s != stars.end(v); ++s) {
        append_opposite(simplices[*s], static_cast<Index>(v), link);
      }
      const LinkShape shape = shapes.of_vertex(static_cast<Index>(v), link);
      found[v] = !shape.good ? singular : shape.certain ? 0 : undecided;
    }
  });
  LinkFindings result;
  for (Offset v = 0; v < num_vertices; ++v) {
    if (found[v] != 0) {
      (found[v] == singular ? result.singular : result.undecided)
          .push_back(static_cast<Index>(v));
    }
  }
  return result;
}

/// The same; rows of simplices are numbered in 32 bits where that is enough.
template <class Loop>
LinkFindings look_at_links(const SimplexArray& simplices,
                           const std::vector<std::uint8_t>& marked, bool certify,
                           const Execution& execution, const Loop& for_each_block) {
  return has_few_facets(simplices) ? look_by_stars<Index>(simplices, marked, certify,
                                                          execution, for_each_block)
                                   : look_by_stars<Offset>(simplices, marked, certify,
                                                           execution, for_each_block);
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
  Index components = 0;     // of patches that share vertices
  Offset num_vertices = 0;  // of simplices
  Index closed = 0;
  Index closed_orientable = 0;
  bool orientable = true;
};

Patches find_patches(const SimplexArray& simplices, const FacetGroups& facets,
                     Index num_vertices, const Execution& execution) {
  const int arity = simplices.arity;
  std::vector<FacetNumber> neighbors(simplices.vertices.size(), kOpen);
  for (Offset f = 0; f < facets.size(); ++f) {
    if (facets.cofaces(f) == 2) {
      const FacetNumber a = facets.facets[facets.offsets[f]];
      const FacetNumber b = facets.facets[facets.offsets[f] + 1];
      neighbors[a] = b;
      neighbors[b] = a;
    }
  }
  const OrientedPatches oriented = orient_patches(neighbors, arity, execution);
  Patches patches;
  for (std::size_t p = 0; p < oriented.sizes.size(); ++p) {
    const bool closed = oriented.closed[p] != 0;
    const bool orientable = oriented.orientable[p] != 0;
    patches.closed += closed ? 1 : 0;
    patches.closed_orientable += closed && orientable ? 1 : 0;
    patches.orientable = patches.orientable && orientable;
  }
  std::vector<Index> patch_at(num_vertices, -1);
  detail::DisjointSets sets(static_cast<Offset>(oriented.sizes.size()));
  for (Offset s = 0; s < simplices.size(); ++s) {
    for (int i = 0; i < arity; ++i) {
      Index& first = patch_at[simplices[s][i]];
      if (first < 0) {
        first = oriented.patch[s];
        ++patches.num_vertices;
      } else if (first != oriented.patch[s]) {
        sets.join(first, oriented.patch[s]);
      }
    }
  }
  for (std::size_t p = 0; p < oriented.sizes.size(); ++p) {
    const auto own = static_cast<Offset>(p);
    patches.components += sets.find(own) == own ? 1 : 0;
  }
  return patches;
}

/// Connected sets of open facets.
Index count_sets(SimplexArray open, Index num_vertices) {
  const auto count = static_cast<std::size_t>(open.size());
  const Faces faces{std::move(open), std::vector<Index>(count, 1)};
  return static_cast<Index>(
      find_open_faces(faces, std::vector<std::uint8_t>(num_vertices, 0)).hole.size());
}

/// Connected sets of facets with one coface.
Index count_boundaries(const SimplexArray& simplices, const FacetGroups& facets,
                       Index num_vertices) {
  SimplexArray open{simplices.arity - 1, {}};
  std::vector<Index> facet(open.arity);
  for (Offset f = 0; f < facets.size(); ++f) {
    if (facets.cofaces(f) == 1) {
      copy_facet(simplices, facets.facets[facets.offsets[f]], facet.data());
      detail::append_row(open, facet.data());
    }
  }
  return count_sets(std::move(open), num_vertices);
}

/// Of a surface that is a manifold: what most are, and done in half the time.
template <class Number>
std::optional<Topology> topology_of_surface(const SimplexArray& triangles,
                                            Index num_vertices,
                                            const Execution& execution) {
  detail::begin_step(execution, Step::kTopology, num_vertices);
  auto walk = detail::walk_surface<Number>(triangles, num_vertices, execution);
  if (!walk) {
    return std::nullopt;
  }
  execution.poll();
  const OrientedPatches patches = orient_patches(walk->neighbors, 3, execution);
  Topology result;
  // All triangles at a vertex are of one patch.
  result.components = static_cast<Index>(patches.sizes.size());
  result.orientable = true;
  for (std::size_t p = 0; p < patches.sizes.size(); ++p) {
    const bool closed = patches.closed[p] != 0;
    const bool orientable = patches.orientable[p] != 0;
    result.closed_patches += closed ? 1 : 0;
    result.closed_orientable_patches += closed && orientable ? 1 : 0;
    result.orientable = result.orientable && orientable;
  }
  result.face_counts = {walk->num_vertices, walk->num_edges, triangles.size()};
  result.euler_characteristic = euler_characteristic(result.face_counts);
  const Offset num_open = walk->open_edges.size();
  result.coface_counts = {0, num_open, walk->num_edges - num_open};
  while (result.coface_counts.size() > 1 && result.coface_counts.back() == 0) {
    result.coface_counts.pop_back();
  }
  result.pseudomanifold = true;
  result.closed = triangles.size() > 0 && num_open == 0;
  result.boundary_components = count_sets(std::move(walk->open_edges), num_vertices);
  return result;
}

}  // namespace

bool is_sphere_or_ball(const SimplexArray& link) { return LinkShapes().of(link).good; }

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
  if (dim == 2) {
    std::optional<Topology> surface =
        has_few_facets(simplices)
            ? topology_of_surface<std::int32_t>(simplices, num_vertices, execution)
            : topology_of_surface<FacetNumber>(simplices, num_vertices, execution);
    if (surface) {
      return std::move(*surface);
    }
  }
  detail::begin_step(execution, Step::kTopology, 0);
  Topology result;
  const FacetGroups facets = group_facets(simplices, num_vertices, execution);
  execution.poll();
  const Patches patches = find_patches(simplices, facets, num_vertices, execution);
  result.components = patches.components;
  result.closed_patches = patches.closed;
  result.closed_orientable_patches = patches.closed_orientable;

  result.face_counts.push_back(patches.num_vertices);
  for (int d = 1; d + 1 < dim; ++d) {
    execution.poll();
    result.face_counts.push_back(make_face_table(simplices, d).size());
  }
  if (dim > 1) {
    result.face_counts.push_back(facets.size());
  }
  result.face_counts.push_back(simplices.size());
  result.euler_characteristic = euler_characteristic(result.face_counts);

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
  result.boundary_components = count_boundaries(simplices, facets, num_vertices);

  result.orientable = result.pseudomanifold && patches.orientable;

  execution.poll();
  detail::begin_step(execution, Step::kTopology, num_vertices);
  LinkFindings links = look_at_links(
      simplices, std::vector<std::uint8_t>(num_vertices, 1), true, execution,
      [&](const auto& body) {
        detail::for_each_block(num_vertices, kLinksOfBlock, execution, body);
      });
  result.singular_vertices = std::move(links.singular);
  result.undecided_vertices = std::move(links.undecided);
  return result;
}

std::vector<Index> singular_vertices(const SimplexArray& simplices,
                                     const std::vector<std::uint8_t>& marked,
                                     const Execution& execution) {
  return look_at_links(simplices, marked, false, execution,
                       [&](const auto& body) {
                         detail::for_each_block_uncounted(
                             static_cast<Offset>(marked.size()), kLinksOfBlock,
                             execution, body);
                       })
      .singular;
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
