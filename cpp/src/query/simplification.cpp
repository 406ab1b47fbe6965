// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/simplification.hpp"

#include "base/dispatch.hpp"
#include "base/parallel.hpp"
#include "base/sort_unique.hpp"
#include "query/nearest_in_simplex.hpp"
#include "remanifold/facets.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace remanifold {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Cosine of the angle that a simplex may turn by at once: 60 degrees.
constexpr double kMostTurn = 0.5;
/// Volume over that of a regular simplex with the same mean square of the edges: no simplex
/// may become worse than this, or than the worst around. For a triangle with two sides of
/// the same length an angle of 10 degrees.
constexpr double kLeastShape = 0.3;
/// What a collapse costs for each unit of its edge, besides the error: where nothing is
/// lost, short edges go first. An edge of length l on a sphere of radius r loses about
/// l^2 / 8r: it counts where edges are shorter than some hundredth of the radius.
constexpr double kCostOfLength = 1e-3;
/// Collapses that had been impossible are tried again as long as this share of the
/// vertices went since: so all rounds together cost a constant times the first.
constexpr double kWorthAnotherRound = 0.1;
constexpr int kPollEvery = 256;
/// Vertices that two links may have in common, bits of one word.
constexpr std::size_t kMostCommon = 64;

double squared_distance(const double* a, const double* b, Offset size) {
  double sum = 0;
  for (Offset i = 0; i < size; ++i) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return sum;
}

template <class Matrix>
double determinant(const Matrix& m) {
  switch (m.rows()) {
    case 1:
      return m(0, 0);
    case 2:
      return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
    case 3:
      return m(0, 0) * (m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1)) -
             m(0, 1) * (m(1, 0) * m(2, 2) - m(1, 2) * m(2, 0)) +
             m(0, 2) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0));
    default:
      return m.determinant();
  }
}

/// \tparam K  dimension of the simplices, or Eigen::Dynamic
template <int K>
class Simplifier {
 public:
  Simplifier(MatrixView vertices, const SimplexArray& simplices,
             const std::vector<std::uint8_t>& fixed,
             const SimplificationOptions& options)
      : points_(vertices),
        options_(options),
        dim_(simplices.arity - 1),
        apex_(static_cast<Index>(vertices.rows)),
        fixed_(fixed),
        complex_(simplices),
        stars_(vertices.rows),
        guests_(simplices.size()),
        state_(vertices.rows),
        away_{std::vector<double>(vertices.rows, 0.0),
              std::vector<double>(vertices.rows, 0.0)},
        nearest_(dim_, static_cast<int>(vertices.cols)),
        nearest_on_rim_(dim_ - 1, static_cast<int>(vertices.cols)),
        corners_(dim_ + 1) {
    cone_over_boundary();
    alive_.assign(complex_.size(), 1);
    guests_.resize(complex_.size());
    for (Offset s = 0; s < complex_.size(); ++s) {
      for (int i = 0; i <= dim_; ++i) {
        if (complex_[s][i] != apex_) {
          stars_[complex_[s][i]].push_back(s);
        }
      }
    }
    for (const std::vector<Offset>& star : stars_) {
      left_ += star.empty() ? 0 : 1;
    }
  }

  Simplification run(const Execution& execution) {
    const Index first = left_;
    detail::begin_step(execution, Step::kSimplification,
                       std::max<Offset>(first - options_.num_vertices, 0));
    Index before = left_;
    for (Index v = 0; v < apex_; ++v) {
      offer(v, 0);
    }
    for (int pops = 0; left_ > options_.num_vertices; ++pops) {
      if (pops % kPollEvery == 0) {
        execution.poll();
        if (execution.progress != nullptr) {
          execution.progress->done = first - left_;
        }
      }
      if (queue_.empty()) {
        if (before - left_ < kWorthAnotherRound * before) {
          break;
        }
        before = left_;
        for (Index v = 0; v < apex_; ++v) {
          offer(v, 0);
        }
        continue;
      }
      const Entry top = queue_.top();
      queue_.pop();
      if (top.stamp == state_[top.vertex].stamp) {
        visit(top);
      }
    }
    return finish();
  }

 private:
  struct Entry {
    double cost;
    Index vertex;
    std::int32_t stamp;
    bool operator<(const Entry& other) const {
      return cost != other.cost ? cost > other.cost : vertex > other.vertex;
    }
  };
  struct State {
    std::int32_t stamp = 0;
    Index target = -1;
    bool valued = false;  // its cost is that of its star as it is
    bool exact = false;   // and counts the vertices taken out before
    bool waiting = false;
  };
  struct Target {
    double cost;
    Index vertex;
    bool operator<(const Target& other) const {
      return cost != other.cost ? cost < other.cost : vertex < other.vertex;
    }
  };

