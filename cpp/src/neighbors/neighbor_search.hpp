// SPDX-License-Identifier: GPL-3.0-or-later
// What a nearest-neighbor search has to provide; one implementation a file.
#pragma once

#include "remanifold/neighborhoods.hpp"

#include <algorithm>
#include <memory>

namespace remanifold {

class NeighborSearch::Implementation {
 public:
  virtual ~Implementation() = default;
  virtual std::unique_ptr<Query> query(const Execution& execution) const = 0;
  virtual Index block_size() const = 0;
  /// The `count` nearest others of all samples at once, where that is faster.
  /// \returns false where it is not
  virtual bool find_all(Index /*count*/, const Execution& /*execution*/,
                        Neighborhoods& /*result*/) const {
    return false;
  }
};

namespace detail {

/// Exact search by comparing with every sample.
std::unique_ptr<NeighborSearch::Implementation> make_brute_force(
    const Samples& samples);

/// Orders neighbors by squared distance, then by number: of points along the curve on which
/// they are sorted, whatever their order in the input.
struct NeighborOrder {
  bool operator()(const Neighbor& a, const Neighbor& b) const {
    return a.squared_distance != b.squared_distance
               ? a.squared_distance < b.squared_distance
               : a.index < b.index;
  }
};

/// Cuts the list to the `count` first in order and sorts these.
inline void keep_nearest(std::vector<Neighbor>& list, Index count,
                         const NeighborOrder& order) {
  if (static_cast<Offset>(list.size()) > count) {
    std::nth_element(list.begin(), list.begin() + count, list.end(), order);
    list.resize(count);
  }
  std::sort(list.begin(), list.end(), order);
}

}  // namespace detail
}  // namespace remanifold
