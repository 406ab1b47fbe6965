// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/curve_repair.hpp"

#include "complex/simplex_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace remanifold {
namespace {

/// A few samples are a curve of their own where others are farther than this times the
/// longest edge among them: two gaps of three spacings each, there and back, are a chance
/// of e^-6.
constexpr double kOnItsOwn = 3;
/// So many pairs of ends for each sample are compared beyond the neighborhoods.
constexpr Offset kPairsPerSample = 10;

class CurveRepair {
 public:
  CurveRepair(const Samples& samples, const Neighborhoods& neighborhoods,
              const std::vector<double>& scales, const FacetPrice& price,
              const SimplexArray& edges)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        ruler_(samples, scales),
        price_(price),
        next_(samples.size(), {-1, -1}) {
    for (Offset e = 0; e < edges.size(); ++e) {
      link(edges[e][0], edges[e][1]);
      mean_step_ +=
          length_of(edges[e][0], edges[e][1]) / static_cast<double>(edges.size());
    }
  }

  /// A few samples that a curve leaves its way for, there and back, are a curve of their
  /// own: the gaps are long for what lies on either side of them, and the curve goes on
  /// where it left.
  void part_detours(Index smallest_loop) {
    for (Index b = 0; b < samples_.size(); ++b) {
      for (const Index a : next_[b]) {
        if (a >= 0 && is_long(a, b)) {
          part_detour(b, a, smallest_loop);
        }
      }
    }
  }

  void join_ends(Index smallest_loop) {
    std::vector<Join> joins;
    for (Index a = 0; a < samples_.size(); ++a) {
      for (Index k = 0; degree(a) < 2 && k < neighborhoods_.count; ++k) {
        consider(a, neighborhoods_.of(a)[k], joins);
      }
    }
    join(joins, smallest_loop);
  }

  /// Another, denser part may be nearer to an end than the other end is: where nothing near
  /// continues them the few ends that are left are all compared.
  void join_far_ends(Index smallest_loop) {
    std::vector<Index> ends;
    for (Index a = 0; a < samples_.size(); ++a) {
      if (degree(a) == 1) {
        ends.push_back(a);
      }
    }
    const auto count = static_cast<Offset>(ends.size());
    if (count * count > kPairsPerSample * samples_.size()) {
      return;
    }
    std::vector<Join> joins;
    for (Offset i = 0; i < count; ++i) {
      for (Offset j = i + 1; j < count; ++j) {
        consider(ends[i], ends[j], joins);
      }
    }
    join(joins, smallest_loop);
  }

  /// Puts paths whose ends find no others between two neighbors on another curve.
  void insert_paths(Index smallest_loop, const Execution& execution) {
    for (Index a = 0; a < samples_.size(); ++a) {
      if (degree(a) != 1) {
        continue;
      }
      execution.poll();
      const Index b = other_end(a);
      Index at = -1;
      Index behind = -1;
      double least = price_(&a) + price_(&b);
      for (Index k = 0; k < neighborhoods_.count; ++k) {
        const Index c = neighborhoods_.of(a)[k];
        for (const Index d : next_[c]) {
          if (d < 0 || path_length(a, c) > 0) {
            continue;
          }
          const double more = energy_of(a, c) + energy_of(b, d) - energy_of(c, d);
          if (more < least && !stays_away(a, c, smallest_loop)) {
            least = more;
            at = c;
            behind = d;
          }
        }
      }
      if (at >= 0) {
        unlink(at, behind);
        link(a, at);
        link(b, behind);
      }
    }
  }

  void merge_loops(Index smallest_loop, const Execution& execution) {
    std::vector<std::uint8_t> seen(samples_.size(), 0);
    for (Index seed = 0; seed < samples_.size(); ++seed) {
      if (seen[seed] != 0) {
        continue;
      }
      execution.poll();
      std::vector<Index> loop = component(seed, smallest_loop);
      for (const Index v : loop) {
        seen[v] = 1;
      }
      if (static_cast<Index>(loop.size()) < smallest_loop && is_loop(loop)) {
        merge(loop);
      }
    }
  }

  SimplexArray finish() const {
    SimplexArray edges{2, {}};
    for (Index v = 0; v < samples_.size(); ++v) {
      for (const Index w : next_[v]) {
        if (w > v) {
          edges.vertices.push_back(v);
          edges.vertices.push_back(w);
        }
      }
    }
    return detail::sorted_unique(edges);
  }

 private:
  struct Join {
    double energy;
    Index a, b;
    bool operator<(const Join& other) const {
      return std::tie(energy, a, b) < std::tie(other.energy, other.a, other.b);
    }
  };

