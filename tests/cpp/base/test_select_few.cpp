// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/select_few.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace remanifold {
namespace {

double nth_of(std::vector<double> values, std::size_t rank) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank),
                   values.end());
  return values[rank];
}

TEST(FewSelector, SelectsWhatSortingPutsThere) {
  std::mt19937 random(1);
  detail::FewSelector selector;
  for (std::size_t count = 1; count < 70; ++count) {
    for (const double step : {0.0, 1e-12, 0.25}) {
      // Many are equal, or differ by less than floats tell.
      std::vector<double> values(count);
      for (double& value : values) {
        value = step > 0 ? 1 + step * static_cast<double>(random() % 7)
                         : static_cast<double>(random()) / 1e9;
      }
      for (std::size_t rank = 0; rank < count; ++rank) {
        std::vector<double> some = values;
        EXPECT_EQ(selector.select(some, rank), nth_of(values, rank)) << count;
      }
    }
  }
}

TEST(FewSelector, ValuesBeyondFloats) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> values{1e300, 0.0, infinity, 1e-310, 3e-320, 2e300, 1.0};
  detail::FewSelector selector;
  for (std::size_t rank = 0; rank < values.size(); ++rank) {
    std::vector<double> some = values;
    EXPECT_EQ(selector.select(some, rank), nth_of(values, rank)) << rank;
  }
}

}  // namespace
}  // namespace remanifold
