// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/link_repair.hpp"

#include "base/disjoint_sets.hpp"
#include "base/sort_unique.hpp"
#include "chain/cavity_search.hpp"
#include "complex/editable_complex.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/topology.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

namespace remanifold {
namespace {

/// Holes with more vertices are not refilled: all simplices on them are candidates.
constexpr std::size_t kMostVertices = 12;
constexpr Index kSearchSteps = 2000;
/// Above, links are large, and to judge one takes as long as the rest of the method.
constexpr int kMostDim = 4;
/// Looks at one vertex, at most.
constexpr int kRounds = 4;
/// Complexes with fewer simplices have the work of so many.
constexpr Offset kLeastSimplices = 1000;
/// What a candidate for a hole counts: each has its facets sorted.
constexpr Offset kWorkPerCandidate = 30;
/// The simplices of a spike have so many times the volume of what closes the hole without
/// it: on average they are steeper than 60 degrees.
constexpr double kSteep = 2;
constexpr Index kPollStride = 1024;

/// Simplices that go and simplices that come, K+1 vertices each.
struct Move {
  std::vector<Offset> out;
  std::vector<Index> in;
  double energy = 0;
};

class LinkRepair {
 public:
  LinkRepair(const Samples& samples, const std::vector<double>& scales,
             SimplexArray simplices, Offset work, const Execution& execution)
      : samples_(samples),
        scales_(scales),
        execution_(execution),
        complex_(std::move(simplices), samples.size()),
        arity_(complex_.arity()),
        ruler_(samples, scales),
        work_left_(work),
        inside_(samples.size(), 0),
        hole_of_(samples.size(), -1),
        tried_at_(samples.size(), -1),
        judged_at_(samples.size(), -1),
        judged_(samples.size(), 0) {}

  /// In the complex as it is between moves, so that each link is judged once.
  bool is_singular(Index v) {
    if (judged_at_[v] != num_applied_) {
      judged_at_[v] = num_applied_;
      judged_[v] = is_singular_now(v) ? 1 : 0;
    }
    return judged_[v] != 0;
  }

  /// \returns the vertices that the best move has touched; none where none helps
  std::vector<Index> mend(Index v) {
    if (tried_at_[v] == num_applied_ || work_left_ < 0) {
      return {};  // nothing is as it was not then
    }
    tried_at_[v] = num_applied_;
    Move best;
    double best_change = 0;
    for (Move& move : moves_at(v)) {
      execution_.poll();
      if (work_left_ < 0) {
        break;
      }
      const double change = change_by(move, best_change);
      if (change < best_change ||
          (change < 0 && change == best_change && move.energy < best.energy)) {
        best_change = change;
        best = std::move(move);
      }
    }
    if (best_change >= 0) {
      return {};
    }
    const std::vector<Index> touched = vertices_of(best);
    apply(best);
    return touched;
  }

  /// Closes small holes at the touched vertices, which moves may have left, where that
  /// costs less than leaving them open.
  /// \returns vertices whose links have changed
  std::vector<Index> close_holes(const std::vector<Index>& touched,
                                 const FacetPrice& price) {
    std::vector<Index> closed;
    for (const Index v : touched) {
      if (work_left_ < 0) {
        break;
      }
      if (hole_of_[v] >= 0 && changed_[hole_of_[v]] == 0) {
        continue;  // tried from another of its vertices
      }
      std::vector<Index> hole;
      const bool small = find_hole(v, hole);
      for (const Index w : hole) {
        hole_of_[w] = static_cast<Index>(changed_.size());
      }
      changed_.push_back(0);
      Move move;
      if (small && fill(hole, {}, price, move) && change_by(move, 0) <= 0) {
        for (const Index w : vertices_of(move)) {
          if (hole_of_[w] >= 0) {
            changed_[hole_of_[w]] = 1;
          }
        }
        const std::vector<Index> around = vertices_of(move);
        closed.insert(closed.end(), around.begin(), around.end());
        apply(move);
      }
    }
    return closed;
  }

