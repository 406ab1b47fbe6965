// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

struct Computed {
  Samples samples;
  TangentSpaces tangents;
  LocalRegions regions;
};

Computed regions_of(const Cloud& cloud, int dim, Estimator estimator = Estimator::kPca,
                    SearchMethod method = SearchMethod::kAuto, Index count = 0) {
  Computed result{Samples::from_points(cloud.view()), {}, {}};
  const NeighborSearch search(result.samples, {method});
  const Neighborhoods neighborhoods = find_neighborhoods(
      result.samples, search, count > 0 ? count : std::max(10 * dim, 20));
  const TangentOptions options{dim, std::max(dim + 1, 10 * dim), estimator};
  result.tangents = compute_tangent_spaces(result.samples, neighborhoods, options);
  result.regions =
      compute_local_regions(result.samples, search, neighborhoods, result.tangents);
  return result;
}

/// Corners of each region by their stars must be at the same distance from x and the K
/// other vertices, and nearer to none: what defines them, over all samples.
void expect_empty_balls(const Computed& c) {
  const int dim = c.regions.dim;
  const int ambient_dim = c.samples.ambient_dim();
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  for (Index x = 0; x < c.samples.size(); ++x) {
    if (c.tangents.boundary[x] != 0) {
      continue;
    }
    const Eigen::Map<const Rows> basis(
        c.tangents.bases.data() + static_cast<Offset>(x) * dim * ambient_dim, dim,
        ambient_dim);
    const Eigen::Map<const Eigen::VectorXd> px(c.samples.point(x), ambient_dim);
    const auto difference = [&](Index q) -> Eigen::VectorXd {
      return Eigen::Map<const Eigen::VectorXd>(c.samples.point(q), ambient_dim) - px;
    };
    double largest = 0;
    const Star star = c.regions.star(x);
    for (Offset s = 0; s < star.size(); ++s) {
      Eigen::MatrixXd normals(dim, dim);
      Eigen::VectorXd offsets(dim);
      for (int k = 0; k < dim; ++k) {
        const Eigen::VectorXd d = difference(star.vertex(s, k));
        normals.row(k) = (basis * d).transpose();
        offsets[k] = d.squaredNorm() / 2;
      }
      const Eigen::VectorXd corner = normals.fullPivLu().solve(offsets);
      const double radius = corner.squaredNorm();
      largest = std::max(largest, radius);
      for (Index q = 0; q < c.samples.size(); ++q) {
        const double distance =
            (difference(q) - basis.transpose() * corner).squaredNorm();
        ASSERT_GT(distance, radius * (1 - 1e-6) - 1e-9) << "sample " << x;
      }
    }
    if (c.regions.squared_radii[x] < std::numeric_limits<double>::infinity()) {
      EXPECT_NEAR(c.regions.squared_radii[x], largest, 1e-6 * largest);
    }
  }
}

/// Every star simplex is in the stars of all its vertices.
void expect_agreement(const Computed& c) {
  const int dim = c.regions.dim;
  std::map<std::vector<Index>, int> votes;
  for (Index x = 0; x < c.samples.size(); ++x) {
    std::vector<Index> rows;
    c.regions.star(x).append_to(rows);
    for (auto row = rows.begin(); row != rows.end(); row += dim) {
      std::vector<Index> simplex(row, row + dim);
      simplex.push_back(x);
      std::sort(simplex.begin(), simplex.end());
      ++votes[simplex];
    }
  }
  ASSERT_FALSE(votes.empty());
  for (const auto& [simplex, count] : votes) {
    EXPECT_EQ(count, dim + 1);
  }
}

TEST(LocalRegions, CornersAreEmptyBalls) {
  for (int dim = 1; dim <= 4; ++dim) {
    expect_empty_balls(regions_of(testing::sphere(dim < 4 ? 250 : 120, dim, dim), dim));
  }
  // No manifold at all.
  expect_empty_balls(regions_of(testing::gaussian(150, 5, 1), 2));
  expect_empty_balls(regions_of(testing::gaussian(150, 5, 2), 3));
  expect_empty_balls(regions_of(testing::gaussian(60, 25, 3), 2));
}

TEST(LocalRegions, HigherDimensions) {
  for (int dim = 5; dim <= 6; ++dim) {
    const Offset size = dim == 5 ? 50 : 30;
    const Computed c = regions_of(testing::sphere(size, dim, dim), dim);
    expect_empty_balls(c);
    EXPECT_GT(c.regions.star_offsets.back(), size);
  }
}

