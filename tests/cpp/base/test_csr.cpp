// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csr.hpp"

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

TEST(Csr, NothingHasEmptyRows) {
  const auto none = detail::ragged_of<double>(3, [](const auto&) {});
  EXPECT_EQ(none.rows(), 3);
  EXPECT_EQ(none.size(1), 0);
  EXPECT_TRUE(none.values.empty());
}

}  // namespace
}  // namespace remanifold
