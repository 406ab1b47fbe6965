// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/facets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace remanifold {
namespace {

using testing::kProjectivePlane;
using testing::kTetrahedron;

TEST(Facets, GroupsAreInOrderOfTheirVertices) {
  const SimplexArray triangles{3, {0, 1, 2, 1, 2, 3}};
  const FacetGroups groups = group_facets(triangles, 4);
  // 01, 02, 12 twice, 13, 23
  EXPECT_EQ(groups.offsets, (std::vector<Offset>{0, 1, 2, 4, 5, 6}));
  EXPECT_EQ(groups.facets, (std::vector<FacetNumber>{2, 1, 0, 5, 4, 3}));
  EXPECT_EQ(groups.cofaces(2), 2);
  std::vector<Index> facet(2);
  copy_facet(triangles, 4, facet.data());
  EXPECT_EQ(facet, (std::vector<Index>{1, 3}));
  EXPECT_EQ(testing::rows(edges_of(triangles, 4)),
            (std::vector<std::vector<Index>>{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}}));
}

TEST(Facets, NothingHasNone) {
  const SimplexArray none{3, {}};
  EXPECT_EQ(group_facets(none, 4).size(), 0);
  EXPECT_TRUE(facet_neighbors(none, 4).empty());
  EXPECT_TRUE(orient_patches(facet_neighbors(none, 4), 3).sizes.empty());
}

TEST(Facets, NeighborsAcrossOpenPairedAndBranchingOnes) {
  const SimplexArray pair{3, {0, 1, 2, 1, 2, 3}};
  EXPECT_EQ(facet_neighbors(pair, 4),
            (std::vector<FacetNumber>{5, kOpen, kOpen, kOpen, kOpen, 0}));
  const SimplexArray three{3, {0, 1, 2, 1, 2, 3, 1, 2, 4}};
  const std::vector<FacetNumber> neighbors = facet_neighbors(three, 5);
  EXPECT_EQ(std::count(neighbors.begin(), neighbors.end(), kBranching), 3);
  EXPECT_EQ(std::count(neighbors.begin(), neighbors.end(), kOpen), 6);
}

/// What the signed simplices on both sides of a facet add up to there.
int sum_across(const OrientedPatches& patches, FacetNumber a, FacetNumber b,
               int arity) {
  const auto part = [&](FacetNumber f) {
    return patches.sign[f / arity] * (f % arity % 2 == 0 ? 1 : -1);
  };
  return part(a) + part(b);
}

TEST(Facets, OrientationsAgreeAcrossFacets) {
  for (int dim = 1; dim <= 5; ++dim) {
    SimplexArray sphere{dim + 1, {}};
    for (Index out = 0; out <= dim + 1; ++out) {
      for (Index v = 0; v <= dim + 1; ++v) {
        if (v != out) {
          sphere.vertices.push_back(v);
        }
      }
    }
    const std::vector<FacetNumber> neighbors = facet_neighbors(sphere, dim + 2);
    const OrientedPatches patches = orient_patches(neighbors, dim + 1);
    EXPECT_EQ(patches.sizes, (std::vector<Offset>{dim + 2}));
    EXPECT_EQ(patches.orientable, (std::vector<std::uint8_t>{1}));
    EXPECT_EQ(patches.sign[0], 1);
    for (std::size_t f = 0; f < neighbors.size(); ++f) {
      ASSERT_GE(neighbors[f], 0);
      EXPECT_EQ(sum_across(patches, static_cast<FacetNumber>(f), neighbors[f], dim + 1),
                0);
    }
  }
}