  /// Where no move has helped: of several fans at a vertex the largest whose link is one
  /// stays, or nothing does. That may break links next to it, which are looked at as well;
  /// each time simplices go, so that there is an end.
  /// \returns the vertices at which simplices went, ascending
  std::vector<Index> cut(const std::vector<Index>& vertices) {
    std::set<Index> left(vertices.begin(), vertices.end());
    std::vector<Index> result;
    while (!left.empty()) {
      execution_.poll();
      const Index v = *left.begin();
      left.erase(left.begin());
      if (!is_singular(v)) {
        continue;
      }
      std::vector<std::vector<Offset>> fans = fans_at({v});
      std::size_t kept = fans.size();
      for (std::size_t f = 0; f < fans.size(); ++f) {
        if (is_sphere_or_ball(complex_.link(v, fans[f])) &&
            (kept == fans.size() || fans[f].size() > fans[kept].size())) {
          kept = f;
        }
      }
      for (std::size_t f = 0; f < fans.size(); ++f) {
        if (f == kept) {
          continue;
        }
        for (const Offset s : fans[f]) {
          left.insert(complex_[s], complex_[s] + arity_);
          complex_.remove(s);
        }
      }
      ++num_applied_;
      result.push_back(v);
    }
    detail::sort_unique(result);
    return result;
  }

  /// How many times as large the simplices at a vertex are as those that a hole without it
  /// can be closed with, at least; 0 where there are none or too many, or others are near.
  double steepness(Index v) const {
    const std::vector<Offset>& star = complex_.star(v);
    std::vector<Index> around;
    for (const Offset s : star) {
      around.insert(around.end(), complex_[s], complex_[s] + arity_);
    }
    detail::sort_unique(around);
    if (star.empty() || around.size() > kMostVertices + 1) {
      return 0;
    }
    for (const Index w : around) {
      if (w != v && samples_.squared_distance(v, w) < scales_[w] * scales_[w]) {
        return 0;
      }
    }
    return volume_of(star) / least_cone(v, around);
  }

  /// Takes a vertex out if its star is a spike and links stay proper without it.
  bool level(Index v) {
    if (!(steepness(v) > kSteep)) {
      return false;
    }
    Move move{complex_.star(v), {}, 0};
    const double steep = volume_of(move.out);
    if (!refill({v}, move)) {
      return false;
    }
    double flat = 0;
    for (std::size_t i = 0; i < move.in.size(); i += arity_) {
      flat += ruler_.measure(move.in.data() + i, arity_).volume;
    }
    // The vertex itself is left without simplices.
    if (!(steep > kSteep * flat) || change_by(move, 0.5) > 0.5) {
      return false;
    }
    apply(move);
    return true;
  }

  SimplexArray finish() { return complex_.finish(); }

 private:
  double volume_of(const std::vector<Offset>& simplices) const {
    double volume = 0;
    for (const Offset s : simplices) {
      volume += ruler_.measure(complex_[s], arity_).volume;
    }
    return volume;
  }

  /// Of those over the link of v whose apex is one of its vertices: a bound for what closes
  /// a hole, and one that is close where the hole is flat.
  double least_cone(Index v, const std::vector<Index>& around) const {
    double least = std::numeric_limits<double>::infinity();
    std::vector<Index> row(arity_);
    for (const Index apex : around) {
      double volume = apex == v ? least : 0;
      for (const Offset s : complex_.star(v)) {
        const Index* simplex = complex_[s];
        if (volume < least &&
            std::find(simplex, simplex + arity_, apex) == simplex + arity_) {
          std::replace_copy(simplex, simplex + arity_, row.begin(), v, apex);
          std::sort(row.begin(), row.end());
          volume += ruler_.measure(row.data(), arity_).volume;
        }
      }
      least = std::min(least, volume);
    }
    return least;
  }

  bool is_singular_now(Index v) {
    work_left_ -= static_cast<Offset>(complex_.star(v).size());
    return !complex_.star(v).empty() && !is_sphere_or_ball(complex_.link(v));
  }

  /// \param found  vertices of the connected open facets at v, or some where there are
  ///               too many
  /// \returns whether that is a hole with few vertices
  bool find_hole(Index v, std::vector<Index>& found) const {
    found.assign(1, v);
    for (std::size_t next = 0; next < found.size(); ++next) {
      for (const Offset s : complex_.star(found[next])) {
        for (int i = 0; i < arity_; ++i) {
          const std::vector<Index> facet = complex_.facet(s, i);
          if (std::find(facet.begin(), facet.end(), found[next]) == facet.end() ||
              complex_.simplices_on(facet).size() != 1) {
            continue;
          }
          for (const Index w : facet) {
            if (std::find(found.begin(), found.end(), w) == found.end()) {
              found.push_back(w);
            }
          }
        }
      }
      if (found.size() > kMostVertices) {
        return false;
      }
    }
    std::sort(found.begin(), found.end());
    return found.size() > 1;
  }

