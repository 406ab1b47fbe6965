// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/manifold_complex.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

TEST(ManifoldComplex, OpeningAHoleCostsWhatFillingItWould) {
  // A disk of radius r in units of h: energy against the length of its rim.
  EXPECT_DOUBLE_EQ(open_price(1, 2), 32);
  EXPECT_DOUBLE_EQ(open_price(2, 2), 24);
  EXPECT_DOUBLE_EQ(open_price(3, 1), 8.0 / 3);
}

TEST(ManifoldComplex, SphereWithoutASolver) {
  const Cloud cloud = testing::sphere(300, 2, 1);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  const Neighborhoods near = find_neighborhoods(samples, search, jet_neighbors(2));
  const TangentSpaces tangents =
      compute_tangent_spaces(samples, near, {2, jet_neighbors(2), Estimator::kJet});
  const LocalRegions regions = compute_local_regions(samples, search, near, tangents);
  const ManifoldComplex complex =
      build_manifold(samples, near, tangents, regions, {}, {});
  const Topology t = compute_topology(complex.simplices, 300);
  EXPECT_EQ(t.face_counts, (std::vector<Offset>{300, 894, 596}));
  EXPECT_TRUE(t.closed);
  EXPECT_TRUE(t.singular_vertices.empty());
  EXPECT_EQ(complex.report.open_facets.size(), 0);
  EXPECT_EQ(complex.report.branching_facets.size(), 0);
  EXPECT_TRUE(complex.report.singular.empty());
  EXPECT_TRUE(complex.report.outliers.empty());
  EXPECT_GT(complex.report.agreed, 500);
  EXPECT_EQ(complex.report.programs, 0);
  EXPECT_EQ(complex.report.unsolved, 0);
}

}  // namespace
}  // namespace remanifold
