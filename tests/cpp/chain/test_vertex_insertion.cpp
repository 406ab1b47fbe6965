// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/vertex_insertion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;
using testing::kTetrahedron;

struct Insert {
  Samples samples;
  Insertion insertion;
  SimplexArray simplices;

  Insert(const Cloud& cloud, SimplexArray given, double max_distance)
      : samples(Samples::from_points(cloud.view())) {
    const std::vector<Index> canonical = samples.canonical_indices();
    for (Index& v : given.vertices) {
      v = canonical[v];
    }
    for (Offset s = 0; s < given.size(); ++s) {
      std::sort(given.vertices.begin() + s * given.arity,
                given.vertices.begin() + (s + 1) * given.arity);
    }
    simplices = given;
    const NeighborSearch search(samples);
    const Neighborhoods near = find_neighborhoods(samples, search, samples.size() - 1);
    const std::vector<double> scales = local_scales(samples, near, given.arity - 1);
    insertion = insert_vertices(samples, near, scales, max_distance, {}, simplices);
    for (std::vector<Index>* numbers : {&insertion.inserted, &insertion.outliers}) {
      for (Index& v : *numbers) {
        v = samples.input_index(v);
      }
      std::sort(numbers->begin(), numbers->end());
    }
  }
};

TEST(VertexInsertion, SubdividesWhatIsNear) {
  // A tetrahedron; a sample on a face, one by an edge, one far away.
  const Cloud cloud{
      {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.3, 0.3, -0.01, 0.5, -0.01, -0.01, 9, 9, 9},
      3};
  const Insert found(cloud, kTetrahedron, 0.5);
  EXPECT_EQ(found.insertion.inserted, (std::vector<Index>{4, 5}));
  EXPECT_EQ(found.insertion.outliers, (std::vector<Index>{6}));
  EXPECT_EQ(found.simplices.size(), 8);
  const Topology t = compute_topology(found.simplices, 7);
  EXPECT_EQ(t.euler_characteristic, 2);
  EXPECT_TRUE(t.closed);
  EXPECT_TRUE(t.singular_vertices.empty());
  std::vector<std::vector<Index>> sorted = testing::rows(found.simplices);
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, testing::rows(found.simplices));
}

TEST(VertexInsertion, WhatFillsThePlaneStaysSideBySide) {
  // A triangle; a sample straight across an edge, one beyond a corner: with that,
  // triangles would overlap.
  const Cloud cloud{{0, 0, 2, 0, 0, 2, 0.9, -0.1, -0.4, -0.4}, 2};
  const Insert found(cloud, {3, {0, 1, 2}}, 2);
  EXPECT_EQ(found.insertion.inserted, std::vector<Index>{3});
  EXPECT_EQ(found.insertion.outliers, std::vector<Index>{4});
  double area = 0;
  for (const std::vector<Index>& row : testing::rows(found.simplices)) {
    const double* a = found.samples.point(row[0]);
    const double* b = found.samples.point(row[1]);
    const double* c = found.samples.point(row[2]);
    area += std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
  }
  const double scale = found.samples.scale();
  EXPECT_NEAR(area * scale * scale, 2 + 0.1, 1e-12);
}

TEST(VertexInsertion, NothingToInsert) {
  const Cloud cloud{{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 3};
  const Insert found(cloud, kTetrahedron, 0.5);
  EXPECT_TRUE(found.insertion.inserted.empty());
  EXPECT_TRUE(found.insertion.outliers.empty());
  EXPECT_EQ(found.simplices.vertices, kTetrahedron.vertices);
  const Insert nowhere(cloud, {3, {}}, 0.5);
  EXPECT_EQ(nowhere.insertion.outliers.size(), 4U);
  EXPECT_EQ(nowhere.simplices.size(), 0);
}

}  // namespace
}  // namespace remanifold