TEST(LocalRegions, DoNotDependOnTheSearchNorOnHowManyNeighborsAreKnown) {
  for (int dim = 1; dim <= 4; ++dim) {
    const Cloud cloud = testing::gaussian(200, dim + 1, 10 + dim);
    const Computed reference =
        regions_of(cloud, dim, Estimator::kPca, SearchMethod::kKdTree, 199);
    for (const SearchMethod method :
         {SearchMethod::kKdTree, SearchMethod::kBruteForce}) {
      const Computed other = regions_of(cloud, dim, Estimator::kPca, method, 10 * dim);
      EXPECT_EQ(other.regions.edge_sets.offsets, reference.regions.edge_sets.offsets);
      EXPECT_EQ(other.regions.edge_sets.indices, reference.regions.edge_sets.indices);
      EXPECT_EQ(other.regions.star_offsets, reference.regions.star_offsets);
    }
  }
}

TEST(LocalRegions, TiltedTangentSpacesReachAcross) {
  // An ellipse of many samples whose tangents are replaced by its normals: every
  // region reaches across, and only samples on the far side bound it.
  const int n = 2000;
  Cloud cloud{{}, 2};
  for (int i = 0; i < n; ++i) {
    const double angle = 6.283185307179586 * (i + 0.3 * std::sin(17.0 * i)) / n;
    cloud.points.push_back(2 * std::cos(angle));
    cloud.points.push_back(std::sin(angle));
  }
  const Samples samples = Samples::from_points(cloud.view());
  TangentSpaces tangents;
  tangents.dim = 1;
  tangents.boundary.assign(n, 0);
  for (Index i = 0; i < n; ++i) {
    const double* p = samples.point(i);
    const double length = std::hypot(p[0] / 4, p[1]);
    tangents.bases.push_back(p[0] / 4 / length);
    tangents.bases.push_back(p[1] / length);
  }
  std::vector<Csr> edge_sets;
  for (const SearchMethod method : {SearchMethod::kKdTree, SearchMethod::kBruteForce}) {
    const NeighborSearch search(samples, {method});
    const Neighborhoods neighborhoods = find_neighborhoods(samples, search, 10);
    const LocalRegions regions =
        compute_local_regions(samples, search, neighborhoods, tangents);
    for (Index i = 0; i < n; ++i) {
      EXPECT_EQ(regions.squared_radii[i], std::numeric_limits<double>::infinity());
      ASSERT_EQ(regions.edge_sets.size(i), 1);
    }
    edge_sets.push_back(regions.edge_sets);
  }
  EXPECT_EQ(edge_sets[0].indices, edge_sets[1].indices);
}

TEST(LocalRegions, NothingIsLeftOfTheSampleBefore) {
  // The middle sample sees both others straight above: no halfspace at all.
  const Cloud cloud{{0, 0, 1, 0, 2, 0}, 2};
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  const Neighborhoods neighborhoods = find_neighborhoods(samples, search, 2);
  TangentSpaces tangents;
  tangents.dim = 1;
  tangents.boundary.assign(3, 0);
  tangents.bases = {1, 0, 0, 1, 0, 1};
  const LocalRegions regions =
      compute_local_regions(samples, search, neighborhoods, tangents, {1, nullptr});
  EXPECT_EQ(regions.edge_sets.offsets, (std::vector<Offset>{0, 1, 1, 1}));
}

TEST(LocalRegions, ClustersFarApartKeepTheirSimplices) {
  // Two needles: K = D = 4, all simplices at once tiny and long, none of them flat.
  Cloud cloud = testing::gaussian(24, 4, 3);
  for (Offset i = 0; i < cloud.size(); ++i) {
    for (int j = 0; j < 4; ++j) {
      cloud.points[i * 4 + j] =
          1e-5 * cloud.points[i * 4 + j] + (j == 0 && i % 2 == 1 ? 1.0 : 0.0);
    }
  }
  expect_empty_balls(regions_of(cloud, 4));
  expect_agreement(regions_of(cloud, 4));
}

TEST(LocalRegions, EndsOfALineAreUnbounded) {
  const Cloud cloud{{0, 1, 3, 6}, 1};
  const Computed c = regions_of(cloud, 1);
  const std::vector<Index> canonical = c.samples.canonical_indices();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(c.regions.squared_radii[canonical[0]], infinity);
  EXPECT_EQ(c.regions.squared_radii[canonical[3]], infinity);
  EXPECT_NEAR(std::sqrt(c.regions.squared_radii[canonical[1]]) * c.samples.scale(), 1.0,
              1e-7);
  EXPECT_EQ(c.regions.edge_sets.size(canonical[0]), 1);
  EXPECT_EQ(c.regions.edge_sets.size(canonical[1]), 2);
}

