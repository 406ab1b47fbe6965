// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace remanifold {
namespace {

/// Boundary of the simplex on 0 .. dim + 1: the smallest sphere.
SimplexArray simplex_boundary(int dim) {
  SimplexArray result{dim + 1, {}};
  for (Index out = dim + 1; out >= 0; --out) {
    for (Index v = 0; v <= dim + 1; ++v) {
      if (v != out) {
        result.vertices.push_back(v);
      }
    }
  }
  return result;
}

// Six vertices, the least possible.
const SimplexArray kProjectivePlane{3, {0, 1, 2, 0, 1, 4, 0, 2, 5, 0, 3, 4, 0, 3, 5,
                                        1, 2, 3, 1, 3, 5, 1, 4, 5, 2, 3, 4, 2, 4, 5}};
const SimplexArray kMoebiusBand{3, {0, 1, 2, 1, 2, 3, 2, 3, 4, 0, 3, 4, 0, 1, 4}};

TEST(Topology, Spheres) {
  for (int dim = 1; dim <= 5; ++dim) {
    const Topology t = compute_topology(simplex_boundary(dim), dim + 2);
    EXPECT_EQ(t.euler_characteristic, dim % 2 == 0 ? 2 : 0);
    EXPECT_EQ(t.components, 1);
    EXPECT_TRUE(t.closed);
    EXPECT_TRUE(t.orientable);
    EXPECT_TRUE(t.singular_vertices.empty());
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
