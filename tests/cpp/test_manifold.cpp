// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/cavities.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/minimum_chain.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/star_consensus.hpp"
#include "remanifold/vertex_insertion.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace remanifold {
namespace {

using testing::Cloud;

const SimplexArray kTetrahedron{3, {0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3}};
const SimplexArray kProjectivePlane{3, {0, 1, 2, 0, 1, 4, 0, 2, 5, 0, 3, 4, 0, 3, 5,
                                        1, 2, 3, 1, 3, 5, 1, 4, 5, 2, 3, 4, 2, 4, 5}};

/// Samples that keep their numbers, which points do not.
struct Numbered {
  std::vector<double> distances;
  Samples samples;

  explicit Numbered(const Cloud& cloud)
      : distances(testing::distances_of(cloud)),
        samples(
            Samples::from_distances({distances.data(), cloud.size(), cloud.size()})) {}
};

// --- Facets --------------------------------------------------------------------

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
  EXPECT_TRUE(orient_patches({}, 3).sizes.empty());
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

// --- Votes ---------------------------------------------------------------------

TEST(StarConsensus, VotesAreCounted) {
  LocalRegions regions;
  regions.dim = 2;
  // 0 sees {0 1 2}; 1 and 2 see it and {1 2 3}; 3 sees {0 2 3} only.
  regions.star_offsets = {0, 1, 3, 5, 6};
  regions.stars = {1, 2, 0, 2, 2, 3, 1, 3, 0, 1, 0, 2};
  StarSimplices found = count_votes(regions);
  ASSERT_EQ(found.simplices.size(), 3);
  std::vector<std::pair<std::vector<Index>, int>> votes;
  for (Offset s = 0; s < 3; ++s) {
    votes.emplace_back(testing::rows(found.simplices)[s], found.votes[s]);
    EXPECT_EQ(found.agreed(s), found.votes[s] == 3);
  }
  std::sort(votes.begin(), votes.end());
  EXPECT_EQ(votes, (std::vector<std::pair<std::vector<Index>, int>>{
                       {{0, 1, 2}, 3}, {{0, 2, 3}, 1}, {{1, 2, 3}, 2}}));
}

// --- Measures ------------------------------------------------------------------

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

TEST(SimplexMeasures, OpeningAHoleCostsWhatFillingItWould) {
  // A disk of radius r in units of h: energy against the length of its rim.
  EXPECT_DOUBLE_EQ(open_price(1, 2), 32);
  EXPECT_DOUBLE_EQ(open_price(2, 2), 24);
  EXPECT_DOUBLE_EQ(open_price(3, 1), 8.0 / 3);
}

// --- Cavities ------------------------------------------------------------------

/// A square, one corner moved inwards, with a fixed triangle on each side.
struct SquareHole {
  Numbered given{{{0, 0, 1, 0, 0.8, 0.8, 0, 1, 0.5, -1, 2, 0.5, 0.5, 2, -1, 0.5}, 2}};
  std::vector<double> scales = std::vector<double>(8, 1.0);
  SimplexRuler ruler{given.samples, scales};
  SimplexArray fixed{3, {0, 1, 4, 1, 2, 5, 2, 3, 6, 0, 3, 7}};
  SimplexArray candidates{3, {1, 2, 3, 0, 1, 2, 0, 1, 3, 0, 2, 3, 0, 1, 2}};
  std::vector<std::uint8_t> inside{1, 1, 1, 1, 0, 0, 0, 0};