TEST(LocalRegions, TiesOfGridsAreBrokenAlike) {
  expect_agreement(regions_of(testing::grid(12, 2), 2));
  expect_agreement(regions_of(testing::grid(5, 3), 3));
  expect_agreement(regions_of(testing::grid(3, 4), 4));
  // Thirds are not doubles: near ties instead of ties.
  Cloud thirds = testing::grid(12, 2);
  for (double& x : thirds.points) {
    x /= 3;
  }
  expect_agreement(regions_of(thirds, 2));
  // All on one circle, and its center.
  Cloud circle{{0, 0}, 2};
  for (int i = 0; i < 40; ++i) {
    circle.points.push_back(std::cos(6.283185307179586 * i / 40));
    circle.points.push_back(std::sin(6.283185307179586 * i / 40));
  }
  expect_agreement(regions_of(circle, 2));
}

TEST(LocalRegions, CountsSamplesStraightAbove) {
  // A sample exactly above x constrains nothing in the plane.
  Cloud cloud = testing::grid(5, 2);
  Cloud lifted{{}, 3};
  for (Offset i = 0; i < cloud.size(); ++i) {
    lifted.points.insert(lifted.points.end(), {cloud[i][0], cloud[i][1], 0.0});
  }
  lifted.points.insert(lifted.points.end(), {2, 2, 0.25});
  const Samples samples = Samples::from_points(lifted.view());
  const NeighborSearch search(samples);
  const Neighborhoods neighborhoods = find_neighborhoods(samples, search, 20);
  TangentSpaces tangents;
  tangents.dim = 2;
  tangents.boundary.assign(samples.size(), 0);
  for (Index i = 0; i < samples.size(); ++i) {
    tangents.bases.insert(tangents.bases.end(), {1, 0, 0, 0, 1, 0});
  }
  const LocalRegions regions =
      compute_local_regions(samples, search, neighborhoods, tangents);
  EXPECT_GE(regions.vacuous_constraints, 2);
}

TEST(TieWeights, AreTinyAndFixedByThePosition) {
  Cloud cloud = testing::grid(6, 2);
  const auto weights_of = [](const Cloud& points) {
    const Samples samples = Samples::from_points(points.view());
    const NeighborSearch search(samples);
    return tie_weights(samples, find_neighborhoods(samples, search, 4));
  };
  const Samples samples = Samples::from_points(cloud.view());
  const std::vector<double> weights = weights_of(cloud);
  std::set<double> distinct(weights.begin(), weights.end());
  EXPECT_EQ(distinct.size(), weights.size());
  for (const double w : weights) {
    EXPECT_GE(w, 0);
    EXPECT_LE(w * samples.scale() * samples.scale(), 1e-7);
  }
  // Canonical samples stand in the same order, whatever that of the input.
  std::reverse(cloud.points.begin(), cloud.points.end());
  for (std::size_t i = 0; i < cloud.points.size(); i += 2) {
    std::swap(cloud.points[i], cloud.points[i + 1]);
  }
  EXPECT_EQ(weights_of(cloud), weights);
}

TEST(Star, PlacesHaveTheWidthThatTheEdgeSetAsksFor) {
  for (const auto& [edges, width] : std::vector<std::pair<Offset, std::size_t>>{
           {5, 1}, {256, 1}, {257, 2}, {65'536, 2}, {65'537, 4}}) {
    std::vector<Index> edge_set(edges);
    for (Offset i = 0; i < edges; ++i) {
      edge_set[i] = static_cast<Index>(3 * i);
    }
    const Index last = edge_set.back();
    const std::vector<Index> rows{0, 3, 0, last, 3, 6, last - 3, last};
    std::vector<std::uint8_t> packed;
    Star::pack(rows, edge_set.data(), edges, packed);
    EXPECT_EQ(packed.size(), rows.size() * width);
    const Star star(packed.data(), edge_set.data(), edges, 4, 2);
    std::vector<Index> unpacked;
    star.append_to(unpacked);
    EXPECT_EQ(unpacked, rows);
    for (std::size_t i = 0; i < rows.size(); i += 2) {
      EXPECT_TRUE(star.has(rows.data() + i)) << edges << ' ' << i;
    }
    for (const std::vector<Index>& other :
         std::vector<std::vector<Index>>{{0, 6}, {3, last}, {1, 3}, {last, last + 3}}) {
      EXPECT_FALSE(star.has(other.data())) << edges;
    }
  }
  const std::vector<Index> edge_set{1, 2};
  const std::vector<Index> beyond{1, 3};
  std::vector<std::uint8_t> packed;
  EXPECT_THROW(Star::pack(beyond, edge_set.data(), 2, packed), std::logic_error);
}

}  // namespace
}  // namespace remanifold