  std::vector<Move> moves_at(Index v) {
    std::vector<Move> moves;
    for (const std::vector<Index>& face : faces_at(v)) {
      const std::vector<std::vector<Offset>> fans = fans_at(face);
      if (fans.size() < 2 || work_left_ < 0) {
        continue;
      }
      for (const std::vector<Offset>& fan : fans) {
        Move move{fan, {}, 0};
        if (has_open_facet(fan)) {
          moves.push_back(move);
        }
        if (refill(face, move)) {
          moves.push_back(std::move(move));
        }
      }
    }
    std::vector<std::vector<Index>> open;
    for (const Offset s : complex_.star(v)) {
      bool at_boundary = false;
      for (int i = 0; i < arity_; ++i) {
        std::vector<Index> facet = complex_.facet(s, i);
        if (complex_.simplices_on(facet).size() == 1) {
          at_boundary = true;
          open.push_back(std::move(facet));
        }
      }
      if (at_boundary) {
        moves.push_back({{s}, {}, 0});
      }
    }
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        std::vector<Index> both;
        std::set_union(open[i].begin(), open[i].end(), open[j].begin(), open[j].end(),
                       std::back_inserter(both));
        if (static_cast<int>(both.size()) == arity_ &&
            complex_.simplices_on(both).empty()) {
          moves.push_back({{}, std::move(both), 0});
        }
      }
    }
    for (Move& move : moves) {
      for (const Offset s : move.out) {
        move.energy -= ruler_.energy(complex_[s], arity_);
      }
      for (std::size_t i = 0; i < move.in.size(); i += arity_) {
        move.energy += ruler_.energy(move.in.data() + i, arity_);
      }
    }
    return moves;
  }

  /// Faces with v around which there may be several fans: dimension 0 to K-2.
  std::vector<std::vector<Index>> faces_at(Index v) const {
    std::vector<std::vector<Index>> faces;
    std::vector<Index> face;
    for (const Offset s : complex_.star(v)) {
      for (unsigned subset = 1; subset < 1U << arity_; ++subset) {
        face.clear();
        for (int i = 0; i < arity_; ++i) {
          if ((subset >> i & 1U) != 0) {
            face.push_back(complex_[s][i]);
          }
        }
        if (static_cast<int>(face.size()) <= arity_ - 2 &&
            std::find(face.begin(), face.end(), v) != face.end()) {
          faces.push_back(face);
        }
      }
    }
    detail::sort_unique(faces);
    return faces;
  }

