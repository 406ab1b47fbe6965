// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "query/surface_walk.hpp"
#include "remanifold/facets.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

namespace remanifold {
namespace {

using testing::kProjectivePlane;
using testing::simplex_boundary;

const SimplexArray kMoebiusBand{3, {0, 1, 2, 1, 2, 3, 2, 3, 4, 0, 3, 4, 0, 1, 4}};

TEST(Topology, Spheres) {
  for (int dim = 1; dim <= 5; ++dim) {
    const Topology t = compute_topology(simplex_boundary(dim), dim + 2);
    EXPECT_EQ(t.euler_characteristic, dim % 2 == 0 ? 2 : 0);
    EXPECT_EQ(t.components, 1);
    EXPECT_TRUE(t.closed);
    EXPECT_TRUE(t.orientable);
    EXPECT_TRUE(t.singular_vertices.empty());
    EXPECT_TRUE(t.undecided_vertices.empty());
    EXPECT_EQ(t.closed_patches, 1);
  }
}

TEST(Topology, ProjectivePlane) {
  const Topology t = compute_topology(kProjectivePlane, 6);
  EXPECT_EQ(t.face_counts, (std::vector<Offset>{6, 15, 10}));
  EXPECT_EQ(t.euler_characteristic, 1);
  EXPECT_TRUE(t.closed);
  EXPECT_FALSE(t.orientable);
  EXPECT_TRUE(t.singular_vertices.empty());
  EXPECT_EQ(t.closed_patches, 1);
  EXPECT_EQ(t.closed_orientable_patches, 0);
}

TEST(Topology, MoebiusBand) {
  const Topology t = compute_topology(kMoebiusBand, 5);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_FALSE(t.closed);
  EXPECT_TRUE(t.pseudomanifold);
  EXPECT_FALSE(t.orientable);
  EXPECT_TRUE(t.singular_vertices.empty());
  EXPECT_EQ(t.coface_counts, (std::vector<Offset>{0, 5, 5}));
}

/// A square grid with opposite sides joined, the second pair with a turn or without, its
/// vertices numbered at random and some triangles left out.
SimplexArray patchy_surface(Index size, bool turned, int left_out,
                            std::mt19937& random) {
  std::vector<Index> number(size * size);
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  const auto at = [&](Index i, Index j) {
    const Index row = j < size || !turned ? i % size : (2 * size - i) % size;
    return number[row * size + j % size];
  };
  std::vector<std::array<Index, 3>> rows;
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      rows.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      rows.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  }
  std::shuffle(rows.begin(), rows.end(), random);
  rows.resize(rows.size() - left_out);
  for (std::array<Index, 3>& row : rows) {
    std::sort(row.begin(), row.end());
  }
  std::sort(rows.begin(), rows.end());
  SimplexArray result{3, {}};
  for (const std::array<Index, 3>& row : rows) {
    result.vertices.insert(result.vertices.end(), row.begin(), row.end());
  }
  return result;
}

TEST(Topology, WalksAroundVerticesFindWhatSortedEdgesTell) {
  std::mt19937 random(7);
  int walked = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Index size = 8;
    const SimplexArray surface =
        patchy_surface(size, trial % 2 == 1, trial % 6, random);
    const auto walk = detail::walk_surface<std::int32_t>(surface, size * size,
                                                         Execution{1 + trial % 3});
    const Topology found = compute_topology(surface, size * size);
    EXPECT_EQ(walk.has_value(), found.singular_vertices.empty());
    if (!walk) {
      continue;
    }
    ++walked;
    EXPECT_EQ(walk->neighbors, facet_neighbors<std::int32_t>(surface, size * size));
    const Faces edges = faces_of(surface, 1);
    std::vector<Offset> cofaces(3, 0);
    for (const Index count : edges.cofaces) {
      ++cofaces.at(count);
    }
    EXPECT_EQ(found.face_counts,
              (std::vector<Offset>{faces_of(surface, 0).simplices.size(),
                                   edges.simplices.size(), surface.size()}));
    EXPECT_EQ(found.coface_counts, cofaces);
    EXPECT_EQ(found.closed, cofaces[1] == 0);
    EXPECT_EQ(found.components, connected_components(surface, size * size).count);
    EXPECT_EQ(found.boundary_components,
              static_cast<Index>(
                  find_open_faces(edges, std::vector<std::uint8_t>(size * size, 0))
                      .hole.size()));
    const OrientedPatches patches = orient_patches(surface, size * size);
    EXPECT_EQ(found.orientable,
              patches.orientable == std::vector<std::uint8_t>(patches.sizes.size(), 1));
  }
  EXPECT_GE(walked, 20);
}

TEST(Topology, ApexOfManyTriangles) {
  for (const Index around : {3, 30, 511, 512, 513, 900}) {
    SimplexArray cones{3, {}};
    for (Index i = 0; i < around; ++i) {
      const Index j = (i + 1) % around;
      for (const Index apex : {around, around + 1}) {
        cones.vertices.insert(cones.vertices.end(),
                              {std::min(i, j), std::max(i, j), apex});
      }
    }
    const Topology t = compute_topology(cones, around + 2);
    EXPECT_EQ(t.euler_characteristic, 2);
    EXPECT_TRUE(t.closed);
    EXPECT_TRUE(t.orientable);
    EXPECT_TRUE(t.singular_vertices.empty());
  }
}