TEST(Facets, PatchesAreCountedInOrderOfTheFirst) {
  SimplexArray both = kProjectivePlane;
  for (const Index v : kTetrahedron.vertices) {
    both.vertices.push_back(v + 6);
  }
  const OrientedPatches patches = orient_patches(facet_neighbors(both, 10), 3);
  EXPECT_EQ(patches.sizes, (std::vector<Offset>{10, 4}));
  EXPECT_EQ(patches.orientable, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(patches.patch[9], 0);
  EXPECT_EQ(patches.patch[10], 1);
}

/// A grid on a torus, two triangles a cell, rows sorted; the last column may be joined to
/// the first upside down, which makes it a Klein bottle.
SimplexArray grid_surface(Index columns, Index lines, bool twisted) {
  const auto vertex = [&](Index i, Index j) {
    const Index line = i == columns && twisted ? lines - j : j;
    return (i % columns) * lines + line % lines;
  };
  std::vector<std::vector<Index>> triangles;
  for (Index i = 0; i < columns; ++i) {
    for (Index j = 0; j < lines; ++j) {
      const Index a = vertex(i, j);
      const Index b = vertex(i + 1, j + 1);
      triangles.push_back({a, vertex(i + 1, j), b});
      triangles.push_back({a, vertex(i, j + 1), b});
    }
  }
  for (std::vector<Index>& triangle : triangles) {
    std::sort(triangle.begin(), triangle.end());
  }
  std::sort(triangles.begin(), triangles.end());
  SimplexArray surface{3, {}};
  for (const std::vector<Index>& triangle : triangles) {
    surface.vertices.insert(surface.vertices.end(), triangle.begin(), triangle.end());
  }
  return surface;
}

TEST(Facets, PatchesReachAcrossBlocksInAnyOrder) {
  const SimplexArray sorted = grid_surface(300, 150, false);
  std::vector<Offset> order(sorted.size());
  std::iota(order.begin(), order.end(), Offset{0});
  std::mt19937 random(1);
  for (int round = 0; round < 2; ++round) {
    SimplexArray torus{3, {}};
    for (const Offset s : order) {
      torus.vertices.insert(torus.vertices.end(), sorted[s], sorted[s] + 3);
    }
    std::shuffle(order.begin(), order.end(), random);
    const std::vector<FacetNumber> neighbors = facet_neighbors(torus, 45'000);
    const OrientedPatches patches = orient_patches(neighbors, 3, {2, nullptr});
    EXPECT_EQ(patches.sizes, (std::vector<Offset>{90'000}));
    EXPECT_EQ(patches.orientable, (std::vector<std::uint8_t>{1}));
    EXPECT_EQ(patches.closed, (std::vector<std::uint8_t>{1}));
    for (std::size_t f = 0; f < neighbors.size(); ++f) {
      ASSERT_EQ(sum_across(patches, static_cast<FacetNumber>(f), neighbors[f], 3), 0);
    }
  }
  const SimplexArray klein = grid_surface(300, 150, true);
  EXPECT_EQ(orient_patches(facet_neighbors(klein, 45'000), 3).orientable,
            (std::vector<std::uint8_t>{0}));
}

TEST(Facets, ShortNumbersSayTheSame) {
  // A torus, two triangles that its edges branch at, and what has nothing to do with it.
  SimplexArray simplices = grid_surface(40, 30, false);
  for (const Index v : {0, 1, 1300, 0, 1, 1301, 1302, 1303, 1304}) {
    simplices.vertices.push_back(v);
  }
  ASSERT_TRUE(has_few_facets(simplices));
  const std::vector<FacetNumber> neighbors = facet_neighbors(simplices, 1305);
  const std::vector<std::int32_t> few =
      facet_neighbors<std::int32_t>(simplices, 1305, {2, nullptr});
  EXPECT_TRUE(std::equal(few.begin(), few.end(), neighbors.begin(), neighbors.end()));
  const OrientedPatches expected = orient_patches(neighbors, 3);
  for (const OrientedPatches& patches :
       {orient_patches(few, 3), orient_patches(simplices, 1305)}) {
    EXPECT_EQ(patches.patch, expected.patch);
    EXPECT_EQ(patches.sign, expected.sign);
    EXPECT_EQ(patches.closed, expected.closed);
  }
}

TEST(Facets, ExtendedPatchesAreThoseOfTheWhole) {
  for (const bool twisted : {false, true}) {
    const SimplexArray surface = grid_surface(12, 9, twisted);
    const auto whole = [](const SimplexArray& simplices) {
      return orient_patches(facet_neighbors(simplices, 108), 3);
    };
    // Known: all but two rings, which leaves two patches; then one ring or both come back.
    for (const int rings : {1, 2}) {
      SimplexArray known{3, {}};
      SimplexArray simplices{3, {}};
      std::vector<std::uint8_t> around(108, 0);
      for (Offset s = 0; s < surface.size(); ++s) {
        const Index column = surface[s][0] / 9;
        const Index last = surface[s][2] / 9;
        const bool first_ring = column == 3 && last == 4;
        const bool second_ring = column == 7 && last == 8;
        if (!first_ring && !second_ring) {
          known.vertices.insert(known.vertices.end(), surface[s], surface[s] + 3);
        } else {
          for (int i = 0; i < 3; ++i) {
            around[surface[s][i]] = 1;
          }
        }
        if (!second_ring || rings == 2) {
          simplices.vertices.insert(simplices.vertices.end(), surface[s],
                                    surface[s] + 3);
        }
      }
      const OrientedPatches before = whole(known);
      ASSERT_EQ(before.sizes.size(), 2U);
      const auto after = extend_patches(known, known.size(), before, simplices, around);
      const OrientedPatches expected = whole(simplices);
      ASSERT_TRUE(after.has_value());
      EXPECT_EQ(after->patch, expected.patch);
      EXPECT_EQ(after->sizes, expected.sizes);
      EXPECT_EQ(after->orientable, expected.orientable);
      EXPECT_EQ(after->closed, expected.closed);
      if (expected.orientable[0] != 0) {
        EXPECT_EQ(after->sign, expected.sign);
      }
      EXPECT_FALSE(
          extend_patches(simplices, simplices.size(), expected, known, around));
    }
  }
}

}  // namespace
}  // namespace remanifold