  /// Simplices on a face that are connected through facets on it.
  std::vector<std::vector<Offset>> fans_at(const std::vector<Index>& face) const {
    const std::vector<Offset> star = complex_.simplices_on(face);
    detail::DisjointSets sets(static_cast<Offset>(star.size()));
    for (std::size_t a = 0; a < star.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        std::vector<Index> common;
        std::set_intersection(complex_[star[a]], complex_[star[a]] + arity_,
                              complex_[star[b]], complex_[star[b]] + arity_,
                              std::back_inserter(common));
        if (static_cast<int>(common.size()) == arity_ - 1) {
          sets.join(static_cast<Offset>(a), static_cast<Offset>(b));
        }
      }
    }
    std::vector<std::vector<Offset>> fans;
    std::vector<std::size_t> fan_of(star.size());
    for (std::size_t a = 0; a < star.size(); ++a) {
      const auto root = static_cast<std::size_t>(sets.find(static_cast<Offset>(a)));
      if (root == a) {
        fan_of[a] = fans.size();
        fans.emplace_back();
      }
      fans[fan_of[root]].push_back(star[a]);
    }
    return fans;
  }

  bool has_open_facet(const std::vector<Offset>& fan) const {
    for (const Offset s : fan) {
      for (int i = 0; i < arity_; ++i) {
        if (complex_.simplices_on(complex_.facet(s, i)).size() == 1) {
          return true;
        }
      }
    }
    return false;
  }

  /// Fills the hole that the move leaves by simplices without the face.
  bool refill(const std::vector<Index>& face, Move& move) {
    std::vector<Index> vertices;
    for (const Offset s : move.out) {
      vertices.insert(vertices.end(), complex_[s], complex_[s] + arity_);
    }
    detail::sort_unique(vertices);
    if (face.size() == 1) {
      vertices.erase(std::find(vertices.begin(), vertices.end(), face[0]));
    }
    return fill(
        vertices, face,
        [](const Index*) { return std::numeric_limits<double>::infinity(); }, move);
  }

  /// Adds to the move what fills the cavities between some vertices, without the face.
  /// \returns false where a facet between them stays open
  bool fill(const std::vector<Index>& vertices, const std::vector<Index>& face,
            const FacetPrice& price, Move& move) {
    if (vertices.size() > kMostVertices || static_cast<int>(vertices.size()) < arity_) {
      return false;
    }
    SimplexArray around{arity_, {}};
    std::vector<Offset> seen;
    for (const Index w : vertices) {
      inside_[w] = 1;
      seen.insert(seen.end(), complex_.star(w).begin(), complex_.star(w).end());
    }
    detail::sort_unique(seen);
    for (const Offset s : seen) {
      if (std::find(move.out.begin(), move.out.end(), s) == move.out.end()) {
        detail::append_row(around, complex_[s]);
      }
    }
    const SimplexArray candidates = subsets_of(vertices, face);
    work_left_ -= kWorkPerCandidate * candidates.size();
    const Cavities cavities = find_cavities(around, inside_, candidates, ruler_, price);
    for (const Index w : vertices) {
      inside_[w] = 0;
    }
    if (cavities.count() == 0 || !cavities.dead_ends.empty()) {
      return false;
    }
    detail::CavitySearch search(cavities, execution_);
    for (Index c = 0; c < cavities.count(); ++c) {
      // A hole is closed where that costs less than leaving it open: who did not look at
      // all fillings cannot say. Around a face (at no price) any will do.
      const bool finished = search.run(c, kSearchSteps);
      if (search.leaves_open() || (face.empty() && !finished)) {
        return false;
      }
      for (const Index chosen : search.chosen()) {
        move.in.insert(move.in.end(), cavities.candidates[chosen],
                       cavities.candidates[chosen] + arity_);
      }
    }
    return !move.in.empty();
  }

  /// All (K+1)-subsets without the face, if there is one, that are no simplices yet.
  SimplexArray subsets_of(const std::vector<Index>& vertices,
                          const std::vector<Index>& face) const {
    SimplexArray result{arity_, {}};
    std::vector<std::uint8_t> pick(vertices.size(), 0);
    std::fill_n(pick.begin(), arity_, 1);
    std::vector<Index> row(arity_);
    do {
      auto out = row.begin();
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (pick[i] != 0) {
          *out++ = vertices[i];
        }
      }
      const bool excluded = !face.empty() && std::includes(row.begin(), row.end(),
                                                           face.begin(), face.end());
      if (!excluded && complex_.simplices_on(row).empty()) {
        detail::append_row(result, row.data());
      }
    } while (std::prev_permutation(pick.begin(), pick.end()));
    return result;
  }

  std::vector<Index> vertices_of(const Move& move) const {
    std::vector<Index> vertices = move.in;
    for (const Offset s : move.out) {
      vertices.insert(vertices.end(), complex_[s], complex_[s] + arity_);
    }
    detail::sort_unique(vertices);
    return vertices;
  }

  void apply(const Move& move) {
    put(move);
    ++num_applied_;
  }

  std::vector<Offset> put(const Move& move) {
    for (const Offset s : move.out) {
      complex_.remove(s);
    }
    std::vector<Offset> added;
    for (std::size_t i = 0; i < move.in.size(); i += arity_) {
      added.push_back(complex_.add(move.in.data() + i));
    }
    return added;
  }

  /// By how much there are more singular vertices; one that is left without simplices, to
  /// be put back later, counts half.
  /// \param most  above this any number will do
  double change_by(const Move& move, double most) {
    const std::vector<Index> touched = vertices_of(move);
    double before = 0;
    for (const Index v : touched) {
      before += complex_.star(v).empty() ? 0.5 : is_singular(v) ? 1.0 : 0.0;
    }
    const std::vector<Offset> added = put(move);
    double after = 0;
    for (std::size_t i = 0; i < touched.size() && after - before <= most; ++i) {
      const Index v = touched[i];
      after += complex_.star(v).empty() ? 0.5 : is_singular_now(v) ? 1.0 : 0.0;
    }
    for (const Offset s : added) {
      complex_.remove(s);
    }
    for (const Offset s : move.out) {
      complex_.restore(s);
    }
    return after - before;
  }

  const Samples& samples_;
  const std::vector<double>& scales_;
  const Execution& execution_;
  detail::EditableComplex complex_;
  int arity_;
  SimplexRuler ruler_;
  Offset work_left_;
  std::vector<std::uint8_t> inside_;
  std::vector<Index> hole_of_;  // the last hole tried at each vertex, or -1
  Offset num_applied_ = 0;      // moves
  /// Of each vertex, the number of moves when it was last looked at in vain, and when its
  /// link was last judged.
  std::vector<Offset> tried_at_;
  std::vector<Offset> judged_at_;
  std::vector<std::uint8_t> judged_;
  std::vector<std::uint8_t>
      changed_;  // holes at whose vertices simplices changed since
};

