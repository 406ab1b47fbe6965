// SPDX-License-Identifier: GPL-3.0-or-later
// What is right passes, and each thing that can be wrong is found.
#include "remanifold/verify.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

/// The message of what a check throws, or nothing.
std::string said(const std::function<void()>& check) {
  try {
    check();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "";
}

struct Sphere {
  Sphere()
      : cloud(testing::sphere(200, 2, 1)),
        samples(Samples::from_points(cloud.view())),
        search(samples),
        near(find_neighborhoods(samples, search, jet_neighbors(2))),
        tangents(compute_tangent_spaces(samples, near,
                                        {2, jet_neighbors(2), Estimator::kJet})),
        regions(compute_local_regions(samples, search, near, tangents)),
        complex(build_manifold(samples, near, tangents, regions, {}, {})) {}

  Cloud cloud;
  Samples samples;
  NeighborSearch search;
  Neighborhoods near;
  TangentSpaces tangents;
  LocalRegions regions;
  ManifoldComplex complex;
};

TEST(Verify, WhatIsRight) {
  const Sphere sphere;
  EXPECT_EQ(said([&] { verify_neighborhoods(sphere.samples, sphere.near); }), "");
  EXPECT_EQ(said([&] { verify_tangent_spaces(sphere.samples, sphere.tangents); }), "");
  EXPECT_EQ(said([&] { verify_local_regions(sphere.regions); }), "");
  EXPECT_EQ(said([&] { verify_manifold_complex(sphere.complex, 200); }), "");
}

TEST(Verify, Neighborhoods) {
  const Sphere sphere;
  const auto broken = [&](const std::function<void(Neighborhoods&)>& change) {
    Neighborhoods near = sphere.near;
    change(near);
    return said([&] { verify_neighborhoods(sphere.samples, near); });
  };
  EXPECT_EQ(broken([](auto& near) { near.indices[1] = near.indices[0]; }),
            "neighborhoods: a neighbor is twice in row 0");
  EXPECT_EQ(broken([](auto& near) { near.indices[0] = 0; }),
            "neighborhoods: no other sample in row 0");
  EXPECT_EQ(broken([](auto& near) { std::swap(near.indices[0], near.indices[9]); }),
            "neighborhoods: distances descend in row 0");
  EXPECT_EQ(broken([](auto& near) { near.indices.pop_back(); }),
            "neighborhoods: there are not as many rows as samples");
}

TEST(Verify, TangentSpaces) {
  Sphere sphere;
  sphere.tangents.bases[7] += 1e-3;
  EXPECT_EQ(said([&] { verify_tangent_spaces(sphere.samples, sphere.tangents); }),
            "tangent spaces: no orthonormal basis at sample 1");
  sphere.tangents.boundary[1] = 1;
  EXPECT_EQ(said([&] { verify_tangent_spaces(sphere.samples, sphere.tangents); }), "");
}

TEST(Verify, LocalRegions) {
  const Sphere sphere;
  const auto broken = [&](const std::function<void(LocalRegions&)>& change) {
    LocalRegions regions = sphere.regions;
    change(regions);
    return said([&] { verify_local_regions(regions); });
  };
  EXPECT_EQ(broken([](auto& r) {
              std::swap(r.edge_sets.indices[0], r.edge_sets.indices[1]);
            }),
            "local regions: no ascending edge set at sample 0");
  EXPECT_EQ(broken([](auto& r) { std::swap(r.stars[0], r.stars[1]); }),
            "local regions: no ascending star simplex at sample 0");
  EXPECT_EQ(broken([](auto& r) {
              r.stars.erase(r.stars.begin(), r.stars.begin() + 2);
              for (std::size_t i = 1; i < r.star_offsets.size(); ++i) {
                --r.star_offsets[i];
                r.star_starts[i] -= 2;
              }
            }),
            "local regions: the star is not closed around sample 0");
}

TEST(Verify, Simplices) {
  EXPECT_EQ(said([] { verify_simplices({3, {0, 1, 2, 0, 1, 3}}, 4); }), "");
  EXPECT_EQ(said([] {
              verify_simplices({3, {0, 1, 2, 0, 1, 3}}, 3);
            }),
            "simplices: a vertex is out of range in row 1");
  EXPECT_EQ(said([] {
              verify_simplices({3, {0, 2, 1}}, 3);
            }),
            "simplices: columns descend in row 0");
  EXPECT_EQ(said([] {
              verify_simplices({3, {0, 1, 3, 0, 1, 2}}, 4);
            }),
            "simplices: rows do not ascend at 1");
}

TEST(Verify, ManifoldComplex) {
  const Sphere sphere;
  const auto broken = [&](const std::function<void(ManifoldComplex&)>& change) {
    ManifoldComplex complex = sphere.complex;
    change(complex);
    return said([&] { verify_manifold_complex(complex, 200); });
  };
  EXPECT_EQ(broken([](auto& c) {
              c.simplices.vertices.resize(c.simplices.vertices.size() - 3);
            }),
            "manifold complex: the report has other open facets");
  EXPECT_EQ(broken([](auto& c) {
              c.report.branching_facets.vertices = {0, 1};
            }),
            "manifold complex: the report has other branching facets");
  EXPECT_EQ(broken([](auto& c) { c.report.singular = {3}; }),
            "manifold complex: the report has other singular vertices");
  EXPECT_EQ(broken([](auto& c) { c.report.outliers = {3}; }),
            "manifold complex: the report has other unused samples");
  EXPECT_EQ(broken([](auto& c) { c.patches.patch.pop_back(); }),
            "manifold complex: not every simplex has a patch");
  EXPECT_NE(broken([](auto& c) {
              c.patches.sign[5] = static_cast<std::int8_t>(-c.patches.sign[5]);
            }).find("orientations disagree"),
            std::string::npos);
  EXPECT_NE(broken([](auto& c) { ++c.patches.patch[5]; }).find("a patch ends inside"),
            std::string::npos);
}

TEST(Verify, Projections) {
  const std::vector<double> corners{0, 0, 1, 0, 0, 1};
  const std::vector<double> queries{0.5, -1};
  const SimplexSearch search({corners.data(), 3, 2}, {3, {0, 1, 2}});
  const MatrixView asked{queries.data(), 1, 2};
  const Projections right = search.nearest(asked);
  const auto broken = [&](const std::function<void(Projections&)>& change) {
    Projections projections = right;
    change(projections);
    return said([&] { verify_projections(projections, asked); });
  };
  EXPECT_EQ(broken([](auto&) {}), "");
  EXPECT_EQ(broken([](auto& p) { p.barycentric[0] = -0.5; }),
            "projections: a weight is negative at query 0");
  EXPECT_EQ(broken([](auto& p) { p.barycentric[0] += 0.5; }),
            "projections: weights do not sum to one at query 0");
  EXPECT_EQ(broken([](auto& p) { p.distances[0] += 0.5; }),
            "projections: the distance is another at query 0");
}

}  // namespace
}  // namespace remanifold