  /// One more vertex, joined to all open facets: its simplices come last in the arrays,
  /// the apex last in each.
  void cone_over_boundary() {
    SimplexArray sorted = complex_;
    for (Offset s = 0; s < sorted.size(); ++s) {
      Index* const row = sorted.vertices.data() + s * sorted.arity;
      std::sort(row, row + sorted.arity);
    }
    const std::vector<FacetNumber> neighbors = facet_neighbors(sorted, apex_);
    num_solid_ = complex_.size();
    for (FacetNumber f = 0; f < static_cast<FacetNumber>(neighbors.size()); ++f) {
      if (neighbors[f] == kOpen) {
        const std::size_t end = complex_.vertices.size();
        complex_.vertices.resize(end + complex_.arity);
        copy_facet(sorted, f, complex_.vertices.data() + end);
        complex_.vertices.back() = apex_;
      }
    }
  }

  bool allowed(double error) const {
    return error < kInfinity && error <= options_.max_error;
  }
  bool on_rim(Offset s) const { return s >= num_solid_; }
  bool has(Offset s, Index v) const {
    const Index* row = complex_[s];
    return std::find(row, row + complex_.arity, v) != row + complex_.arity;
  }
  const double* point(Index v) const { return points_.row(v); }

  void offer(Index v, double cost) {
    State& state = state_[v];
    if (stars_[v].empty() || fixed_[v] != kMovable || state.waiting) {
      return;
    }
    state.valued = state.exact = false;
    state.waiting = true;
    queue_.push({cost, v, ++state.stamp});
  }

  /// Values it, values it exactly, or collapses: each when nothing else seems cheaper.
  void visit(const Entry& top) {
    State& state = state_[top.vertex];
    if (!state.valued) {
      const Target best = best_target(top.vertex);
      state.valued = true;
      state.target = best.vertex;
      push_or_drop(top.vertex, best.cost);
      return;
    }
    if (!links_meet_in_edge(top.vertex, state.target)) {  // its other end changed
      state.waiting = false;
      offer(top.vertex, top.cost);
      return;
    }
    const double error = rehome(top.vertex, state.target, false);
    if (!state.exact) {
      state.exact = true;
      const double cost = cost_of(error, top.vertex, state.target);
      if (cost > top.cost || !allowed(error)) {
        push_or_drop(top.vertex, allowed(error) ? cost : kInfinity);
        return;
      }
    }
    collapse(top.vertex, state.target, top.cost);
  }

  void push_or_drop(Index v, double cost) {
    State& state = state_[v];
    state.waiting = cost < kInfinity;
    ++state.stamp;
    if (state.waiting) {
      queue_.push({cost, v, state.stamp});
    }
  }

  double cost_of(double error, Index u, Index v) const {
    const double length = std::sqrt(squared_distance(point(u), point(v), points_.cols));
    return options_.even ? longest_edge(u, v) : error + kCostOfLength * length;
  }

  /// Of the edges that appear where u moves to v, and the one that goes.
  double longest_edge(Index u, Index v) const {
    double longest = squared_distance(point(u), point(v), points_.cols);
    for (const Offset s : stars_[u]) {
      for (int i = 0; i <= dim_ && !has(s, v); ++i) {
        const Index w = complex_[s][i];
        if (w != u && w != apex_) {
          longest =
              std::max(longest, squared_distance(point(v), point(w), points_.cols));
        }
      }
    }
    return std::sqrt(longest);
  }

  /// Vertices that share a simplex, the apex included, sorted.
  void neighbors_of(Index u, std::vector<Index>& out) const {
    out.clear();
    for (const Offset s : stars_[u]) {
      for (int i = 0; i <= dim_; ++i) {
        if (complex_[s][i] != u) {
          out.push_back(complex_[s][i]);
        }
      }
    }
    detail::sort_unique(out);
  }

  Target best_target(Index u) {
    neighbors_of(u, around_);
    const bool rim = !around_.empty() && around_.back() == apex_;
    std::vector<Target>& targets = targets_;
    targets.clear();
    double worst = 1;
    for (const Offset s : stars_[u]) {
      if (!on_rim(s)) {
        worst = std::min(worst, shape(s, u, u).first);
      }
    }
    const double least_shape = std::min(worst, kLeastShape);
    for (const Index v : around_) {
      if (v == apex_ || fixed_[v] == kUntouched || (rim && !share_rim(u, v))) {
        continue;
      }
      const double error = error_of(u, v, least_shape);
      if (allowed(error)) {
        targets.push_back({cost_of(error, u, v), v});
      }
    }
    std::sort(targets.begin(), targets.end());
    for (const Target& target : targets) {
      if (links_meet_in_edge(u, target.vertex)) {
        return target;
      }
    }
    return {kInfinity, -1};
  }