/// Marked vertices on facets with one coface.
std::vector<Index> open_vertices(const SimplexArray& simplices,
                                 const std::vector<std::uint8_t>& marked,
                                 const Execution& execution) {
  const SimplexArray near = detail::select_rows(
      simplices, detail::rows_near(simplices, marked, simplices.arity - 1, execution));
  std::vector<Index> result = unpaired_facets(near, marked, execution).open.vertices;
  detail::sort_unique(result);
  return result;
}

}  // namespace

std::vector<Index> repair_links(const Samples& samples,
                                const std::vector<double>& scales,
                                const std::vector<std::uint8_t>& marked,
                                const FacetPrice& price, SimplexArray& simplices,
                                const Execution& execution, Offset work_per_simplex) {
  if (simplices.arity - 1 > kMostDim) {
    return {};
  }
  std::vector<Index> singular = singular_vertices(simplices, marked, execution);
  std::vector<Index> open = open_vertices(simplices, marked, execution);
  if (singular.empty() && open.empty()) {
    return {};
  }
  const Offset work = work_per_simplex * std::max(simplices.size(), kLeastSimplices);
  LinkRepair repair(samples, scales, std::move(simplices), work, execution);
  for (int round = 0; round < kRounds && !singular.empty(); ++round) {
    std::vector<Index> left;
    for (std::size_t i = 0; i < singular.size(); ++i) {
      execution.poll();
      const Index v = singular[i];
      if (!repair.is_singular(v)) {
        continue;
      }
      const std::vector<Index> touched = repair.mend(v);
      open.insert(open.end(), touched.begin(), touched.end());
      std::copy_if(touched.begin(), touched.end(), std::back_inserter(left),
                   [&](Index w) { return repair.is_singular(w); });
      if (touched.empty()) {
        left.push_back(v);
      }
    }
    detail::sort_unique(left);
    singular.swap(left);
  }
  // As many links may be proper after it, but other ones.
  for (const Index v : repair.close_holes(open, price)) {
    if (repair.is_singular(v)) {
      singular.push_back(v);
    }
  }
  const std::vector<Index> cut = repair.cut(singular);
  simplices = repair.finish();
  return cut;
}

std::vector<Index> cut_links(const Samples& samples,
                             const std::vector<std::uint8_t>& marked,
                             SimplexArray& simplices, const Execution& execution) {
  if (simplices.arity - 1 > kMostDim) {
    return {};
  }
  const std::vector<Index> singular = singular_vertices(simplices, marked, execution);
  if (singular.empty()) {
    return {};
  }
  const std::vector<double> no_scales;  // cuts are not compared
  LinkRepair repair(samples, no_scales, std::move(simplices), 0, execution);
  std::vector<Index> cut = repair.cut(singular);
  simplices = repair.finish();
  return cut;
}

std::vector<Index> level_spikes(const Samples& samples,
                                const std::vector<double>& scales,
                                SimplexArray& simplices, const Execution& execution) {
  std::vector<Index> levelled;
  if (simplices.arity - 1 > kMostDim || simplices.arity < 3) {
    return levelled;
  }
  LinkRepair repair(samples, scales, std::move(simplices), 0, execution);
  // The steepest first: what lies between strays is none without them.
  std::vector<std::pair<double, Index>> spikes;
  for (Index v = 0; v < samples.size(); ++v) {
    if (v % kPollStride == 0) {
      execution.poll();
    }
    const double steepness = repair.steepness(v);
    if (steepness > kSteep) {
      spikes.emplace_back(-steepness, v);
    }
  }
  std::sort(spikes.begin(), spikes.end());
  for (const auto& [steepness, v] : spikes) {
    execution.poll();
    if (repair.level(v)) {
      levelled.push_back(v);
    }
  }
  std::sort(levelled.begin(), levelled.end());
  simplices = repair.finish();
  return levelled;
}

}  // namespace remanifold
