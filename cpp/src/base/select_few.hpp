// SPDX-License-Identifier: GPL-3.0-or-later
// The value of a rank among few, such as a median over neighbors: ranks are counted, which
// costs no branch that nobody can predict, as partitioning does.
#pragma once

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
    const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
    std::fill(keys_.begin(), keys_.begin() + static_cast<std::ptrdiff_t>(padded),
              std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
      keys_[i] = static_cast<float>(values[i]);
    }
    float low = -std::numeric_limits<float>::infinity();
    float high = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
      const float key = keys_[i];
      if (key <= low || key >= high) {
        continue;
      }
      const auto [below, up_to] = count_around(key, padded);
      if (below > rank) {
        high = key;
      } else if (up_to <= rank) {
        low = key;
      } else {
        return among_equal(values, key, rank - below);
      }
    }
    // Infinite or of no float.
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }

 private:
  static constexpr std::size_t kMost = 64;
  static constexpr std::size_t kLanes = 4;

  struct Counts {
    std::size_t below;
    std::size_t up_to;
  };

  Counts count_around(float key, std::size_t padded) const {
    std::int32_t below[kLanes] = {};
    std::int32_t up_to[kLanes] = {};
    for (std::size_t j = 0; j < padded; j += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        below[lane] -= keys_[j + lane] < key ? -1 : 0;
        up_to[lane] -= keys_[j + lane] <= key ? -1 : 0;
      }
    }
    return {static_cast<std::size_t>((below[0] + below[1]) + (below[2] + below[3])),
            static_cast<std::size_t>((up_to[0] + up_to[1]) + (up_to[2] + up_to[3]))};
  }

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
};

}  // namespace remanifold::detail
