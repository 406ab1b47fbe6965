// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/convex_hull_d.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

namespace remanifold::detail {
namespace {

constexpr double kStart = 1e-9;

using Point = std::vector<double>;
using Facet = std::vector<Index>;

/// Grows a hull; facets as sorted positions in `points`, those of the start negative.
template <int K>
class Grown {
 public:
  explicit Grown(int dim) : dim_(dim), hull_(dim) { hull_.restart(kStart); }

  void insert(const Point& point, Index position) {
    if (hull_.insert(point.data())) {
      taken_.push_back(position);
    }
  }

  std::set<Facet> facets() {
    std::set<Facet> result;
    hull_.for_each_facet([&](const Index* ids) {
      Facet facet;
      for (int i = 0; i < dim_; ++i) {
        facet.push_back(is_start(ids[i]) ? ids[i] : taken_[ids[i]]);
      }
      std::sort(facet.begin(), facet.end());
      EXPECT_TRUE(result.insert(facet).second);
    });
    return result;
  }

  HullPolytope<K>& hull() { return hull_; }

 private:
  int dim_;
  HullPolytope<K> hull_;
  std::vector<Index> taken_;
};

Point point_of(Index id, const std::vector<Point>& points, int dim) {
  if (!is_start(id)) {
    return points[id];
  }
  Point result(dim);
  for (int axis = 0; axis < dim; ++axis) {
    result[axis] = kStart * start_coordinate(dim, start_vertex(id), axis);
  }
  return result;
}

int side(const Facet& facet, const Point& p, const std::vector<Point>& points,
         int dim) {
  std::vector<Point> all;
  for (const Index id : facet) {
    all.push_back(point_of(id, points, dim));
  }
  all.push_back(p);
  std::vector<const double*> pointers;
  for (const Point& point : all) {
    pointers.push_back(point.data());
  }
  return exact_orientation(dim, pointers.data());
}

/// Every facet has all points on the side of the origin, every ridge two facets.
void expect_hull(const std::set<Facet>& facets, const std::vector<Point>& points,
                 int dim) {
  std::map<Facet, int> ridges;
  for (const Facet& facet : facets) {
    const int inside = side(facet, Point(dim, 0.0), points, dim);
    ASSERT_NE(inside, 0);
    for (const Point& point : points) {
      ASSERT_NE(side(facet, point, points, dim), -inside);
    }
    for (int i = 0; i < dim; ++i) {
      Facet ridge = facet;
      ridge.erase(ridge.begin() + i);
      ++ridges[ridge];
    }
  }
  for (const auto& [ridge, count] : ridges) {
    ASSERT_EQ(count, 2);
  }
}

std::vector<Point> random_points(int dim, int count, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<Point> points(count, Point(dim));
  for (Point& point : points) {
    for (double& x : point) {
      x = normal(random);
    }
  }
  return points;
}

/// All facets by trying all sets of K points.
std::set<Facet> by_trying(const std::vector<Point>& points, int dim) {
  std::set<Facet> result;
  std::vector<char> chosen(points.size(), 0);
  std::fill_n(chosen.begin(), dim, 1);
  do {
    Facet facet;
    for (Index i = 0; i < static_cast<Index>(points.size()); ++i) {
      if (chosen[i] != 0) {
        facet.push_back(i);
      }
    }
    const int inside = side(facet, Point(dim, 0.0), points, dim);
    if (std::all_of(points.begin(), points.end(), [&](const Point& point) {
          return side(facet, point, points, dim) != -inside;
        })) {
      result.insert(facet);
    }
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return result;
}

template <int K>
void expect_as_by_trying(int dim, int count) {
  std::mt19937 random(dim);
  for (int round = 0; round < 2; ++round) {
    const std::vector<Point> points = random_points(dim, count, random);
    Grown<K> grown(dim);
    for (Index i = 0; i < count; ++i) {
      grown.insert(points[i], i);
    }
    const std::set<Facet> facets = grown.facets();
    if (std::any_of(facets.begin(), facets.end(),
                    [](const Facet& facet) { return is_start(facet.front()); })) {
      continue;  // the origin is outside
    }
    EXPECT_EQ(facets, by_trying(points, dim));
  }
}

TEST(ConvexHullD, HasTheFacetsThatTryingAllFinds) {
  expect_as_by_trying<3>(3, 20);
  expect_as_by_trying<4>(4, 16);
  expect_as_by_trying<Eigen::Dynamic>(5, 14);
  expect_as_by_trying<Eigen::Dynamic>(6, 14);
}

template <int K>
void expect_hull_of_lattice(int dim, int side_length, int rounds) {
  std::vector<Point> points;
  int count = 1;
  for (int axis = 0; axis < dim; ++axis) {
    count *= side_length;
  }
  for (int code = 0; code < count; ++code) {
    Point point;
    for (int rest = code, axis = 0; axis < dim; ++axis, rest /= side_length) {
      point.push_back(0.1 * (rest % side_length - (side_length - 1) / 2));
    }
    points.push_back(point);
    points.push_back(point);
  }
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(dim);
  for (int round = 0; round < rounds; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    Grown<K> grown(dim);
    for (const Index i : order) {
      grown.insert(points[i], i);
    }
    const std::set<Facet> facets = grown.facets();
    expect_hull(facets, points, dim);
    std::set<Point> on_facets;
    for (const Facet& facet : facets) {
      ASSERT_FALSE(is_start(facet.front()));
      for (const Index id : facet) {
        on_facets.insert(points[id]);
      }
    }
    // All corners of the cube, and whatever was on its surface when it came.
    EXPECT_GE(on_facets.size(), std::size_t{1} << dim);
  }
}

TEST(ConvexHullD, OfLatticesWithRepeatedPoints) {
  expect_hull_of_lattice<3>(3, 5, 5);
  expect_hull_of_lattice<4>(4, 3, 1);
  expect_hull_of_lattice<Eigen::Dynamic>(4, 3, 1);
}

TEST(ConvexHullD, OfMoreDimensionsThanMinorsAreExpandedFor) {
  constexpr int dim = 17;
  std::vector<Point> points;
  for (int which = 0; which <= dim; ++which) {
    Point point;
    for (int axis = 0; axis < dim; ++axis) {
      point.push_back(start_coordinate(dim, which, axis));
    }
    points.push_back(point);
  }
  Grown<Eigen::Dynamic> grown(dim);
  for (Index i = 0; i <= dim; ++i) {
    grown.insert(points[i], i);
  }
  grown.insert(Point(dim, 0.01), dim + 1);
  const std::set<Facet> facets = grown.facets();
  EXPECT_EQ(facets.size(), dim + 1U);
  expect_hull(facets, points, dim);
}

TEST(ConvexHullD, StaysOpenWhereNoPointIs) {
  std::mt19937 random(1);
  std::vector<Point> points = random_points(3, 40, random);
  Grown<3> grown(3);
  for (Index i = 0; i < 40; ++i) {
    points[i][0] = std::abs(points[i][0]);
    grown.insert(points[i], i);
  }
  const std::set<Facet> facets = grown.facets();
  expect_hull(facets, points, 3);
  EXPECT_TRUE(std::any_of(facets.begin(), facets.end(),
                          [](const Facet& facet) { return is_start(facet.front()); }));
  EXPECT_EQ(grown.hull().squared_radius(), std::numeric_limits<double>::infinity());
}

TEST(ConvexHullD, KnowsTheFarthestCorner) {
  std::mt19937 random(2);
  const std::vector<Point> points = random_points(3, 60, random);
  Grown<3> grown(3);
  for (Index i = 0; i < 60; ++i) {
    grown.insert(points[i], i);
  }
  double farthest = 0;
  for (const Facet& facet : grown.facets()) {
    Eigen::Matrix3d rows;
    for (int i = 0; i < 3; ++i) {
      rows.row(i) = Eigen::Map<const Eigen::RowVector3d>(points[facet[i]].data());
    }
    const Eigen::Vector3d corner = rows.inverse() * Eigen::Vector3d::Ones();
    farthest = std::max(farthest, corner.squaredNorm());
  }
  EXPECT_NEAR(grown.hull().squared_radius(), farthest, 1e-9 * farthest);
}

/// Of whole numbers.
__extension__ using Wide = __int128;

Wide determinant(std::vector<std::vector<Wide>> rows) {
  if (rows.size() == 1) {
    return rows[0][0];
  }
  Wide sum = 0;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    std::vector<std::vector<Wide>> minor;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      minor.push_back(rows[i]);
      minor.back().erase(minor.back().begin() + static_cast<std::ptrdiff_t>(j));
    }
    sum += (j % 2 == 0 ? 1 : -1) * rows[0][j] * determinant(minor);
  }
  return sum;
}

TEST(ConvexHullD, OrientationIsExact) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> small(-2, 2);
  for (const int dim : {2, 3, 4, 5, 6}) {
    int zeros = 0;
    for (int round = 0; round < 200; ++round) {
      // Far from the origin, so that rounded determinants would be wrong.
      std::vector<Point> points(dim + 1, Point(dim));
      std::vector<const double*> pointers;
      std::vector<std::vector<Wide>> rows(dim, std::vector<Wide>(dim));
      std::vector<std::vector<int>> units(dim + 1, std::vector<int>(dim));
      for (int i = 0; i <= dim; ++i) {
        for (int axis = 0; axis < dim; ++axis) {
          units[i][axis] = small(random);
          points[i][axis] = 1.0 + units[i][axis] * 0x1p-50;
          if (i > 0) {
            rows[i - 1][axis] = units[i][axis] - units[0][axis];
          }
        }
        pointers.push_back(points[i].data());
      }
      const Wide exact = determinant(rows);
      const int expected = exact > 0 ? 1 : exact < 0 ? -1 : 0;
      zeros += expected == 0 ? 1 : 0;
      ASSERT_EQ(exact_orientation(dim, pointers.data()), expected) << dim;
    }
    EXPECT_GT(zeros, 0);
  }
}

