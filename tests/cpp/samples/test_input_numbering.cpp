// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/input_numbering.hpp"
#include "support.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace remanifold {
namespace {

using testing::Cloud;

// Samples 1 and 3 coincide.
const Cloud kCloud{{9, 0, 1, 1, 5, 5, 1, 1, 0, 8}, 2};

TEST(InputNumbering, VerticesAscendInTheCallersNumbers) {
  const Samples samples = Samples::from_points(kCloud.view());
  const std::vector<Index> canonical = samples.canonical_indices();
  EXPECT_EQ(
      to_input(samples, std::vector<Index>{canonical[4], canonical[3], canonical[0]}),
      (std::vector<Index>{0, 1, 4}));
}

TEST(InputNumbering, FlagsOfMergedSamplesAreJoined) {
  const Samples samples = Samples::from_points(kCloud.view());
  const std::vector<Index> canonical = samples.canonical_indices();
  const auto flags = flags_to_canonical(samples, {0, 0, 1, 1, 0});
  ASSERT_EQ(flags.size(), 4U);
  EXPECT_EQ(flags[canonical[1]], 1);
  EXPECT_EQ(flags[canonical[2]], 1);
  EXPECT_EQ(flags[canonical[0]] + flags[canonical[4]], 0);
}

TEST(InputNumbering, SignsSwapTheLastTwoColumns) {
  const Samples samples = Samples::from_points(kCloud.view());
  const std::vector<Index> c = samples.canonical_indices();
  std::vector<Index> row{c[0], c[1], c[2]};
  // The parity of the way from ascending canonical numbers to those of the caller.
  int sign = 1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      sign = row[j] > row[i] ? -sign : sign;
    }
  }
  std::sort(row.begin(), row.end());
  const auto signs = [&](int s) {
    return std::vector<std::int8_t>{static_cast<std::int8_t>(s * sign)};
  };
  EXPECT_EQ(to_input(samples, {3, row}, signs(1)).vertices,
            (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(to_input(samples, {3, row}, signs(-1)).vertices,
            (std::vector<Index>{0, 2, 1}));
  EXPECT_EQ(to_input(samples, {3, row}, {}).vertices, (std::vector<Index>{0, 1, 2}));
}

}  // namespace
}  // namespace remanifold