  Cavities find(double price) {
    return find_cavities(fixed, inside, candidates, ruler,
                         [=](const Index*) { return price; });
  }
};

TEST(Cavities, SquareHole) {
  SquareHole hole;
  const Cavities cavities = hole.find(7);
  EXPECT_EQ(
      testing::rows(cavities.candidates),
      (std::vector<std::vector<Index>>{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(cavities.count(), 1);
  EXPECT_EQ(cavities.candidates_in.size(0), 4);
  EXPECT_EQ(testing::rows(cavities.facets),
            (std::vector<std::vector<Index>>{
                {0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
  // 4 is the third vertex of the first fixed triangle, and so on.
  EXPECT_EQ(cavities.rims, (std::vector<FacetNumber>{2, kOpen, 11, 5, kOpen, 8}));
  EXPECT_EQ(cavities.prices, std::vector<double>(6, 7.0));
  EXPECT_TRUE(cavities.dead_ends.empty());
  EXPECT_EQ(cavities.facets_of[0], 3);  // 12 is opposite to 0 in 012
  for (Index c = 0; c < 4; ++c) {
    EXPECT_DOUBLE_EQ(cavities.energies[c],
                     hole.ruler.energy(cavities.candidates[c], 3));
  }
}

TEST(Cavities, NoRoomBehindAFacetWithBothCofaces) {
  SquareHole hole;
  hole.fixed.vertices.insert(hole.fixed.vertices.end(), {0, 1, 6});
  const Cavities cavities = hole.find(7);
  EXPECT_EQ(testing::rows(cavities.candidates),
            (std::vector<std::vector<Index>>{{0, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(cavities.count(), 1);
  // Nothing continues a fixed triangle without candidates.
  hole.candidates.vertices = {0, 2, 3};
  EXPECT_EQ(hole.find(7).dead_ends, (std::vector<FacetNumber>{5}));
}

TEST(Cavities, ApartWhereNoFacetIsShared) {
  SquareHole hole;
  hole.candidates.vertices = {0, 1, 2, 0, 1, 3, 4, 5, 6};
  hole.inside.assign(8, 1);
  const Cavities cavities = hole.find(7);
  EXPECT_EQ(cavities.count(), 2);
  EXPECT_EQ(cavities.candidates_in.size(0), 2);
  EXPECT_EQ(cavities.candidates_in.size(1), 1);
  EXPECT_EQ(cavities.facets_in.size(0), 5);
}

/// The two that share the cheaper diagonal, by the energies of both pairs.
std::vector<Index> cheapest_pair(const Cavities& cavities) {
  const std::vector<double>& e = cavities.energies;
  return e[0] + e[2] < e[1] + e[3] ? std::vector<Index>{0, 2}
                                   : std::vector<Index>{1, 3};
}

TEST(MinimumChain, SearchTakesTheCheaperDiagonal) {
  SquareHole hole;
  const Cavities cavities = hole.find(1000);
  const ChainFill fill = fill_cavities(cavities, hole.fixed, nullptr, 8, {}, {});
  EXPECT_EQ(fill.chosen, cheapest_pair(cavities));
  EXPECT_EQ(fill.chosen, (std::vector<Index>{0, 2}));  // the shorter one
  EXPECT_EQ(fill.open, (std::vector<std::uint8_t>{0}));
  EXPECT_EQ(fill.searched, 1);
  EXPECT_EQ(fill.programs + fill.integer_programs + fill.unsolved, 0);
}

TEST(MinimumChain, HoleStaysWhereThatIsCheaper) {
  SquareHole hole;
  const Cavities cavities = hole.find(0.01);
  const ChainFill fill = fill_cavities(cavities, hole.fixed, nullptr, 8, {}, {});
  EXPECT_TRUE(fill.chosen.empty());
  EXPECT_EQ(fill.open, (std::vector<std::uint8_t>{1}));
}

TEST(MinimumChain, SearchWithoutEndCountsAsUnsolved) {
  SquareHole hole;
  ChainOptions options;
  options.search_steps = 1;
  const ChainFill fill =
      fill_cavities(hole.find(1000), hole.fixed, nullptr, 8, options, {});
  EXPECT_EQ(fill.searched, 0);
  EXPECT_EQ(fill.unsolved, 1);
  EXPECT_EQ(fill.open, (std::vector<std::uint8_t>{1}));
}

/// All choices of the 2 x 4 signed candidates of the square hole; what is left open is
/// paid for.
std::vector<double> solve_by_trying(const LinearProgram& p) {
  const std::size_t signed_candidates = 8;
  const std::size_t facets = (p.costs.size() - signed_candidates) / 2;
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned choice = 0; choice < 1U << signed_candidates; ++choice) {
    std::vector<double> x(p.costs.size(), 0.0);
    for (std::size_t c = 0; c < signed_candidates; ++c) {
      x[c] = choice >> c & 1U;
    }
    bool fits = true;
    for (std::size_t row = 0; row < p.row_lower.size(); ++row) {
      double sum = 0;
      for (Offset i = p.offsets[row]; i < p.offsets[row + 1]; ++i) {
        sum += p.values[i] * x[p.columns[i]];
      }
      if (row < facets) {
        const double missing = p.row_lower[row] - sum;
        x[signed_candidates + row] = std::max(0.0, -missing);
        x[signed_candidates + facets + row] = std::max(0.0, missing);
      } else {
        fits = fits && sum <= p.row_upper[row];
      }
    }
    double cost = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      cost += p.costs[i] * x[i];
      fits = fits && x[i] <= p.upper[i];
    }
    if (fits && cost < least) {
      least = cost;
      best = x;
    }
  }
  return best;
}

TEST(MinimumChain, ProgramAndSearchAgree) {
  SquareHole hole;
  ChainOptions options;
  options.search_candidates = 0;
  int calls = 0;
  const ProgramSolver solver = [&](const LinearProgram& program) {
    ++calls;
    EXPECT_EQ(program.offsets.size(), program.row_lower.size() + 1);
    EXPECT_EQ(program.row_upper.size(), program.row_lower.size());
    EXPECT_EQ(program.upper.size(), program.costs.size());
    EXPECT_EQ(program.columns.size(), program.values.size());
    EXPECT_TRUE(program.integral.empty());
    return solve_by_trying(program);
  };
  for (const double price : {1000.0, 0.01}) {
    const Cavities cavities = hole.find(price);
    const ChainFill searched = fill_cavities(cavities, hole.fixed, nullptr, 8, {}, {});
    const ChainFill solved =
        fill_cavities(cavities, hole.fixed, nullptr, 8, options, solver);
    EXPECT_EQ(solved.chosen, searched.chosen);
    EXPECT_EQ(solved.open, searched.open);
    EXPECT_EQ(solved.searched, 0);
    EXPECT_EQ(solved.programs, 1);
    EXPECT_EQ(solved.unsolved, 0);
  }
  // The four sides are oriented each by itself: all relative signs are tried.
  EXPECT_EQ(calls, 2 * 8);
}

TEST(MinimumChain, ProgramWithoutSolutionCountsAsUnsolved) {
  SquareHole hole;
  ChainOptions options;
  options.search_candidates = 0;
  const ChainFill fill =
      fill_cavities(hole.find(1000), hole.fixed, nullptr, 8, options,
                    [](const LinearProgram&) { return std::vector<double>(); });
  EXPECT_TRUE(fill.chosen.empty());
  EXPECT_EQ(fill.unsolved, 1);
  EXPECT_EQ(fill.open, (std::vector<std::uint8_t>{1}));
}

// --- Insertion -----------------------------------------------------------------

struct Insert {
  Samples samples;
  Insertion insertion;
  SimplexArray simplices;

  Insert(const Cloud& cloud, SimplexArray given, double max_distance)
      : samples(Samples::from_points(cloud.view())) {
    const std::vector<Index> canonical = samples.canonical_indices();
    for (Index& v : given.vertices) {
      v = canonical[v];
    }
    for (Offset s = 0; s < given.size(); ++s) {
      std::sort(given.vertices.begin() + s * given.arity,
                given.vertices.begin() + (s + 1) * given.arity);
    }
    simplices = given;
    const NeighborSearch search(samples);
    const Neighborhoods near = find_neighborhoods(samples, search, samples.size() - 1);
    const std::vector<double> scales = local_scales(samples, near, given.arity - 1);
    insertion = insert_vertices(samples, near, scales, max_distance, simplices);
    for (std::vector<Index>* numbers : {&insertion.inserted, &insertion.outliers}) {
      for (Index& v : *numbers) {
        v = samples.input_index(v);
      }
      std::sort(numbers->begin(), numbers->end());
    }
  }
};

TEST(VertexInsertion, SubdividesWhatIsNear) {
  // A tetrahedron; a sample on a face, one by an edge, one far away.
  const Cloud cloud{
      {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.3, 0.3, -0.01, 0.5, -0.01, -0.01, 9, 9, 9},
      3};
  const Insert found(cloud, kTetrahedron, 0.5);
  EXPECT_EQ(found.insertion.inserted, (std::vector<Index>{4, 5}));
  EXPECT_EQ(found.insertion.outliers, (std::vector<Index>{6}));
  EXPECT_EQ(found.simplices.size(), 8);
  const Topology t = compute_topology(found.simplices, 7);
  EXPECT_EQ(t.euler_characteristic, 2);
  EXPECT_TRUE(t.closed);
  EXPECT_TRUE(t.singular_vertices.empty());
  std::vector<std::vector<Index>> sorted = testing::rows(found.simplices);
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, testing::rows(found.simplices));
}

TEST(VertexInsertion, NothingToInsert) {
  const Cloud cloud{{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 3};
  const Insert found(cloud, kTetrahedron, 0.5);
  EXPECT_TRUE(found.insertion.inserted.empty());
  EXPECT_TRUE(found.insertion.outliers.empty());
  EXPECT_EQ(found.simplices.vertices, kTetrahedron.vertices);
  const Insert nowhere(cloud, {3, {}}, 0.5);
  EXPECT_EQ(nowhere.insertion.outliers.size(), 4U);
  EXPECT_EQ(nowhere.simplices.size(), 0);
}

// --- The whole method, without a solver ----------------------------------------

ReconstructOptions options_of(int dim) {
  ReconstructOptions options;
  options.dim = dim;
  options.outlier_distance = 0;
  return options;
}

TEST(BuildManifold, SphereWithoutASolver) {
  const Cloud cloud = testing::sphere(300, 2, 1);
  const Samples samples = Samples::from_points(cloud.view());
  const NeighborSearch search(samples);
  const Neighborhoods near = find_neighborhoods(samples, search, jet_neighbors(2));
  const TangentSpaces tangents =
      compute_tangent_spaces(samples, near, {2, jet_neighbors(2), Estimator::kJet});
  const LocalRegions regions = compute_local_regions(samples, search, near, tangents);
  const ManifoldComplex complex =
      build_manifold(samples, near, tangents, regions, {}, {});
  const Topology t = compute_topology(complex.simplices, 300);
  EXPECT_EQ(t.face_counts, (std::vector<Offset>{300, 894, 596}));
  EXPECT_TRUE(t.closed);
  EXPECT_TRUE(t.singular_vertices.empty());
  EXPECT_EQ(complex.report.open_facets.size(), 0);
  EXPECT_EQ(complex.report.branching_facets.size(), 0);
  EXPECT_TRUE(complex.report.singular.empty());
  EXPECT_TRUE(complex.report.outliers.empty());
  EXPECT_GT(complex.report.agreed, 500);
  EXPECT_EQ(complex.report.programs, 0);
  EXPECT_EQ(complex.report.unsolved, 0);
}

TEST(BuildManifold, ClosedSurfacesLookOutwards) {
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

TEST(BuildManifold, AnythingEndsWithoutASolver) {
  for (int dim = 1; dim <= 2; ++dim) {
    const Cloud cloud = testing::gaussian(150, 4, 3);
    const Samples samples = Samples::from_points(cloud.view());
    const Reconstruction one = reconstruct(samples, options_of(dim), {}, {1, nullptr});
    const Reconstruction two = reconstruct(samples, options_of(dim), {}, {3, nullptr});
    EXPECT_EQ(one.simplices.vertices, two.simplices.vertices);
    EXPECT_EQ(one.report.programs + one.report.integer_programs, 0);
  }
}

TEST(BuildManifold, StopsWhenCancelled) {
  const Cloud cloud = testing::sphere(500, 2, 3);
  const Samples samples = Samples::from_points(cloud.view());
  Progress progress;
  progress.cancel = true;
  EXPECT_THROW(reconstruct(samples, options_of(2), {}, {2, &progress}), Cancelled);
}

TEST(BuildManifold, ErrorsOfTheSolverComeOut) {
  const Cloud cloud = testing::gaussian(300, 4, 3);
  const Samples samples = Samples::from_points(cloud.view());
  const ProgramSolver fails = [](const LinearProgram&) -> std::vector<double> {
    throw std::runtime_error("no licence");
  };
  EXPECT_THROW(reconstruct(samples, options_of(2), fails), std::runtime_error);
}

}  // namespace
}  // namespace remanifold
