// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/intrinsic_delaunay.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace remanifold {
namespace {

double area(double a, double b, double c) {
  const double s = (a + b + c) / 2;
  return std::sqrt(std::max(0.0, s * (s - a) * (s - b) * (s - c)));
}

double total(const std::vector<double>& lengths) {
  double sum = 0;
  for (std::size_t i = 0; i < lengths.size(); i += 3) {
    sum += area(lengths[i], lengths[i + 1], lengths[i + 2]);
  }
  return sum;
}

std::array<Index, 3> sorted_row(const SimplexArray& triangles, Offset t) {
  std::array<Index, 3> row{triangles[t][0], triangles[t][1], triangles[t][2]};
  std::sort(row.begin(), row.end());
  return row;
}

TEST(IntrinsicDelaunay, TakesTheOtherDiagonalOfAKite) {
  // Vertices 0 and 2 are near each other, 1 and 3 far apart; joined the long way.
  const double side = std::hypot(0.5, 2.0);
  const std::vector<double> lengths{side, 4, side, side, side, 4};
  for (const SimplexArray& kite :
       {SimplexArray{3, {1, 0, 3, 1, 3, 2}}, SimplexArray{3, {1, 0, 3, 3, 1, 2}}}) {
    // The side opposite to 2 is the long one in both.
    const std::vector<double> given =
        kite[1][0] == 1 ? std::vector<double>{side, 4, side, side, side, 4} : lengths;
    const IntrinsicTriangulation found = intrinsic_delaunay(kite, given);
    EXPECT_EQ(found.num_flips, 1);
    EXPECT_TRUE(found.complete);
    EXPECT_EQ(sorted_row(found.triangles, 0)[0], 0);
    EXPECT_EQ(sorted_row(found.triangles, 1)[0], 0);
    EXPECT_NEAR(*std::min_element(found.lengths.begin(), found.lengths.end()), 1,
                1e-14);
    EXPECT_NEAR(total(found.lengths), 2, 1e-14);
  }
}

TEST(IntrinsicDelaunay, SewsBothSidesTogether) {
  // One obtuse triangle: its long side is flipped to the other side of the paper, and what
  // was obtuse is gone.
  const double side = std::hypot(2.0, 0.5);
  const std::vector<double> lengths{4, side, side};
  const SimplexArray one{3, {7, 3, 5}};
  EXPECT_EQ(intrinsic_delaunay(one, lengths).num_flips, 0);
  const IntrinsicTriangulation found = intrinsic_delaunay(one, lengths, true);
  ASSERT_EQ(found.triangles.size(), 2);
  EXPECT_EQ(found.num_flips, 1);
  EXPECT_NEAR(total(found.lengths), 2, 1e-14);  // both sides
  for (Offset t = 0; t < 2; ++t) {
    EXPECT_NEAR(*std::max_element(found.lengths.begin() + 3 * t,
                                  found.lengths.begin() + 3 * t + 3),
                side, 1e-14);
  }
  // Three triangles at an edge, and each of them has two neighbors on the cover.
  const SimplexArray pages{3, {0, 1, 2, 0, 1, 3, 1, 0, 4}};
  const std::vector<double> regular(9, 1.0);
  const IntrinsicTriangulation book = intrinsic_delaunay(pages, regular, true);
  EXPECT_EQ(book.triangles.size(), 6);
  EXPECT_EQ(book.num_flips, 0);
  EXPECT_TRUE(book.complete);
}

TEST(IntrinsicDelaunay, KeepsTheAreaOfAStripTwistedOrNot) {
  // A ring of long thin triangles between two closed rows of vertices, glued straight or
  // turned over: an annulus, or a Moebius band on one row.
  for (const bool twisted : {false, true}) {
    const Index n = 12;
    SimplexArray strip{3, {}};
    std::vector<double> lengths;
    // Flat coordinates: the lower row at height 0, the upper one sheared by seven steps.
    const auto length = [](double along, double up) { return std::hypot(along, up); };
    const auto number = [&](Index i, bool upper) {
      const bool turned = twisted && i >= n;
      return i % n + (upper != turned ? n : 0);
    };
    for (Index i = 0; i < n; ++i) {
      strip.vertices.insert(strip.vertices.end(),
                            {number(i, false), number(i + 1, false), number(i, true)});
      lengths.insert(lengths.end(), {length(6, 1), length(7, 1), 1.0});
      strip.vertices.insert(
          strip.vertices.end(),
          {number(i + 1, false), number(i + 1, true), number(i, true)});
      lengths.insert(lengths.end(), {1.0, length(6, 1), length(7, 1)});
    }
    const IntrinsicTriangulation found = intrinsic_delaunay(strip, lengths);
    EXPECT_GT(found.num_flips, n);
    EXPECT_TRUE(found.complete);
    EXPECT_NEAR(total(found.lengths), total(lengths), 1e-12);
    const auto longest = std::max_element(found.lengths.begin(), found.lengths.end());
    // Turned over, the shear changes its direction where the ends meet.
    EXPECT_LT(*longest, twisted ? 2 : 1.5);
  }
}

TEST(IntrinsicDelaunay, LeavesWhatIsNoTriangle) {
  const SimplexArray two{3, {0, 1, 2, 0, 1, 3}};
  const std::vector<double> lengths{1, 1, 5, 3, 3, 5};
  const IntrinsicTriangulation found = intrinsic_delaunay(two, lengths);
  EXPECT_EQ(found.triangles.vertices, two.vertices);
  EXPECT_EQ(found.lengths, lengths);
}

TEST(IntrinsicDelaunay, RefusesOtherSimplices) {
  EXPECT_THROW(intrinsic_delaunay(SimplexArray{2, {0, 1}}, {1, 1}),
               std::invalid_argument);
  EXPECT_THROW(intrinsic_delaunay(SimplexArray{3, {0, 1, 2}}, {1, 1}),
               std::invalid_argument);
}

}  // namespace
}  // namespace remanifold