/// Determinants down to 2^-(40 dim) beside entries of the size of one: what 53 bits tell, what
/// 106 tell, and what neither does.
TEST(ConvexHullD, OrientationIsExactWhereFewBitsAreLeft) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> small(-1, 1);
  for (const int dim : {3, 4, 5, 6, 8, 9, 12}) {
    for (int round = 0; round < 8 * (dim + 1); ++round) {
      // A unit lower times an upper triangular matrix: the determinant is the product of
      // the diagonal.
      const int num_short = round % (dim + 1);
      int expected = 1;
      std::vector<double> diagonal(dim);
      for (int i = 0; i < dim; ++i) {
        const int sign =
            round % 8 == 7 && i == 0 ? 0 : 2 * (small(random) > 0 ? 1 : 0) - 1;
        diagonal[i] = sign * (i < num_short ? 0x1p-40 : 1.0);
        expected *= sign;
      }
      std::vector<Point> points(dim + 1, Point(dim));
      std::vector<std::vector<int>> lower(dim, std::vector<int>(dim));
      std::vector<std::vector<int>> upper(dim, std::vector<int>(dim));
      for (int i = 0; i < dim; ++i) {
        for (int j = 0; j < dim; ++j) {
          lower[i][j] = small(random);
          upper[i][j] = small(random);
        }
      }
      for (int i = 0; i < dim; ++i) {
        for (int j = 0; j < dim; ++j) {
          for (int k = 0; k <= std::min(i, j); ++k) {
            points[i + 1][j] +=
                (k == i ? 1 : lower[i][k]) * (k == j ? diagonal[k] : upper[k][j]);
          }
        }
      }
      std::vector<const double*> pointers;
      for (const Point& point : points) {
        pointers.push_back(point.data());
      }
      ASSERT_EQ(exact_orientation(dim, pointers.data()), expected)
          << dim << ": " << round;
    }
  }
}

/// Points within rounding of a facet: taken where they are outside of it, and only there.
TEST(ConvexHullD, TakesWhatIsOutsideByTheLastBit) {
  const std::vector<Point> tetrahedron = {
      {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  // The facet without the first: x + y + z = -1.
  int taken = 0;
  int left = 0;
  for (int i = -3; i <= 3; ++i) {
    for (int j = -3; j <= 3; ++j) {
      Grown<3> grown(3);
      for (Index v = 0; v < 4; ++v) {
        grown.insert(tetrahedron[v], v);
      }
      const Point p = {-0.25 + i * 0x1p-54, -0.5 + j * 0x1p-53, -0.25};
      const bool outside = i + 2 * j < 0;
      EXPECT_EQ(grown.hull().insert(p.data()), outside) << i << ", " << j;
      (outside ? taken : left) += 1;
    }
  }
  EXPECT_GT(taken, 0);
  EXPECT_GT(left, 0);
}

}  // namespace
}  // namespace remanifold::detail