/// By Euler characteristic, degrees and connectedness, as slowly as it can be said.
bool is_surface_link(const SimplexArray& triangles) {
  std::map<Index, std::map<Index, int>> edges;
  std::map<Index, std::set<std::set<Index>>> umbrellas;
  for (Offset t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Index v = triangles[t][i];
      const Index a = triangles[t][(i + 1) % 3];
      const Index b = triangles[t][(i + 2) % 3];
      ++edges[v][a];
      ++edges[v][b];
      umbrellas[v].insert({a, b});
    }
  }
  const auto connected = [](std::set<std::set<Index>> sets) {
    if (sets.empty()) {
      return false;
    }
    std::set<Index> reached = *sets.begin();
    for (bool grown = true; grown;) {
      grown = false;
      for (auto it = sets.begin(); it != sets.end();) {
        const bool meets = std::any_of(it->begin(), it->end(),
                                       [&](Index v) { return reached.count(v) > 0; });
        if (meets) {
          reached.insert(it->begin(), it->end());
          it = sets.erase(it);
          grown = true;
        } else {
          ++it;
        }
      }
    }
    return sets.empty();
  };
  int num_edges = 0;
  bool closed = true;
  for (const auto& [v, ends] : edges) {
    for (const auto& [w, count] : ends) {
      if (count > 2) {
        return false;
      }
      closed = closed && count == 2;
      num_edges += v < w ? 1 : 0;
    }
    if (!connected(umbrellas[v])) {
      return false;
    }
  }
  std::set<std::set<Index>> all;
  for (Offset t = 0; t < triangles.size(); ++t) {
    all.insert({triangles[t][0], triangles[t][1], triangles[t][2]});
  }
  const auto euler =
      static_cast<int>(edges.size()) - num_edges + static_cast<int>(triangles.size());
  return connected(all) && euler == (closed ? 2 : 1);
}

TEST(Topology, LinksOfTrianglesAreToldByTheirDefinition) {
  // All sets of triangles on five vertices, and some on nine.
  std::vector<std::array<Index, 3>> triangles;
  for (Index a = 0; a < 9; ++a) {
    for (Index b = a + 1; b < 9; ++b) {
      for (Index c = b + 1; c < 9; ++c) {
        triangles.push_back({a, b, c});
      }
    }
  }
  std::sort(triangles.begin(), triangles.end(),
            [](const auto& s, const auto& t) { return s[2] < t[2]; });
  int good = 0;
  for (unsigned set = 1; set < 1U << 10; ++set) {
    SimplexArray link{3, {}};
    for (unsigned t = 0; t < 10; ++t) {
      if ((set >> t & 1) != 0) {
        link.vertices.insert(link.vertices.end(), triangles[t].begin(),
                             triangles[t].end());
      }
    }
    const bool expected = is_surface_link(link);
    good += expected ? 1 : 0;
    ASSERT_EQ(is_sphere_or_ball(link), expected) << set;
  }
  EXPECT_GT(good, 100);
  // Surfaces grown triangle by triangle, until one does not fit.
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    std::shuffle(triangles.begin(), triangles.end(), random);
    SimplexArray link{3, {}};
    for (const auto& triangle : triangles) {
      SimplexArray more = link;
      more.vertices.insert(more.vertices.end(), triangle.begin(), triangle.end());
      const bool expected = is_surface_link(more);
      ASSERT_EQ(is_sphere_or_ball(more), expected);
      if (expected) {
        link = more;
      }
    }
  }
}

TEST(Topology, LinksOfManyVertices) {
  // A double pyramid over a polygon, a pyramid, and two that share the apex.
  constexpr Index corners = 300;
  const auto pyramid = [](Index apex, Index first) {
    SimplexArray result{3, {}};
    for (Index i = 0; i < corners; ++i) {
      const Index a = first + i;
      const Index b = first + (i + 1) % corners;
      result.vertices.insert(result.vertices.end(),
                             {std::min(a, b), std::max(a, b), apex});
    }
    return result;
  };
  const auto together = [](SimplexArray a, const SimplexArray& b) {
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    return a;
  };
  EXPECT_TRUE(is_sphere_or_ball(pyramid(2000, 0)));
  EXPECT_TRUE(is_sphere_or_ball(together(pyramid(2000, 0), pyramid(2001, 0))));
  EXPECT_FALSE(is_sphere_or_ball(together(pyramid(2000, 0), pyramid(2000, 500))));
  EXPECT_FALSE(is_sphere_or_ball(together(pyramid(2000, 0), pyramid(2001, 500))));
}

