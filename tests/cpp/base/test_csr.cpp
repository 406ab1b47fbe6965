// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csr.hpp"
#include "base/parallel_csr.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace remanifold {
namespace {

TEST(Csr, RowsKeepTheOrderOfTheirValues) {
  const std::vector<std::pair<Offset, Index>> given{{2, 7}, {0, 5}, {2, 3}, {2, 4}};
  const Csr csr = detail::csr_of(4, [&](const auto& add) {
    for (const auto& [row, value] : given) {
      add(row, value);
    }
  });
  EXPECT_EQ(csr.offsets, (std::vector<Offset>{0, 1, 1, 4, 4}));
  EXPECT_EQ(csr.indices, (std::vector<Index>{5, 7, 3, 4}));
}

TEST(Csr, ThreadsChangeNothing) {
  constexpr Offset rows = 20'000;
  const auto each = [&](const auto& add) {
    for (Offset i = 0; i < 3 * rows; ++i) {
      add(i * 7919 % rows, static_cast<Index>(i));
    }
  };
  const detail::Ragged<Index> expected = detail::ragged_of<Index>(rows, each);
  for (const int threads : {1, 2, 7}) {
    const detail::Ragged<Index> found =
        detail::ragged_of<Index>(rows, Execution{threads, nullptr}, each);
    EXPECT_EQ(found.offsets, expected.offsets) << threads;
    EXPECT_EQ(found.values, expected.values) << threads;
  }
}

TEST(Csr, NothingHasEmptyRows) {
  const auto none = detail::ragged_of<double>(3, [](const auto&) {});
  EXPECT_EQ(none.rows(), 3);
  EXPECT_EQ(none.size(1), 0);
  EXPECT_TRUE(none.values.empty());
}

}  // namespace
}  // namespace remanifold
