// SPDX-License-Identifier: GPL-3.0-or-later
// The value of a rank among few, such as a median over neighbors: ranks are counted, which
// costs no branch that nobody can predict, as partitioning does.
#pragma once

#include "base/rank_few.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace remanifold::detail {

/// One for each thread.
class FewSelector {
 public:
  /// What std::nth_element() puts at `rank`. No value may be NaN.
  /// \param values  come back in another order
  double select(std::vector<double>& values, std::size_t rank) {
    const std::size_t count = values.size();
    if (count > kMost) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
      std::nth_element(values.begin(), at, values.end());
      return *at;
    }
    const std::size_t padded =
        (count + kRankedTogether - 1) / kRankedTogether * kRankedTogether;
    for (std::size_t i = 0; i < count; ++i) {
      keys_[i] = static_cast<float>(values[i]);
    }
    for (std::size_t i = count; i < padded; ++i) {
      keys_[i] = std::numeric_limits<float>::infinity();
    }
    rank_few(keys_.data(), static_cast<Index>(padded), ranks_.data());
    // Equal keys have the rank of the first of them.
    const auto wanted = static_cast<std::int32_t>(rank);
    std::int32_t below = 0;
    for (std::size_t i = 0; i < count; ++i) {
      below = std::max(below, ranks_[i] <= wanted ? ranks_[i] : 0);
    }
    std::size_t place = 0;
    std::size_t equal = 0;
    for (std::size_t i = 0; i < count; ++i) {
      place = ranks_[i] == below ? i : place;
      equal += ranks_[i] == below ? 1 : 0;
    }
    return equal == 1 ? values[place]
                      : among_equal(values, keys_[place],
                                    rank - static_cast<std::size_t>(below));
  }

 private:
  static constexpr std::size_t kMost = 64;

  /// Values that are the same float are told apart as they are.
  double among_equal(std::vector<double>& values, float key, std::size_t rank) {
    std::size_t equal = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (keys_[i] == key) {
        std::swap(values[equal++], values[i]);
      }
    }
    if (equal > 1) {
      const auto first = values.begin();
      std::nth_element(first, first + static_cast<std::ptrdiff_t>(rank),
                       first + static_cast<std::ptrdiff_t>(equal));
    }
    return values[rank];
  }

  std::array<float, kMost> keys_{};
  std::array<std::int32_t, kMost> ranks_{};
};

}  // namespace remanifold::detail
