// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/reconstruct.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

/// What is decided by all of them at once.
GlobalStatistics statistics_of(const Cloud& cloud) {
  GlobalStatistics whole;
  whole.low.assign(cloud.dim, -1);
  whole.high.assign(cloud.dim, 1);
  for (Offset j = 0; j < cloud.dim; ++j) {
    whole.low[j] = whole.high[j] = cloud[0][j];
    for (Offset i = 1; i < cloud.size(); ++i) {
      whole.low[j] = std::min(whole.low[j], cloud[i][j]);
      whole.high[j] = std::max(whole.high[j], cloud[i][j]);
    }
  }
  whole.size = cloud.size();
  return whole;
}

// Away from where it was cut off.
TEST(Reconstruct, PartHasTheSimplicesOfTheWhole) {
  const Cloud cloud = testing::sphere(4000, 2, 7);
  const GlobalStatistics whole = statistics_of(cloud);
  std::vector<Index> numbers;
  Cloud part{{}, cloud.dim};
  for (Index i = 0; i < cloud.size(); ++i) {
    if (cloud[i][0] > -0.2) {
      numbers.push_back(i);
      part.points.insert(part.points.end(), cloud[i], cloud[i] + cloud.dim);
    }
  }
  const auto upper = [&](const SimplexArray& simplices, const std::vector<Index>& of) {
    std::vector<std::vector<Index>> rows;
    for (Offset s = 0; s < simplices.size(); ++s) {
      std::vector<Index> row;
      for (int i = 0; i < simplices.arity; ++i) {
        row.push_back(of.empty() ? simplices[s][i] : of[simplices[s][i]]);
      }
      if (std::all_of(row.begin(), row.end(),
                      [&](Index v) { return cloud[v][0] > 0.3; })) {
        std::sort(row.begin(), row.end());
        rows.push_back(row);
      }
    }
    std::sort(rows.begin(), rows.end());
    return rows;
  };
  const Reconstruction all =
      reconstruct(Samples::from_points(cloud.view()), options_of(2));
  const Reconstruction some =
      reconstruct(Samples::from_part(part.view(), whole), options_of(2));
  EXPECT_EQ(upper(some.simplices, numbers), upper(all.simplices, {}));
  EXPECT_EQ(some.part.order.size(), numbers.size());
  EXPECT_TRUE(some.part.agreed_orientable);
}

TEST(Reconstruct, PartBeyondTheWholeIsRefused) {
  const Cloud cloud = testing::sphere(50, 2, 7);
  GlobalStatistics whole = statistics_of(cloud);
  whole.high[1] = 0.5;
  EXPECT_THROW(Samples::from_part(cloud.view(), whole), std::invalid_argument);
  whole.high.pop_back();
  EXPECT_THROW(Samples::from_part(cloud.view(), whole), std::invalid_argument);
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
