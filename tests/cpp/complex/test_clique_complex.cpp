// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace remanifold {
namespace {

using Rows = std::vector<std::vector<Index>>;

// 0 and 1 see each other; only 0 sees 2; 2 and 3 see each other.
const Csr kEdgeSets{{0, 2, 3, 4, 5}, {2, 1, 0, 3, 2}};

TEST(EdgeGraph, MutualAndEither) {
  EXPECT_EQ(testing::rows(graph_edges(edge_graph(kEdgeSets, EdgeRule::kMutual))),
            (Rows{{0, 1}, {2, 3}}));
  EXPECT_EQ(testing::rows(graph_edges(edge_graph(kEdgeSets, EdgeRule::kEither))),
            (Rows{{0, 1}, {0, 2}, {2, 3}}));
}

TEST(EdgeGraph, IgnoresLoopsAndRepetitions) {
  const Csr messy{{0, 4, 5}, {1, 1, 0, 0, 0}};
  EXPECT_EQ(testing::rows(graph_edges(edge_graph(messy, EdgeRule::kMutual))),
            (Rows{{0, 1}}));
}

TEST(EdgeGraph, RefusesBrokenRows) {
  EXPECT_THROW(edge_graph({{0, 2}, {0}}, EdgeRule::kMutual), std::invalid_argument);
  EXPECT_THROW(edge_graph({{0, 1}, {1}}, EdgeRule::kMutual), std::invalid_argument);
  EXPECT_THROW(edge_graph({{0, 1}, {-1}}, EdgeRule::kMutual), std::invalid_argument);
  EXPECT_THROW(edge_graph({{0, 2, 1, 2}, {0, 1}}, EdgeRule::kMutual),
               std::invalid_argument);
}

TEST(CliqueComplex, CompleteGraph) {
  Csr complete;
  for (Index i = 0; i < 5; ++i) {
    for (Index j = 0; j < 5; ++j) {
      if (i != j) {
        complete.indices.push_back(j);
      }
    }
    complete.offsets.push_back(static_cast<Offset>(complete.indices.size()));
  }
  EXPECT_EQ(clique_complex(complete, 1).size(), 10);
  EXPECT_EQ(clique_complex(complete, 2).size(), 10);
  EXPECT_EQ(
      testing::rows(clique_complex(complete, 3)),
      (Rows{{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 3, 4}, {0, 2, 3, 4}, {1, 2, 3, 4}}));
  EXPECT_EQ(clique_complex(complete, 4).size(), 1);
  EXPECT_EQ(clique_complex(complete, 5).size(), 0);
}

TEST(CliqueComplex, AllSubsetsThatAreCliques) {
  // Against trying all subsets of a random graph.
  const testing::Cloud random = testing::gaussian(20, 20, 1);
  Csr graph;
  const auto joined = [&](Index i, Index j) {
    return i != j && random[std::min(i, j)][std::max(i, j)] > -0.2;
  };
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 0; j < 20; ++j) {
      if (joined(i, j)) {
        graph.indices.push_back(j);
      }
    }
    graph.offsets.push_back(static_cast<Offset>(graph.indices.size()));
  }
  for (int dim = 1; dim <= 4; ++dim) {
    Rows expected;
    for (unsigned subset = 0; subset < 1U << 20; ++subset) {
      if (__builtin_popcount(subset) != dim + 1) {
        continue;
      }
      std::vector<Index> members;
      for (Index i = 0; i < 20; ++i) {
        if ((subset >> i & 1U) != 0) {
          members.push_back(i);
        }
      }
      bool clique = true;
      for (const Index a : members) {
        for (const Index b : members) {
          clique = clique && (a == b || joined(a, b));
        }
      }
      if (clique) {
        expected.push_back(members);
      }
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(testing::rows(clique_complex(graph, dim)), expected);
  }
}

TEST(CliqueComplex, RefusesDimensionZero) {
  EXPECT_THROW(clique_complex(kEdgeSets, 0), std::invalid_argument);
}

}  // namespace
}  // namespace remanifold