  bool is_long(Index a, Index b) const {
    return length_of(a, b) >
           kOnItsOwn * std::max(length_of(a, neighborhoods_.of(a)[0]),
                                length_of(b, neighborhoods_.of(b)[0]));
  }

  void part_detour(Index b, Index a, Index few) {
    std::vector<Index> part;
    Index before = b;
    Index c = a;
    while (static_cast<Index>(part.size()) + 1 < few) {
      part.push_back(c);
      const Index d = after(c, before);
      if (d < 0 || d == b) {
        return;
      }
      if (part.size() > 2 && is_long(c, d)) {
        const double way = std::min(length_of(b, a), length_of(c, d));
        const double step = std::max({longest_of_tree(part), length_to(b, after(b, a)),
                                      length_to(d, after(d, c)), mean_step_});
        if (way > kOnItsOwn * step && way > length_of(b, d)) {
          unlink(b, a);
          unlink(c, d);
          link(b, d);
          go_round(part);
          return;
        }
      }
      before = c;
      c = d;
    }
  }

  /// The neighbor of v on its curve that is not the one before; -1 where it ends.
  Index after(Index v, Index before) const {
    return next_[v][0] != before ? next_[v][0] : next_[v][1];
  }

  double length_to(Index a, Index b) const { return b < 0 ? 0 : length_of(a, b); }

  /// Of the shortest tree.
  double longest_of_tree(const std::vector<Index>& part) const {
    std::vector<double> away(part.size(), std::numeric_limits<double>::infinity());
    std::vector<std::uint8_t> reached(part.size(), 0);
    double longest = 0;
    away[0] = 0;
    for (std::size_t round = 0; round < part.size(); ++round) {
      std::size_t nearest = part.size();
      for (std::size_t i = 0; i < part.size(); ++i) {
        if (reached[i] == 0 && (nearest == part.size() || away[i] < away[nearest])) {
          nearest = i;
        }
      }
      reached[nearest] = 1;
      longest = std::max(longest, away[nearest]);
      for (std::size_t i = 0; i < part.size(); ++i) {
        away[i] = std::min(away[i], length_of(part[nearest], part[i]));
      }
    }
    return longest;
  }

  /// Makes them a closed curve of the least energy; without its longest edge where that
  /// costs more than two ends.
  void go_round(std::vector<Index> part) {
    for (std::size_t i = 1; i < part.size(); ++i) {
      unlink(part[i - 1], part[i]);
    }
    std::sort(part.begin(), part.end());
    std::vector<Index> best;
    double least = std::numeric_limits<double>::infinity();
    do {
      double energy = 0;
      for (std::size_t i = 0; i < part.size() && energy < least; ++i) {
        energy += energy_of(part[i], part[(i + 1) % part.size()]);
      }
      if (energy < least) {
        least = energy;
        best = part;
      }
    } while (std::next_permutation(part.begin() + 1, part.end()));
    std::size_t last = best.size() - 1;
    for (std::size_t i = 0; i < best.size(); ++i) {
      if (energy_of(best[i], best[(i + 1) % best.size()]) >
          energy_of(best[last], best[(last + 1) % best.size()])) {
        last = i;
      }
    }
    for (std::size_t i = 0; i < best.size(); ++i) {
      const Index v = best[i];
      const Index w = best[(i + 1) % best.size()];
      if (i != last || energy_of(v, w) < price_(&v) + price_(&w)) {
        link(v, w);
      }
    }
  }

  /// Of two ends that have each other among their neighbors, once.
  void consider(Index a, Index b, std::vector<Join>& joins) const {
    if (degree(b) == 2 || next_[a][0] == b) {
      return;
    }
    const double energy = energy_of(a, b);
    if (energy < price_(&a) + price_(&b)) {
      joins.push_back({energy, std::min(a, b), std::max(a, b)});
    }
  }

  void join(std::vector<Join>& joins, Index smallest_loop) {
    std::sort(joins.begin(), joins.end());
    // Short paths are closed only if nothing else is left to them.
    for (const bool close_short : {false, true}) {
      for (const Join& next : joins) {
        if (degree(next.a) == 2 || degree(next.b) == 2 || next_[next.a][0] == next.b) {
          continue;
        }
        const Index length = path_length(next.a, next.b);
        if (length == 0 && (stays_away(next.a, next.b, smallest_loop) ||
                            stays_away(next.b, next.a, smallest_loop))) {
          continue;
        }
        if (length == 0 || length >= smallest_loop || (close_short && length > 2)) {
          link(next.a, next.b);
        }
      }
    }
  }

  int degree(Index v) const { return (next_[v][0] >= 0) + (next_[v][1] >= 0); }

