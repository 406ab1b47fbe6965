// SPDX-License-Identifier: GPL-3.0-or-later
// Squared distances between samples near each other, looked up in the neighborhoods of
// both and computed where neither has them. In many coordinates the products among the
// neighbors of a sample follow from these: <a-x, b-x> = (|a-x|^2 + |b-x|^2 - |a-b|^2) / 2.
#pragma once

#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
#include "samples/distance.hpp"

#include <algorithm>

namespace remanifold::detail {

/// From so many coordinates on looking up pays (measured).
constexpr int kManyCoordinates = 128;

class KnownDistances {
 public:
  KnownDistances(const Samples& samples, const Neighborhoods& neighborhoods)
      : samples_(&samples), neighborhoods_(&neighborhoods) {}

  /// Whether the neighborhoods of samples in many coordinates came with distances.
  bool pay() const {
    return samples_->ambient_dim() >= kManyCoordinates &&
           !neighborhoods_->squared_distances.empty();
  }

  /// Null where b is no neighbor of a.
  const double* find(Index a, Index b) const {
    const Index* first = neighborhoods_->of(a);
    const Index* last = first + neighborhoods_->count;
    const Index* found = std::find(first, last, b);
    return found == last ? nullptr
                         : neighborhoods_->squared_distances.data() +
                               (found - neighborhoods_->indices.data());
  }

  /// The squared distance of a sample to its nearest neighbor.
  double nearest(Index x) const {
    return neighborhoods_->squared_distances.empty()
               ? samples_->squared_distance(x, neighborhoods_->of(x)[0])
               : neighborhoods_->squared_distances[static_cast<std::size_t>(x) *
                                                   neighborhoods_->count];
  }

  double operator()(Index a, Index b) const {
    if (a == b) {
      return 0;
    }
    const double* known = find(a, b);
    known = known == nullptr ? find(b, a) : known;
    return known != nullptr
               ? *known
               : squared_distance(samples_->point(a), samples_->point(b),
                                  static_cast<std::size_t>(samples_->ambient_dim()));
  }

 private:
  const Samples* samples_;
  const Neighborhoods* neighborhoods_;
};

}  // namespace remanifold::detail
