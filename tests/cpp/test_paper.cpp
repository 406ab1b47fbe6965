// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/reconstruct.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace remanifold {
namespace {

using testing::Cloud;
using testing::paper;

void expect_same(const PaperReconstruction& a, const PaperReconstruction& b) {
  EXPECT_EQ(a.simplices.vertices, b.simplices.vertices);
  EXPECT_EQ(a.edges.vertices, b.edges.vertices);
  EXPECT_EQ(a.edge_sets.offsets, b.edge_sets.offsets);
  EXPECT_EQ(a.edge_sets.indices, b.edge_sets.indices);
  EXPECT_EQ(a.stars.offsets, b.stars.offsets);
  EXPECT_EQ(a.stars.indices, b.stars.indices);
  EXPECT_EQ(a.boundary, b.boundary);
  EXPECT_EQ(a.unbounded, b.unbounded);
  EXPECT_EQ(a.tangent_simplices, b.tangent_simplices);
}

TEST(Reconstruct, CircleIsOneClosedPolygon) {
  const Cloud cloud = testing::sphere(300, 1, 1);
  const PaperReconstruction rec = paper(Samples::from_points(cloud.view()), 1);
  const Topology t = compute_topology(rec.simplices, 300);
  EXPECT_EQ(t.face_counts, (std::vector<Offset>{300, 300}));
  EXPECT_TRUE(t.closed);
  EXPECT_EQ(t.components, 1);
}

TEST(Reconstruct, SphereHasSpuriousTrianglesAtVerticesOfDegreeThree) {
  const Cloud cloud = testing::sphere(800, 2, 1);
  const PaperReconstruction rec = paper(Samples::from_points(cloud.view()), 2);
  const PaperReport report =
      paper_report(rec.simplices, rec.edge_sets, rec.stars, rec.boundary);
  ASSERT_GT(report.unstarred_simplices.size(), 0);
  // Without them it is the sphere, callouses and holes aside.
  const Topology t = compute_topology(rec.simplices, 800);
  EXPECT_GE(t.euler_characteristic, 2 + report.unstarred_simplices.size() - 2);
  for (const std::vector<Index>& simplex : testing::rows(report.unstarred_simplices)) {
    for (Offset s = rec.stars.offsets[simplex[0]];
         s < rec.stars.offsets[simplex[0] + 1]; ++s) {
      const Index* star = rec.stars.indices.data() + 3 * s;
      EXPECT_FALSE(star[1] == simplex[1] && star[2] == simplex[2]);
    }
  }
}

TEST(Reconstruct, SameBytesForAnyNumberOfThreads) {
  for (int dim = 1; dim <= 3; ++dim) {
    const Cloud cloud = testing::sphere(1500, dim, dim);
    const Samples samples = Samples::from_points(cloud.view());
    const PaperReconstruction one = paper(samples, dim);
    for (const int threads : {2, 5}) {
      expect_same(one, paper(samples, dim, Estimator::kEnclosure, threads));
    }
  }
}

TEST(Reconstruct, PointsProductsAndDistancesGiveTheSame) {
  for (int dim = 1; dim <= 3; ++dim) {
    const Cloud cloud = testing::sphere(200, dim, 20 + dim);
    const std::vector<double> gram = testing::gram_of(cloud);
    const std::vector<double> distances = testing::distances_of(cloud);
    for (const Estimator estimator :
         {Estimator::kEnclosure, Estimator::kPca, Estimator::kJet}) {
      const PaperReconstruction a =
          paper(Samples::from_points(cloud.view()), dim, estimator);
      const PaperReconstruction b =
          paper(Samples::from_gram({gram.data(), 200, 200}), dim, estimator);
      const PaperReconstruction c =
          paper(Samples::from_distances({distances.data(), 200, 200}), dim, estimator);
      expect_same(a, b);
      expect_same(a, c);
    }
  }
}

TEST(Reconstruct, CopiesChangeNothingButTheNumbers) {
  Cloud cloud = testing::sphere(200, 2, 5);
  const PaperReconstruction once = paper(Samples::from_points(cloud.view()), 2);
  const std::vector<double> points = cloud.points;
  cloud.points.insert(cloud.points.end(), points.begin(), points.end());
  const PaperReconstruction twice = paper(Samples::from_points(cloud.view()), 2);
  EXPECT_EQ(once.simplices.vertices, twice.simplices.vertices);
  EXPECT_EQ(twice.representatives[250], 50);
  EXPECT_EQ(twice.edge_sets.size(250), 0);
  EXPECT_EQ(twice.boundary[250], twice.boundary[50]);
}

TEST(Reconstruct, GridIsTriangulated) {
  // K = D: all stars agree, so that the cliques are a triangulation of the square.
  const Cloud cloud = testing::grid(10, 2);
  const PaperReconstruction rec =
      paper(Samples::from_points(cloud.view()), 2, Estimator::kPca);
  const Topology t = compute_topology(rec.simplices, 100);
  EXPECT_EQ(rec.simplices.size(), 2 * 81);
  EXPECT_EQ(t.euler_characteristic, 1);
  EXPECT_TRUE(t.singular_vertices.empty());
}

TEST(Reconstruct, DegenerateInputIsSound) {
  const Cloud same{std::vector<double>(30, 1.5), 3};
  const PaperReconstruction none = paper(Samples::from_points(same.view()), 2);
  EXPECT_EQ(none.simplices.size(), 0);
  EXPECT_EQ(none.boundary, std::vector<std::uint8_t>(10, 1));

  Cloud line{{}, 3};
  for (int i = 0; i < 40; ++i) {
    line.points.insert(line.points.end(), {1.0 * i, 2.0 * i, -1.0 * i});
  }
  EXPECT_EQ(paper(Samples::from_points(line.view()), 2).simplices.size(), 0);
  // As a curve it is a path, short of its two ends, which have no tangent basis.
  const PaperReconstruction path = paper(Samples::from_points(line.view()), 1);
  EXPECT_EQ(path.simplices.size(), 37);

  const Cloud few = testing::gaussian(3, 3, 1);
  EXPECT_EQ(paper(Samples::from_points(few.view()), 2).simplices.size(), 0);
}

TEST(PaperReport, RimsAreNoHoles) {
  const Cloud cloud = testing::grid(12, 2);
  const PaperReconstruction rec = paper(Samples::from_points(cloud.view()), 2);
  ASSERT_GT(std::count(rec.boundary.begin(), rec.boundary.end(), 1), 0);
  const PaperReport report =
      paper_report(rec.simplices, rec.edge_sets, rec.stars, rec.boundary);
  EXPECT_EQ(report.num_holes, 0);
  EXPECT_EQ(report.num_boundary_components, 1);
}

TEST(Reconstruct, CountsEachStepOnce) {
  const Cloud cloud = testing::sphere(2000, 2, 3);
  Progress progress;
  const Execution execution{2, &progress};
  const Samples samples = Samples::from_points(cloud.view(), execution);
  const auto expect_end_of = [&](Step step) {
    EXPECT_EQ(progress.step, step);
    EXPECT_EQ(progress.total, samples.size());
    EXPECT_EQ(progress.done, progress.total);
  };
  const NeighborSearch search(samples, {}, execution);
  const Neighborhoods neighborhoods =
      find_neighborhoods(samples, search, 20, execution);
  expect_end_of(Step::kNeighborhoods);
  const TangentSpaces tangents =
      compute_tangent_spaces(samples, neighborhoods, {2}, execution);
  expect_end_of(Step::kTangentSpaces);
  const LocalRegions regions =
      compute_local_regions(samples, search, neighborhoods, tangents, execution);
  expect_end_of(Step::kLocalRegions);
  const Csr edge_sets = edge_sets_to_input(samples, regions, execution);
  stars_to_input(samples, regions, execution);
  const Csr graph = edge_graph(edge_sets, EdgeRule::kMutual, execution);
  expect_end_of(Step::kLocalRegions);  // its results in the caller's numbering
  clique_complex(graph, 2, execution);
  expect_end_of(Step::kComplex);
}

TEST(Reconstruct, StopsWhenCancelled) {
  const Cloud cloud = testing::sphere(2000, 2, 3);
  const Samples samples = Samples::from_points(cloud.view());
  ReconstructOptions options;
  options.dim = 2;
  Progress progress;
  progress.cancel = true;
  EXPECT_THROW(reconstruct_paper(samples, options, {2, &progress}), Cancelled);
}

}  // namespace
}  // namespace remanifold