  void link(Index a, Index b) {
    next_[a][next_[a][0] < 0 ? 0 : 1] = b;
    next_[b][next_[b][0] < 0 ? 0 : 1] = a;
  }

  void unlink(Index a, Index b) {
    for (const auto& [v, w] : {std::pair(a, b), std::pair(b, a)}) {
      if (next_[v][0] == w) {
        next_[v][0] = next_[v][1];
      }
      next_[v][1] = -1;
    }
  }

  double energy_of(Index a, Index b) const {
    const std::array<Index, 2> edge{std::min(a, b), std::max(a, b)};
    return ruler_.energy(edge.data(), 2);
  }

  /// Of the path that begins at a.
  Index other_end(Index a) const {
    Index before = -1;
    Index v = a;
    for (;;) {
      const Index next = after(v, before);
      if (next < 0) {
        return v;
      }
      before = v;
      v = next;
    }
  }

  /// Samples on the path from a to b; 0 where they are on different ones.
  Index path_length(Index a, Index b) const {
    Index length = 1;
    Index before = -1;
    for (Index v = a; v != b; ++length) {
      const Index next = after(v, before);
      if (next < 0) {
        return 0;
      }
      before = v;
      v = next;
    }
    return length;
  }

  /// Up to `most` samples of the curve through one.
  std::vector<Index> component(Index seed, Index most) const {
    std::vector<Index> found{seed};
    for (std::size_t i = 0; i < found.size() && static_cast<Index>(found.size()) < most;
         ++i) {
      for (const Index w : next_[found[i]]) {
        if (w >= 0 && std::find(found.begin(), found.end(), w) == found.end()) {
          found.push_back(w);
        }
      }
    }
    return found;
  }

  double length_of(Index a, Index b) const {
    return std::sqrt(samples_.squared_distance(a, b));
  }

  /// Whether a, on a curve of at least three and fewer than `few` samples, is farther from
  /// b than its curve allows.
  bool stays_away(Index a, Index b, Index few) const {
    const std::vector<Index> curve = component(a, few);
    return curve.size() > 2 && static_cast<Index>(curve.size()) < few &&
           length_of(a, b) > kOnItsOwn * longest_edge(curve);
  }

  double longest_edge(const std::vector<Index>& curve) const {
    double longest = 0;
    for (const Index v : curve) {
      for (const Index w : next_[v]) {
        longest = w >= 0 ? std::max(longest, length_of(v, w)) : longest;
      }
    }
    return longest;
  }

  bool is_loop(const std::vector<Index>& curve) const {
    return std::all_of(curve.begin(), curve.end(),
                       [&](Index v) { return degree(v) == 2; });
  }

  void merge(const std::vector<Index>& loop) {
    std::array<Index, 4> best{};  // a - b, c - d become a - c, b - d
    double least = std::numeric_limits<double>::infinity();
    const double farthest = kOnItsOwn * longest_edge(loop);
    for (const Index a : loop) {
      for (Index k = 0; k < neighborhoods_.count; ++k) {
        const Index c = neighborhoods_.of(a)[k];
        if (std::find(loop.begin(), loop.end(), c) != loop.end() ||
            length_of(a, c) > farthest) {
          continue;
        }
        for (const Index b : next_[a]) {
          for (const Index d : next_[c]) {
            if (d < 0) {
              continue;
            }
            const double more =
                energy_of(a, c) + energy_of(b, d) - energy_of(a, b) - energy_of(c, d);
            if (more < least && more < 2 * (price_(&a) + price_(&c))) {
              least = more;
              best = {a, b, c, d};
            }
          }
        }
      }
    }
    if (least < std::numeric_limits<double>::infinity()) {
      const auto [a, b, c, d] = best;
      unlink(a, b);
      unlink(c, d);
      link(a, c);
      link(b, d);
    }
  }

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  SimplexRuler ruler_;
  const FacetPrice& price_;
  std::vector<std::array<Index, 2>> next_;
  double mean_step_ = 0;
};

}  // namespace

void repair_curves(const Samples& samples, const Neighborhoods& neighborhoods,
                   const std::vector<double>& scales, const FacetPrice& price,
                   Index smallest_loop, SimplexArray& edges,
                   const Execution& execution) {
  CurveRepair repair(samples, neighborhoods, scales, price, edges);
  repair.part_detours(smallest_loop);
  repair.join_ends(smallest_loop);
  repair.insert_paths(smallest_loop, execution);
  repair.join_far_ends(smallest_loop);
  repair.merge_loops(smallest_loop, execution);
  repair.part_detours(smallest_loop);
  edges = repair.finish();
}

}  // namespace remanifold