TEST(Topology, LinksOfHigherDimension) {
  for (int dim = 1; dim <= 6; ++dim) {
    SimplexArray sphere = simplex_boundary(dim);
    EXPECT_TRUE(is_sphere_or_ball(sphere));
    sphere.vertices.resize(sphere.vertices.size() - sphere.arity);
    EXPECT_TRUE(is_sphere_or_ball(sphere)) << "a ball of dimension " << dim;
    SimplexArray two = simplex_boundary(dim);
    for (const Index v : simplex_boundary(dim).vertices) {
      two.vertices.push_back(v + dim + 2);
    }
    EXPECT_FALSE(is_sphere_or_ball(two)) << "two spheres";
  }
  // Cones over what is no sphere: every vertex but the apex has a disc, a ball or a
  // sphere around it.
  const auto cone = [](const SimplexArray& base, Index apex) {
    SimplexArray result{base.arity + 1, {}};
    for (Offset s = 0; s < base.size(); ++s) {
      result.vertices.insert(result.vertices.end(), base[s], base[s] + base.arity);
      result.vertices.push_back(apex);
    }
    return result;
  };
  const SimplexArray over_plane = cone(kProjectivePlane, 6);
  EXPECT_FALSE(is_sphere_or_ball(over_plane));
  EXPECT_FALSE(is_sphere_or_ball(cone(over_plane, 7)));
}

TEST(Topology, ThreeTrianglesOnAnEdge) {
  const SimplexArray book{3, {0, 1, 2, 0, 1, 3, 0, 1, 4}};
  const Topology t = compute_topology(book, 5);
  EXPECT_FALSE(t.pseudomanifold);
  EXPECT_FALSE(t.orientable);
  EXPECT_EQ(t.singular_vertices, (std::vector<Index>{0, 1}));
  EXPECT_EQ(t.coface_counts, (std::vector<Offset>{0, 6, 0, 1}));
}

TEST(Topology, TwoTrianglesAtAPoint) {
  const Topology t = compute_topology({3, {0, 1, 2, 2, 3, 4}}, 5);
  EXPECT_EQ(t.components, 1);
  EXPECT_EQ(t.singular_vertices, (std::vector<Index>{2}));
}

TEST(Topology, ConeOverATorusIsSingularAtItsApex) {
  // The seven-vertex torus, joined to vertex 7.
  SimplexArray cone{4, {}};
  for (Index i = 0; i < 7; ++i) {
    for (const auto& step : {std::pair<Index, Index>{1, 3}, {2, 3}}) {
      std::vector<Index> face{i, (i + step.first) % 7, (i + step.second) % 7};
      std::sort(face.begin(), face.end());
      cone.vertices.insert(cone.vertices.end(), face.begin(), face.end());
      cone.vertices.push_back(7);
    }
  }
  const Topology t = compute_topology(cone, 8);
  EXPECT_EQ(t.singular_vertices, (std::vector<Index>{7}));
}

TEST(Topology, EmptyComplex) {
  const Topology t = compute_topology({3, {}}, 10);
  EXPECT_EQ(t.components, 0);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_FALSE(t.closed);
}

TEST(Topology, RefusesBrokenSimplices) {
  EXPECT_THROW(compute_topology({3, {0, 1, 5}}, 5), std::invalid_argument);
  EXPECT_THROW(compute_topology({3, {0, 2, 1}}, 5), std::invalid_argument);
  EXPECT_THROW(compute_topology({3, {0, 1, 1}}, 5), std::invalid_argument);
  EXPECT_THROW(compute_topology({0, {}}, 5), std::invalid_argument);
  EXPECT_THROW(compute_topology({3, {}}, -5), std::invalid_argument);
}

TEST(Faces, ManyVertices) {
  for (int dim = 0; dim < 6; ++dim) {
    const Faces faces = faces_of(simplex_boundary(6), dim);
    const Offset expected[] = {8, 28, 56, 70, 56, 28};
    EXPECT_EQ(faces.simplices.size(), expected[dim]);
  }
  EXPECT_THROW(faces_of(kMoebiusBand, 3), std::invalid_argument);
}

TEST(OpenFaces, HolesHaveNoBoundarySample) {
  // An annulus of triangles: 0 1 2 inside, 3 4 5 outside.
  const SimplexArray annulus{3, {0, 1, 3, 1, 3, 4, 1, 2, 4, 2, 4, 5, 0, 2, 5, 0, 3, 5}};
  const Faces faces = faces_of(annulus, 1);
  const OpenFaces open = find_open_faces(faces, {0, 0, 0, 1, 1, 1});
  EXPECT_EQ(open.faces.size(), 6);
  EXPECT_EQ(std::count(open.hole.begin(), open.hole.end(), 1), 1);
  EXPECT_EQ(open.hole.size(), 2U);
  const Faces ends = faces_of({2, {0, 1, 1, 2}}, 0);
  EXPECT_EQ(find_open_faces(ends, {1, 0, 0}).hole, (std::vector<std::uint8_t>{0, 1}));
}

TEST(Components, AreNumberedByLowestVertex) {
  const Components c = connected_components({2, {4, 5, 1, 2, 2, 3}}, 7);
  EXPECT_EQ(c.count, 2);
  EXPECT_EQ(c.labels, (std::vector<Index>{-1, 0, 0, 0, 1, 1, -1}));
}

}  // namespace
}  // namespace remanifold