  bool share_rim(Index u, Index v) const {
    return std::any_of(stars_[u].begin(), stars_[u].end(),
                       [&](Offset s) { return on_rim(s) && has(s, v); });
  }

  /// Its vertices with u moved to v; the apex stays out.
  void corners_of(Offset s, Index u, Index v) {
    for (int i = 0; i <= dim_; ++i) {
      const Index w = complex_[s][i];
      corners_[i] = w == apex_ ? nullptr : point(w == u ? v : w);
    }
  }

  /// Shape of a simplex with u moved to v, and the cosine of the angle it turns by; for one
  /// on the rim of its facet of the boundary.
  std::pair<double, double> shape(Offset s, Index u, Index v) {
    const int size = on_rim(s) ? dim_ - 1 : dim_;
    if (size == 0) {
      return {1, 1};
    }
    // Edges from a vertex that stays.
    Index base = -1;
    others_.clear();
    for (int i = 0; i <= size; ++i) {
      const Index w = complex_[s][i];
      if (w != u && base < 0) {
        base = w;
      } else {
        others_.push_back(w);
      }
    }
    using Matrix = Eigen::Matrix < double, Eigen::Dynamic, Eigen::Dynamic, 0,
          K < 0 ? Eigen::Dynamic : K, K<0 ? Eigen::Dynamic : K>;
    Matrix old(size, size), mixed(size, size), fresh(size, size);
    const double* const origin = point(base);
    const Offset cols = points_.cols;
    for (int i = 0; i < size; ++i) {
      const double* const a = point(others_[i]);
      const double* const c = others_[i] == u ? point(v) : a;
      for (int j = 0; j < size; ++j) {
        const double* const b = point(others_[j]);
        const double* const d = others_[j] == u ? point(v) : b;
        double ab = 0, ad = 0, cd = 0;
        for (Offset x = 0; x < cols; ++x) {
          const double left = a[x] - origin[x];
          const double right = d[x] - origin[x];
          ab += left * (b[x] - origin[x]);
          ad += left * right;
          cd += (c[x] - origin[x]) * right;
        }
        old(i, j) = ab;
        mixed(i, j) = ad;
        fresh(i, j) = cd;
      }
    }
    // Twice the sum of all squared edges, over their number.
    const double mean = ((size + 1) * fresh.trace() - fresh.sum()) * 2 /
                        (static_cast<double>(size) * (size + 1));
    const double volume = std::max(determinant(fresh), 0.0);
    const double regular = (size + 1) / std::pow(2.0, size);
    const double quality =
        mean > 0 ? std::sqrt(volume / (regular * std::pow(mean, size))) : 0;
    const double both = std::sqrt(volume * std::max(determinant(old), 0.0));
    return {quality, both > 0 ? determinant(mixed) / both : 1};
  }

  /// How far u is from what takes the place of its star; infinite where a simplex would
  /// turn or become flat.
  double error_of(Index u, Index v, double least_shape) {
    double solid = kInfinity;
    double rim = kInfinity;
    bool any_rim = false;
    for (const Offset s : stars_[u]) {
      any_rim = any_rim || on_rim(s);
      if (has(s, v)) {
        continue;
      }
      const auto [quality, cosine] = shape(s, u, v);
      if (cosine < kMostTurn || (!on_rim(s) && quality < least_shape)) {
        return kInfinity;
      }
      double& least = on_rim(s) ? rim : solid;
      least = std::min(least, squared_distance_to(u, s, u, v));
    }
    return std::sqrt(any_rim ? std::max(solid, rim) : solid);
  }

  double squared_distance_to(Index query, Offset s, Index u, Index v) {
    corners_of(s, u, v);
    return on_rim(s) ? nearest_on_rim_.solve(point(query), corners_.data())
                     : nearest_.solve(point(query), corners_.data());
  }

  /// What lies in both links is the link of the edge.
  bool links_meet_in_edge(Index u, Index v) {
    neighbors_of(u, around_u_);
    neighbors_of(v, around_v_);
    common_.clear();
    std::set_intersection(around_u_.begin(), around_u_.end(), around_v_.begin(),
                          around_v_.end(), std::back_inserter(common_));
    if (common_.size() > kMostCommon) {
      return false;
    }
    edge_link_.clear();
    const auto link_of = [&](Index own, Index other, std::vector<std::uint64_t>& link) {
      link.clear();
      for (const Offset s : stars_[own]) {
        std::uint64_t face = 0;
        bool both = false;
        for (int i = 0; i <= dim_; ++i) {
          const Index w = complex_[s][i];
          both = both || w == other;
          const auto place = std::lower_bound(common_.begin(), common_.end(), w);
          if (place != common_.end() && *place == w) {
            face |= std::uint64_t{1} << (place - common_.begin());
          }
        }
        if (!both) {
          link.push_back(face);
        } else if (own == u) {
          edge_link_.push_back(face);
        }
      }
    };
    link_of(u, v, link_u_);
    link_of(v, u, link_v_);
    if (edge_link_.empty()) {
      return false;
    }
    for (const std::uint64_t a : link_u_) {
      for (const std::uint64_t b : link_v_) {
        const std::uint64_t shared = a & b;
        if (shared != 0 &&
            std::none_of(edge_link_.begin(), edge_link_.end(),
                         [&](std::uint64_t face) { return (shared & ~face) == 0; })) {
          return false;
        }
      }
    }
    return true;
  }

