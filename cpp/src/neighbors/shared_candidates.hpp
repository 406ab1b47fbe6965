// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbors of a few samples that lie close together, out of one ball that holds those of
// all of them: samples next to each other on the Morton curve have most neighbors in
// common, and one search of the tree serves them all. A member's neighbors are certain
// where they end before the ball does.
#pragma once

#include "base/rank_few.hpp"
#include "neighbors/near_candidates.hpp"
#include "neighbors/neighbor_search.hpp"
#include "remanifold/samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace remanifold::detail {

class SharedCandidates {
 public:
  explicit SharedCandidates(const Samples& samples)
      : samples_(samples),
        low_(samples.ambient_dim()),
        high_(samples.ambient_dim()),
        center_(samples.ambient_dim()) {}

  /// The samples [begin, end), of the same stretch of the data, will be asked for.
  void begin(Index begin, Index end) {
    begin_ = begin;
    found_.resize(std::max(found_.size(), static_cast<std::size_t>(end - begin)));
    for (std::vector<Neighbor>& list : found_) {
      list.clear();
    }
    reach_ = 0;
    crowded_ = false;
  }

  /// What serve() has found for a sample, if it has.
  bool take(Index x, std::vector<Neighbor>& out) {
    std::vector<Neighbor>& list = found_[x - begin_];
    if (list.empty()) {
      return false;
    }
    out.swap(list);
    list.clear();
    return true;
  }

  /// Tells how far the neighbors of a sample reach.
  void observe(double squared_reach) {
    const double reach = std::sqrt(squared_reach);
    reach_ = reach_ > 0 ? reach_ + kAdapt * (reach - reach_) : reach;
  }

  /// Makes members of x and those from there to `end` that lie close together, as far as
  /// nothing was found for them. Where the order of the data jumps, some lie between.
  /// \returns false where that is x alone, or nothing is known of their neighbors
  bool gather(Index x, Index end, Index count) {
    members_.clear();
    if (!(reach_ > 0) || crowded_) {
      return false;
    }
    most_ = kMostPerNeighbor * static_cast<std::size_t>(count);
    const auto dim = low_.size();
    const double most = max_spread() * reach_;
    for (Index y = x; y < end && members_.size() < kMaxMembers; ++y) {
      if (!found_[y - begin_].empty()) {
        continue;
      }
      const double* p = samples_.point(y);
      double squared_spread = 0;
      for (std::size_t j = 0; j < dim; ++j) {
        const double low = y == x ? p[j] : std::min(low_[j], p[j]);
        const double high = y == x ? p[j] : std::max(high_[j], p[j]);
        squared_spread += (high - low) * (high - low);
      }
      if (squared_spread > 4 * most * most) {
        continue;
      }
      for (std::size_t j = 0; j < dim; ++j) {
        low_[j] = y == x ? p[j] : std::min(low_[j], p[j]);
        high_[j] = y == x ? p[j] : std::max(high_[j], p[j]);
      }
      members_.push_back(y);
    }
    if (members_.size() < 2) {
      return false;
    }
    double squared_spread = 0;
    for (std::size_t j = 0; j < dim; ++j) {
      center_[j] = (low_[j] + high_[j]) / 2;
      squared_spread += (high_[j] - center_[j]) * (high_[j] - center_[j]);
    }
    radius_ = std::sqrt(squared_spread) + margin() * reach_;
    candidates_.clear();
    return true;
  }

  /// The ball to be searched, after gather().
  const double* center() const { return center_.data(); }
  double squared_radius() const { return radius_ * radius_; }
  /// \returns false where the ball holds too many to be of use: where it reaches from few
  /// samples into many, or has too many dimensions. Nothing is shared then until begin().
  bool add(Index sample) {
    if (candidates_.size() == most_) {
      crowded_ = true;
      members_.clear();
      return false;
    }
    candidates_.push_back(sample);
    return true;
  }

  /// When all samples of the ball are there.
  void load() {
    const std::size_t n = candidates_.size();
    stride_ = (static_cast<Index>(n) + kPickSlack - 1) / kPickSlack * kPickSlack;
    const std::size_t dim = center_.size();
    coordinates_.resize(dim * static_cast<std::size_t>(stride_));
    squared_distances_.resize(static_cast<std::size_t>(stride_));
    for (std::size_t i = 0; i < n; ++i) {
      const double* p = samples_.point(candidates_[i]);
      for (std::size_t j = 0; j < dim; ++j) {
        coordinates_[j * static_cast<std::size_t>(stride_) + i] = p[j];
      }
    }
  }

  /// Finds the `count` nearest others of all members that the ball is large enough for.
  void serve(Index count) {
    for (const Index x : members_) {
      std::vector<Neighbor>& list = found_[x - begin_];
      if (nearest(x, count, list)) {
        observe(list.back().squared_distance);
      } else {
        list.clear();
      }
    }
  }

