// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

namespace remanifold {
namespace {

using testing::Cloud;

/// Random simplices between random vertices.
SimplexArray random_simplices(Offset count, int arity, Index num_vertices,
                              unsigned seed) {
  std::mt19937_64 random(seed);
  SimplexArray result{arity, {}};
  std::vector<Index> all(num_vertices);
  std::iota(all.begin(), all.end(), 0);
  for (Offset s = 0; s < count; ++s) {
    std::shuffle(all.begin(), all.end(), random);
    result.vertices.insert(result.vertices.end(), all.begin(), all.begin() + arity);
  }
  return result;
}

/// The way to the point q of a simplex, at the best of the weights on a fine grid.
double on_a_grid(const Cloud& cloud, const Index* corners, int arity, const double* q,
                 int steps) {
  std::vector<int> share(arity, 0);
  double least = std::numeric_limits<double>::infinity();
  const auto visit = [&](const auto& self, int corner, int left) -> void {
    if (corner + 1 < arity) {
      for (share[corner] = 0; share[corner] <= left; ++share[corner]) {
        self(self, corner + 1, left - share[corner]);
      }
      return;
    }
    share[corner] = left;
    double sum = 0;
    for (int a = 0; a < cloud.dim; ++a) {
      double x = -q[a];
      for (int i = 0; i < arity; ++i) {
        x += share[i] * cloud[corners[i]][a] / steps;
      }
      sum += x * x;
    }
    least = std::min(least, sum);
  };
  visit(visit, 0, steps);
  return std::sqrt(least);
}

TEST(Projection, NoPointOfAFineGridIsNearer) {
  for (const int dim : {0, 1, 2, 3, 4}) {
    for (const int ambient : {1, 3, 8, 9, 12}) {
      const Cloud cloud = testing::gaussian(12, ambient, 10 * dim + ambient);
      const SimplexArray simplices = random_simplices(9, dim + 1, 12, dim);
      const Cloud queries = testing::gaussian(20, ambient, 7);
      const SimplexSearch search(cloud.view(), simplices);
      const Projections found = search.nearest(queries.view());
      const int steps = dim < 3 ? 40 : 16;
      for (Offset q = 0; q < queries.size(); ++q) {
        double least = std::numeric_limits<double>::infinity();
        for (Offset s = 0; s < simplices.size(); ++s) {
          least = std::min(least,
                           on_a_grid(cloud, simplices[s], dim + 1, queries[q], steps));
        }
        EXPECT_LE(found.distances[q], least + 1e-12) << dim << " in " << ambient;
        EXPECT_GE(found.distances[q], least - 6.0 / steps);
        double sum = 0;
        for (int i = 0; i <= dim; ++i) {
          EXPECT_GE(found.barycentric[q * (dim + 1) + i], 0);
          sum += found.barycentric[q * (dim + 1) + i];
        }
        EXPECT_NEAR(sum, 1, 1e-14);
        for (int a = 0; a < ambient; ++a) {
          double x = 0;
          for (int i = 0; i <= dim; ++i) {
            x += found.barycentric[q * (dim + 1) + i] *
                 cloud[simplices[found.simplices[q]][i]][a];
          }
          EXPECT_NEAR(x, found.points[q * ambient + a], 1e-13);
        }
      }
    }
  }
}

TEST(Projection, TiesGoToTheFirst) {
  // A fan around a corner, and the same rows in another order.
  const Cloud cloud{{0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0}, 3};
  const Cloud above{{0, 0, .3, 0, 0, 2, 1e9, 0, 1e-9}, 3};
  for (const auto& vertices :
       {std::vector<Index>{0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1},
        std::vector<Index>{4, 1, 0, 3, 0, 4, 2, 3, 0, 1, 2, 0}}) {
    const SimplexSearch search(cloud.view(), {3, vertices});
    const Projections found = search.nearest(above.view());
    EXPECT_EQ(found.simplices, (std::vector<Offset>{0, 0, 0}));
    EXPECT_EQ(found.distances[0], 0.3);
  }
}

TEST(Projection, VerticesAreTheirOwnProjections) {
  const Cloud cloud = testing::sphere(300, 3, 1);
  const SimplexArray simplices = random_simplices(400, 4, 300, 2);
  const SimplexSearch search(cloud.view(), simplices);
  const Projections found = search.nearest(cloud.view());
  for (const Index v : simplices.vertices) {
    EXPECT_EQ(found.distances[v], 0);
  }
}

TEST(Projection, FlatSimplicesAreWhatTheyAre) {
  // A point, a segment, and a triangle of height 1e-12, all as tetrahedra.
  const Cloud cloud{{0,  0, 0, 0,  0, 0, 0,    0,     0, 0,  0, 0,  //
                     5,  0, 0, 6,  0, 0, 7,    0,     0, 8,  0, 0,  //
                     20, 0, 0, 21, 0, 0, 20.5, 1e-12, 0, 20, 0, 0},
                    3};
  const SimplexArray simplices{4, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};
  const Cloud queries{{-3, 4, 0, 6.25, 2, 0, 9, 0, 1, 20.25, 0, -7}, 3};
  const SimplexSearch search(cloud.view(), simplices);
  const Projections found = search.nearest(queries.view());
  EXPECT_EQ(found.simplices, (std::vector<Offset>{0, 1, 1, 2}));
  EXPECT_DOUBLE_EQ(found.distances[0], 5);
  EXPECT_DOUBLE_EQ(found.distances[1], 2);
  EXPECT_DOUBLE_EQ(found.distances[2], std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(found.distances[3], 7);
}

TEST(Projection, LengthsOfAnySizeGiveTheSame) {
  const Cloud cloud = testing::sphere(200, 2, 3);
  const Cloud queries = testing::gaussian(200, 3, 4);
  const SimplexArray simplices = random_simplices(300, 3, 200, 5);
  const Projections unit =
      SimplexSearch(cloud.view(), simplices).nearest(queries.view());
  for (const int exponent : {-900, -20, 20, 900}) {
    Cloud scaled = cloud;
    Cloud asked = queries;
    for (auto* values : {&scaled.points, &asked.points}) {
      for (double& value : *values) {
        value = std::ldexp(value, exponent);
      }
    }
    const Projections found =
        SimplexSearch(scaled.view(), simplices).nearest(asked.view());
    EXPECT_EQ(found.simplices, unit.simplices);
    EXPECT_EQ(found.barycentric, unit.barycentric);
    for (std::size_t q = 0; q < unit.distances.size(); ++q) {
      EXPECT_EQ(found.distances[q], std::ldexp(unit.distances[q], exponent));
    }
  }
}

TEST(Projection, FarQueriesDoNotOverflow) {
  const Cloud cloud{{0, 0, 1, 0, 0, 1}, 2};
  const Cloud far{{1e300, 0, -1e-320, -3e307}, 2};
  const Projections found =
      SimplexSearch(cloud.view(), {3, {0, 1, 2}}).nearest(far.view());
  EXPECT_EQ(found.points, (std::vector<double>{1, 0, 0, 0}));
  EXPECT_EQ(found.distances, (std::vector<double>{1e300, 3e307}));
}

TEST(Projection, AllThreadsGiveTheSame) {
  for (const int ambient : {3, 20}) {
    const Cloud cloud = testing::gaussian(500, ambient, 6);
    const SimplexArray simplices = random_simplices(2000, 3, 500, 7);
    const Cloud queries = testing::gaussian(300, ambient, 8);
    const SimplexSearch one(cloud.view(), simplices, {1, nullptr});
    const SimplexSearch four(cloud.view(), simplices, {4, nullptr});
    const Projections expected = one.nearest(queries.view(), {1, nullptr});
    const Projections found = four.nearest(queries.view(), {4, nullptr});
    EXPECT_EQ(found.simplices, expected.simplices);
    EXPECT_EQ(found.barycentric, expected.barycentric);
    EXPECT_EQ(found.distances, expected.distances);
    for (Offset q = 0; q < 5; ++q) {
      const Projections alone = one.nearest({queries[q], 1, ambient});
      EXPECT_EQ(alone.simplices[0], expected.simplices[q]);
      EXPECT_EQ(alone.distances[0], expected.distances[q]);
    }
  }
}

TEST(Projection, RefusesWhatHasNoAnswer) {
  const Cloud cloud{{0, 0, 1, 0}, 2};
  EXPECT_THROW(SimplexSearch(cloud.view(), {2, {}}), std::invalid_argument);
  EXPECT_THROW(SimplexSearch(cloud.view(), {2, {0, 2}}), std::invalid_argument);
  const SimplexSearch search(cloud.view(), {2, {0, 1}});
  const double bad[] = {0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW(search.nearest({bad, 1, 2}), std::invalid_argument);
  EXPECT_THROW(search.nearest({bad, 2, 1}), std::invalid_argument);
  EXPECT_TRUE(search.nearest({nullptr, 0, 2}).simplices.empty());
  const Cloud infinite{{0, std::numeric_limits<double>::infinity()}, 2};
  EXPECT_THROW(SimplexSearch(infinite.view(), {1, {0}}), std::invalid_argument);
}

TEST(Projection, StopsWhenCancelled) {
  const Cloud cloud{{0, 0, 1, 0}, 2};
  const SimplexSearch search(cloud.view(), {2, {0, 1}});
  Progress progress;
  progress.cancel = true;
  EXPECT_THROW(search.nearest(cloud.view(), {1, &progress}), Cancelled);
}

}  // namespace
}  // namespace remanifold
