// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/reconstruct.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

ReconstructOptions options_of(int dim) {
  ReconstructOptions options;
  options.dim = dim;
  options.outlier_distance = 0;
  return options;
}

TEST(Reconstruct, ClosedSurfacesLookOutwards) {
  for (int dim = 1; dim <= 3; ++dim) {
    const Cloud cloud = testing::sphere(200, dim, 7);
    const Reconstruction rec =
        reconstruct(Samples::from_points(cloud.view()), options_of(dim));
    ASSERT_GT(rec.simplices.size(), 0);
    EXPECT_EQ(rec.report.open_facets.size(), 0);
    if (dim != 2) {
      continue;
    }
    for (Offset s = 0; s < rec.simplices.size(); ++s) {
      const double* a = cloud[rec.simplices[s][0]];
      const double* b = cloud[rec.simplices[s][1]];
      const double* c = cloud[rec.simplices[s][2]];
      EXPECT_GT(a[0] * (b[1] * c[2] - b[2] * c[1]) +
                    a[1] * (b[2] * c[0] - b[0] * c[2]) +
                    a[2] * (b[0] * c[1] - b[1] * c[0]),
                0);
    }
  }
}

TEST(Reconstruct, AnythingEndsWithoutASolver) {
  for (int dim = 1; dim <= 2; ++dim) {
    const Cloud cloud = testing::gaussian(150, 4, 3);
    const Samples samples = Samples::from_points(cloud.view());
    const Reconstruction one = reconstruct(samples, options_of(dim), {}, {1, nullptr});
    const Reconstruction two = reconstruct(samples, options_of(dim), {}, {3, nullptr});
    EXPECT_EQ(one.simplices.vertices, two.simplices.vertices);
    EXPECT_EQ(one.report.programs + one.report.integer_programs, 0);
  }
}

TEST(Reconstruct, StopsWhenCancelled) {
  const Cloud cloud = testing::sphere(500, 2, 3);
  const Samples samples = Samples::from_points(cloud.view());
  Progress progress;
  progress.cancel = true;
  EXPECT_THROW(reconstruct(samples, options_of(2), {}, {2, &progress}), Cancelled);
}

TEST(Reconstruct, ErrorsOfTheSolverComeOut) {
  const Cloud cloud = testing::gaussian(300, 4, 3);
  const Samples samples = Samples::from_points(cloud.view());
  const ProgramSolver fails = [](const LinearProgram&) -> std::vector<double> {
    throw std::runtime_error("no licence");
  };
  EXPECT_THROW(reconstruct(samples, options_of(2), fails), std::runtime_error);
}

TEST(Reconstruct, CleansFirst) {
  const Cloud cloud = testing::noisy_sphere(1000, 0.03, 30);
  const Samples samples = Samples::from_points(cloud.view());
  ReconstructOptions options;
  options.dim = 2;
  options.outlier_distance = 2;
  options.smooth = true;
  const Reconstruction result = reconstruct(samples, options);
  ASSERT_EQ(result.cleaning.outliers.size(), 30U);
  EXPECT_EQ(result.cleaning.outliers.front(), 1000);
  ASSERT_EQ(result.cleaning.displacements.size(), 3 * 1030U);
  EXPECT_EQ(result.cleaning.displacements[3 * 1010], 0);
  EXPECT_EQ(result.simplices.size(), 2 * 1000 - 4);
  EXPECT_EQ(result.report.open_facets.size(), 0);
  // Alone it is the same.
  const Cleaning alone = clean(samples, options);
  EXPECT_EQ(alone.outliers, result.cleaning.outliers);
  EXPECT_EQ(alone.displacements, result.cleaning.displacements);
}

}  // namespace
}  // namespace remanifold
