// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/simplex_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;
using testing::Numbered;

TEST(SimplexMeasures, RegularSimplices) {
  for (int dim = 1; dim <= 5; ++dim) {
    Cloud corners{std::vector<double>((dim + 1) * (dim + 1), 0.0), dim + 1};
    for (int i = 0; i <= dim; ++i) {
      corners.points[i * (dim + 2)] = 1;
    }
    const Numbered given(corners);
    const double scale = given.samples.scale();
    const std::vector<double> scales(dim + 1, 2.0);
    const SimplexRuler ruler(given.samples, scales);
    std::vector<Index> vertices(dim + 1);
    std::iota(vertices.begin(), vertices.end(), 0);
    const SimplexMeasures found = ruler.measure(vertices.data(), dim + 1);
    const double volume = std::sqrt(dim + 1.0) / std::tgamma(dim + 1.0);
    EXPECT_NEAR(found.volume * std::pow(scale, dim), volume, 1e-12);
    EXPECT_NEAR(found.circumradius * scale, std::sqrt(dim / (dim + 1.0)), 1e-12);
    EXPECT_NEAR(found.squared_edges * scale * scale, dim * (dim + 1.0), 1e-12);
    EXPECT_NEAR(ruler.energy(vertices.data(), dim + 1),
                found.volume * found.squared_edges / std::pow(2.0, dim + 2), 1e-12);
  }
}

TEST(SimplexMeasures, FlatOnesHaveNoCircumcenter) {
  const Numbered line({{0, 0, 1, 1, 2, 2, 5, 5}, 2});
  const SimplexRuler ruler(line.samples, std::vector<double>(4, 1.0));
  const Index vertices[] = {0, 1, 2};
  EXPECT_EQ(ruler.measure(vertices, 3).circumradius,
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace remanifold