  /// The vertices that were taken out around u, and u itself, on what takes the place of
  /// its star: the largest distance, and with `keep` each is put there.
  double rehome(Index u, Index v, bool keep) {
    double largest = 0;
    for (const bool rim : {false, true}) {
      moved_.clear();
      fresh_.clear();
      bool any = false;
      for (const Offset s : stars_[u]) {
        if (on_rim(s) != rim) {
          continue;
        }
        any = true;
        moved_.insert(moved_.end(), guests_[s].begin(), guests_[s].end());
        if (!has(s, v)) {
          fresh_.push_back(s);
        }
        if (keep) {
          guests_[s].clear();
        }
      }
      if (!any) {
        continue;
      }
      moved_.push_back(u);
      for (const Index guest : moved_) {
        double least = kInfinity;
        Offset home = -1;
        for (const Offset s : fresh_) {
          const double away = squared_distance_to(guest, s, u, v);
          if (away < least) {
            least = away;
            home = s;
          }
        }
        // Nothing is left of the rim where an edge collapses that all of it shares.
        const double away = home < 0 ? kInfinity : std::sqrt(least);
        largest = std::max(largest, away);
        if (keep) {
          guests_[home].push_back(guest);
          away_[rim ? 1 : 0][guest] = away;
        }
      }
    }
    return largest;
  }

  void collapse(Index u, Index v, double cost) {
    rehome(u, v, true);
    std::vector<Offset> star = std::move(stars_[u]);
    stars_[u].clear();
    for (const Offset s : star) {
      if (!has(s, v)) {
        Index* const row = complex_.vertices.data() + s * complex_.arity;
        std::replace(row, row + complex_.arity, u, v);
        stars_[v].push_back(s);
        continue;
      }
      alive_[s] = 0;
      for (int i = 0; i <= dim_; ++i) {
        const Index w = complex_[s][i];
        if (w != u && w != apex_) {
          std::vector<Offset>& own = stars_[w];
          own.erase(std::find(own.begin(), own.end(), s));
        }
      }
    }
    --left_;
    ++state_[u].stamp;
    // What is around counts anew, when it would have been its turn.
    neighbors_of(v, around_);
    around_.push_back(v);
    for (const Index w : around_) {
      if (w == apex_) {
        continue;
      }
      State& state = state_[w];
      state.valued = state.exact = false;
      offer(w, cost);
    }
  }

  Simplification finish() {
    Simplification result;
    result.simplices.arity = complex_.arity;
    for (Offset s = 0; s < num_solid_; ++s) {
      if (alive_[s] != 0) {
        result.simplices.vertices.insert(result.simplices.vertices.end(), complex_[s],
                                         complex_[s] + complex_.arity);
      }
    }
    result.errors = std::move(away_[0]);
    return result;
  }

  MatrixView points_;
  SimplificationOptions options_;
  int dim_;
  Index apex_;
  const std::vector<std::uint8_t>& fixed_;
  SimplexArray complex_;
  Offset num_solid_ = 0;
  std::vector<std::uint8_t> alive_;
  std::vector<std::vector<Offset>> stars_;
  std::vector<std::vector<Index>> guests_;  // vertices taken out, nearest to this one
  std::vector<State> state_;
  std::vector<double> away_[2];  // from the complex, and from its boundary
  std::priority_queue<Entry> queue_;
  Index left_ = 0;
  detail::NearestInSimplex<K> nearest_;
  detail::NearestInSimplex<(K > 0 ? K - 1 : K)> nearest_on_rim_;
  std::vector<const double*> corners_;
  // Used again for each collapse.
  std::vector<Index> around_, around_u_, around_v_, common_, others_, moved_;
  std::vector<Offset> fresh_;
  std::vector<Target> targets_;
  std::vector<std::uint64_t> link_u_, link_v_, edge_link_;
};

}  // namespace

Simplification simplify(MatrixView vertices, const SimplexArray& simplices,
                        const std::vector<std::uint8_t>& fixed,
                        const SimplificationOptions& options,
                        const Execution& execution) {
  return detail::dispatch_dim(simplices.arity - 1, [&](auto dim) {
    return Simplifier<decltype(dim)::value>(vertices, simplices, fixed, options)
        .run(execution);
  });
}

}  // namespace remanifold
