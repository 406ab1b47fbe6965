// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/curve_repair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace remanifold {
namespace {

using testing::Numbered;

/// Samples on a circle, and edges between them to be repaired.
struct Curve {
  static testing::Cloud circle(Index n) {
    testing::Cloud cloud{{}, 2};
    for (Index i = 0; i < n; ++i) {
      const double angle = 2 * std::acos(-1.0) * i / n;
      cloud.points.push_back(std::cos(angle));
      cloud.points.push_back(std::sin(angle));
    }
    return cloud;
  }

  explicit Curve(Index n) : given(circle(n)) {}
  explicit Curve(const testing::Cloud& cloud) : given(cloud) {}

  SimplexArray repaired(std::vector<Index> edges, double price) const {
    const NeighborSearch search(given.samples);
    const Neighborhoods near = find_neighborhoods(given.samples, search, 10);
    SimplexArray result{2, std::move(edges)};
    repair_curves(
        given.samples, near, local_scales(given.samples, near, 1),
        [=](const Index*) { return price; }, 10, result);
    return result;
  }

  Numbered given;
};

std::vector<Index> path(Index begin, Index end) {
  std::vector<Index> edges;
  for (Index i = begin; i + 1 < end; ++i) {
    edges.insert(edges.end(), {i, i + 1});
  }
  return edges;
}

/// Whether the edges are one closed curve through all samples.
bool is_circle(const SimplexArray& edges, Index n) {
  const Topology topology = compute_topology(edges, n);
  return edges.size() == n && topology.closed && topology.components == 1;
}

TEST(CurveRepair, JoinsEndsWhereOpenOnesCostMore) {
  const Curve curve(30);
  EXPECT_TRUE(is_circle(curve.repaired(path(0, 30), 1e5), 30));
  EXPECT_EQ(curve.repaired(path(0, 30), 0).size(), 29);
}

TEST(CurveRepair, JoinsEndsThatHaveADenserPartBetweenThem) {
  testing::Cloud cloud = Curve::circle(30);
  const testing::Cloud dense = Curve::circle(24);
  const double half = std::acos(-1.0) / 30;  // angle from an end to the middle
  for (Index i = 0; i < 24; ++i) {
    cloud.points.push_back(0.83 * std::cos(half) + 0.015 * dense.points[2 * i]);
    cloud.points.push_back(-0.83 * std::sin(half) + 0.015 * dense.points[2 * i + 1]);
  }
  std::vector<Index> edges = path(0, 30);
  const std::vector<Index> loop = path(30, 54);
  edges.insert(edges.end(), loop.begin(), loop.end());
  edges.insert(edges.end(), {30, 53});
  // Less than what it would cost to lead the curve through the loop.
  const SimplexArray repaired = Curve(cloud).repaired(edges, 800);
  const Topology topology = compute_topology(repaired, 54);
  EXPECT_TRUE(topology.closed);
  EXPECT_EQ(topology.components, 2);
  EXPECT_EQ(repaired.size(), 54);
}

TEST(CurveRepair, LetsGoOfALoopThatIsADetour) {
  // A hexagon, as evenly sampled as the circle, at so many steps from its first sample.
  const auto circle_and_hexagon = [](double steps) {
    testing::Cloud cloud = Curve::circle(40);
    const testing::Cloud hexagon = Curve::circle(6);
    const double step = 2 * std::sin(std::acos(-1.0) / 40);
    for (Index i = 0; i < 6; ++i) {
      cloud.points.push_back(1 + (steps + 1) * step + step * hexagon.points[2 * i]);
      cloud.points.push_back(step * hexagon.points[2 * i + 1]);
    }
    return cloud;
  };
  // The hexagon zigzags.
  std::vector<Index> edges = path(0, 40);
  edges.insert(edges.end(), {0, 43, 43, 44, 44, 42, 42, 45, 45, 41, 41, 40, 40, 39});
  for (const auto& [steps, parts] : {std::pair(5, 2), std::pair(2, 1)}) {
    const SimplexArray found = Curve(circle_and_hexagon(steps)).repaired(edges, 1e5);
    const Topology topology = compute_topology(found, 46);
    EXPECT_TRUE(topology.closed) << steps;
    EXPECT_EQ(topology.components, parts) << steps;
    EXPECT_EQ(found.size(), 46) << steps;
  }
}

TEST(CurveRepair, MergesTinyLoops) {
  const Curve curve(30);
  std::vector<Index> edges = path(4, 30);
  edges.insert(edges.end(), {4, 29});
  edges.insert(edges.end(), {0, 1, 1, 2, 2, 3, 0, 3});
  EXPECT_TRUE(is_circle(curve.repaired(edges, 1e5), 30));
}

}  // namespace
}  // namespace remanifold
