// SPDX-License-Identifier: GPL-3.0-or-later
#include "complexes.hpp"
#include "remanifold/minimum_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace remanifold {
namespace {

using testing::SquareHole;

/// The two that share the cheaper diagonal, by the energies of both pairs.
std::vector<Index> cheapest_pair(const Cavities& cavities) {
  const std::vector<double>& e = cavities.energies;
  return e[0] + e[2] < e[1] + e[3] ? std::vector<Index>{0, 2}
                                   : std::vector<Index>{1, 3};
}

TEST(MinimumChain, SearchTakesTheCheaperDiagonal) {
  SquareHole hole;
  const Cavities cavities = hole.find(1000);
  const ChainFill fill = fill_cavities(cavities, hole.fixed, 8, {}, {});
  EXPECT_EQ(fill.chosen, cheapest_pair(cavities));
  EXPECT_EQ(fill.chosen, (std::vector<Index>{0, 2}));  // the shorter one
  EXPECT_EQ(fill.open, (std::vector<std::uint8_t>{0}));
  EXPECT_EQ(fill.searched, 1);
  EXPECT_EQ(fill.programs + fill.integer_programs + fill.unsolved, 0);
}

/// A price of facets at which it is a little cheaper to leave the four sides open.
double open_is_cheaper(const Cavities& cavities) {
  const std::vector<double>& e = cavities.energies;
  return 0.24 * std::min(e[0] + e[2], e[1] + e[3]);
}

TEST(MinimumChain, HoleStaysWhereThatIsCheaper) {
  SquareHole hole;
  const Cavities cavities = hole.find(open_is_cheaper(hole.find(1000)));
  EXPECT_EQ(cavities.count(), 1);
  const ChainFill fill = fill_cavities(cavities, hole.fixed, 8, {}, {});
  EXPECT_TRUE(fill.chosen.empty());
  EXPECT_EQ(fill.open, (std::vector<std::uint8_t>{1}));
}

TEST(MinimumChain, SearchWithoutEndCountsAsUnsolved) {
  SquareHole hole;
  ChainOptions options;
  options.search_steps = 1;
  const ChainFill fill = fill_cavities(hole.find(1000), hole.fixed, 8, options, {});
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
  for (const double price : {1000.0, open_is_cheaper(hole.find(1000))}) {
    const Cavities cavities = hole.find(price);
    const ChainFill searched = fill_cavities(cavities, hole.fixed, 8, {}, {});
    const ChainFill solved = fill_cavities(cavities, hole.fixed, 8, options, solver);
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
      fill_cavities(hole.find(1000), hole.fixed, 8, options,
                    [](const LinearProgram&) { return std::vector<double>(); });
  EXPECT_TRUE(fill.chosen.empty());
  EXPECT_EQ(fill.unsolved, 1);
  EXPECT_EQ(fill.open, (std::vector<std::uint8_t>{1}));
}

}  // namespace
}  // namespace remanifold