 private:
  /// The `count` nearest others of a member, in order.
  /// \returns false where the ball is too small to be sure of them
  bool nearest(Index x, Index count, std::vector<Neighbor>& out) {
    out.clear();
    const double* p = samples_.point(x);
    double squared_offset = 0;
    for (std::size_t j = 0; j < center_.size(); ++j) {
      squared_offset += (p[j] - center_[j]) * (p[j] - center_[j]);
    }
    const double certain = radius_ * (1 - 1e-9) - std::sqrt(squared_offset);
    if (!(certain > 0)) {
      return false;
    }
    measure(p);
    const double likely = kLikely * reach_;
    if (likely < certain && select(x, count, likely * likely, out)) {
      return true;
    }
    return select(x, count, certain * certain, out);
  }

  static constexpr std::size_t kMaxMembers = 12;
  /// Of the members, in units of the reach: in more coordinates a ball that is as much
  /// wider than those of its members holds more that is of no use to them.
  double max_spread() const { return in_space() ? 1.2 : 0.6; }
  /// Of the ball beyond the members, likewise.
  double margin() const { return in_space() ? 1.25 : 1.15; }
  bool in_space() const { return center_.size() <= 3; }
  static constexpr double kLikely = 1.2;  // reach of most members, likewise
  static constexpr double kAdapt = 0.125;
  static constexpr std::size_t kMostPerNeighbor = 20;
  static constexpr std::size_t kTogether = kRankedTogether;

  /// As detail::squared_distance() sums in few coordinates.
  void measure(const double* p) {
    squared_distances(p, coordinates_.data(), stride_, static_cast<int>(center_.size()),
                      static_cast<Index>(candidates_.size()),
                      squared_distances_.data());
  }

  /// The `count` nearest of those no farther than the limit, where there are so many.
  bool select(Index x, Index count, double limit, std::vector<Neighbor>& out) {
    const auto n = static_cast<Index>(candidates_.size());
    places_.resize(candidates_.size() + kPickSlack);
    const Index picked = pick_near(squared_distances_.data(), n, limit, places_.data());
    // x is one of them.
    if (picked - 1 < count) {
      return false;
    }
    list_.resize(static_cast<std::size_t>(picked));
    std::size_t found = 0;
    for (Index i = 0; i < picked; ++i) {
      const Index place = places_[i];
      list_[found] = {squared_distances_[place], candidates_[place]};
      found += static_cast<std::size_t>(candidates_[place] != x);
    }
    list_.resize(found);
    if (static_cast<Index>(found) < count) {
      return false;
    }
    sort(out);
    out.resize(count);
    return true;
  }

  /// By rank: so few are sorted fastest without a branch that nobody can predict. Ranks
  /// by rounded distances leave little to the exact order.
  void sort(std::vector<Neighbor>& list) {
    const std::size_t n = list_.size();
    const std::size_t padded = (n + kTogether - 1) / kTogether * kTogether;
    keys_.resize(padded);
    ranks_.resize(padded);
    for (std::size_t i = 0; i < n; ++i) {
      keys_[i] = static_cast<float>(list_[i].squared_distance);
    }
    std::fill(keys_.begin() + static_cast<std::ptrdiff_t>(n), keys_.end(),
              std::numeric_limits<float>::infinity());
    rank_few(keys_.data(), static_cast<Index>(padded), ranks_.data());
    list.assign(n, {0.0, -1});
    bool distinct = true;
    for (std::size_t i = 0; i < n; ++i) {
      Neighbor& place = list[ranks_[i]];
      distinct = distinct && place.index < 0;
      place = list_[i];
    }
    if (!distinct) {
      list = list_;
    }
    for (std::size_t i = 1; i < n; ++i) {
      const Neighbor candidate = list[i];
      std::size_t j = i;
      for (; j > 0 && order_(candidate, list[j - 1]); --j) {
        list[j] = list[j - 1];
      }
      list[j] = candidate;
    }
  }

  const Samples& samples_;
  NeighborOrder order_;
  Index begin_ = 0;
  std::vector<std::vector<Neighbor>> found_;  // from begin_ on
  std::vector<Index> members_;
  double reach_ = 0;  // of neighborhoods, as seen lately
  double radius_ = 0;
  std::size_t most_ = 0;  // candidates
  bool crowded_ = false;
  std::vector<double> low_;
  std::vector<double> high_;
  std::vector<double> center_;
  std::vector<Index> candidates_;
  std::vector<double> coordinates_;  // of the candidates, axis by axis
  Index stride_ = 0;                 // from one axis to the next
  std::vector<double> squared_distances_;
  std::vector<float> keys_;
  std::vector<std::int32_t> ranks_;
  std::vector<Index> places_;   // among the candidates
  std::vector<Neighbor> list_;  // of those near enough
};

}  // namespace remanifold::detail
