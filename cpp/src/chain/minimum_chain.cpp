// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/minimum_chain.hpp"

#include "base/parallel.hpp"
#include "chain/cavity_search.hpp"
#include "chain/relative_signs.hpp"
#include "chain/rim_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace remanifold {
namespace {

constexpr Offset kBlock = 16;
constexpr double kIntegral = 1e-6;
/// Groups of rims and candidates up to which all relative signs of the groups are tried: no
/// more than eight programs, each a matter of milliseconds.
constexpr Index kFewGroups = 4;
constexpr Offset kFewCandidates = 4000;

/// The columns and rows of one cavity as a program over oriented simplices: for each
/// candidate one column a sign, for each facet two for what is left open, a sign each.
class OrientedProgram {
 public:
  /// \param signs  of the fixed simplex at each facet of the cavity; 0 where there is none
  OrientedProgram(const Cavities& cavities, Index cavity,
                  const std::vector<std::int8_t>& signs)
      : cavities_(cavities),
        arity_(cavities.candidates.arity),
        candidates_(cavities.candidates_in.begin(cavity)),
        num_candidates_(cavities.candidates_in.size(cavity)),
        facets_(cavities.facets_in.begin(cavity)),
        num_facets_(cavities.facets_in.size(cavity)) {
    add_columns();
    add_boundaries();
    add_rooms();
    set_signs(signs);
  }

  void set_signs(const std::vector<std::int8_t>& signs) {
    for (Offset f = 0; f < num_facets_; ++f) {
      const FacetNumber rim = cavities_.rims[facets_[f]];
      const double inward =
          rim == kOpen ? 0.0 : signs[f] * ((rim % arity_) % 2 == 0 ? 1.0 : -1.0);
      program_.row_lower[f] = program_.row_upper[f] = -inward;
    }
  }

  const LinearProgram& program() const { return program_; }

  double energy(const std::vector<double>& x) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += program_.costs[i] * x[i];
    }
    return sum;
  }

  bool is_integral(const std::vector<double>& x) const {
    for (Offset c = 0; c < num_candidates_; ++c) {
      if (is_fraction(share(x, c))) {
        return false;
      }
    }
    return true;
  }

  /// From a solution of the linear program to the integer program: candidates that it
  /// leaves out, and that share no facet with one it takes in part, stay out.
  void make_integral(const std::vector<double>& x) {
    program_.integral.assign(program_.costs.size(), 0);
    std::fill_n(program_.integral.begin(), 2 * num_candidates_, 1);
    std::vector<std::uint8_t> touched(num_facets_, 0);
    for (Offset c = 0; c < num_candidates_; ++c) {
      if (is_fraction(share(x, c))) {
        for (int i = 0; i < arity_; ++i) {
          touched[row_of(c, i)] = 1;
        }
      }
    }
    for (Offset c = 0; c < num_candidates_; ++c) {
      bool near = share(x, c) >= kIntegral;
      for (int i = 0; i < arity_; ++i) {
        near = near || touched[row_of(c, i)] != 0;
      }
      if (!near) {
        program_.upper[c] = program_.upper[num_candidates_ + c] = 0;
      }
    }
  }

  void append_chosen(const std::vector<double>& x, std::vector<Index>& chosen) const {
    for (Offset c = 0; c < num_candidates_; ++c) {
      if (share(x, c) > 0.5) {
        chosen.push_back(candidates_[c]);
      }
    }
  }

 private:
  static bool is_fraction(double share) {
    return std::abs(share - std::round(share)) >= kIntegral;
  }
  double share(const std::vector<double>& x, Offset candidate) const {
    return x[candidate] + x[num_candidates_ + candidate];
  }
  /// The facet of a candidate without its i-th vertex, among those of the cavity.
  Offset row_of(Offset candidate, int i) const {
    const Index facet = cavities_.facets_without(candidates_[candidate])[i];
    return std::lower_bound(facets_, facets_ + num_facets_, facet) - facets_;
  }

  void add_columns() {
    LinearProgram& p = program_;
    for (int sign = 0; sign < 2; ++sign) {
      for (Offset c = 0; c < num_candidates_; ++c) {
        p.costs.push_back(cavities_.energies[candidates_[c]]);
        const bool wrong = !cavities_.orientations.empty() &&
                           (cavities_.orientations[candidates_[c]] > 0) != (sign == 0);
        p.upper.push_back(wrong ? 0 : 1);
      }
    }
    for (int sign = 0; sign < 2; ++sign) {
      for (Offset f = 0; f < num_facets_; ++f) {
        p.costs.push_back(cavities_.prices[facets_[f]]);
        p.upper.push_back(2);
      }
    }
  }

  void add(Offset column, double value) {
    program_.columns.push_back(static_cast<Index>(column));
    program_.values.push_back(value);
  }
  void end_row(double lower, double upper) {
    program_.row_lower.push_back(lower);
    program_.row_upper.push_back(upper);
    program_.offsets.push_back(static_cast<Offset>(program_.columns.size()));
  }

  /// \param body  called with the column and the position of the facet
  template <class Body>
  void for_each_on(Index facet, const Body& body) const {
    for (const Index* c = cavities_.candidates_on.begin(facet);
         c != cavities_.candidates_on.end(facet); ++c) {
      const Index* facets = cavities_.facets_without(*c);
      body(std::lower_bound(candidates_, candidates_ + num_candidates_, *c) -
               candidates_,
           std::find(facets, facets + arity_, facet) - facets);
    }
  }

  /// What is on both sides of a facet cancels, or is left open.
  void add_boundaries() {
    for (Offset f = 0; f < num_facets_; ++f) {
      for_each_on(facets_[f], [&](Offset column, Offset position) {
        const double sign = position % 2 == 0 ? 1 : -1;
        add(column, sign);
        add(num_candidates_ + column, -sign);
      });
      add(2 * num_candidates_ + f, -1);
      add(2 * num_candidates_ + num_facets_ + f, 1);
      end_row(0, 0);  // until signs are known
    }
  }

  /// No more than two simplices on a facet.
  void add_rooms() {
    for (Offset f = 0; f < num_facets_; ++f) {
      const int room = cavities_.rims[facets_[f]] == kOpen ? 2 : 1;
      if (cavities_.candidates_on.size(facets_[f]) <= room) {
        continue;
      }
      for_each_on(facets_[f], [&](Offset column, Offset) {
        add(column, 1);
        add(num_candidates_ + column, 1);
      });
      end_row(-std::numeric_limits<double>::infinity(), room);
    }
  }

  const Cavities& cavities_;
  int arity_;
  const Index* candidates_;
  Offset num_candidates_;
  const Index* facets_;
  Offset num_facets_;
  LinearProgram program_;
};

/// K = 1: every sample of the cavity should have two edges, each missing one at its price.
/// Curves need no orientation for that.
LinearProgram degree_program(const Cavities& cavities, Index cavity) {
  LinearProgram p;
  const auto columns = static_cast<std::size_t>(cavities.candidates_in.size(cavity));
  const Index* candidates = cavities.candidates_in.begin(cavity);
  for (std::size_t c = 0; c < columns; ++c) {
    p.costs.push_back(cavities.energies[candidates[c]]);
    p.upper.push_back(1);
    p.integral.push_back(1);
  }
  for (const Index* f = cavities.facets_in.begin(cavity);
       f != cavities.facets_in.end(cavity); ++f) {
    const double wanted = cavities.rims[*f] == kOpen ? 2 : 1;
    for (const Index* c = cavities.candidates_on.begin(*f);
         c != cavities.candidates_on.end(*f); ++c) {
      p.columns.push_back(static_cast<Index>(
          std::lower_bound(candidates, candidates + columns, *c) - candidates));
      p.values.push_back(1);
    }
    p.columns.push_back(static_cast<Index>(p.costs.size()));
    p.values.push_back(1);
    p.costs.push_back(cavities.prices[*f]);
    p.upper.push_back(wanted);
    p.integral.push_back(0);
    p.row_lower.push_back(wanted);
    p.row_upper.push_back(wanted);
    p.offsets.push_back(static_cast<Offset>(p.columns.size()));
  }
  return p;
}

class ChainSolver {
 public:
  ChainSolver(const Cavities& cavities, const SimplexArray& fixed, Index num_vertices,
              const ChainOptions& options, const ProgramSolver& solver,
              const Execution& execution)
      : cavities_(cavities),
        fixed_(fixed),
        num_vertices_(num_vertices),
        options_(options),
        solver_(solver),
        execution_(execution) {}

  ChainFill run() {
    search_all();
    if (!large_.empty()) {
      if (fixed_.arity == 2) {
        solve_degrees();
      } else {
        solve_oriented();
      }
    }
    std::sort(fill_.chosen.begin(), fill_.chosen.end());
    mark_open();
    return std::move(fill_);
  }

 private:
  bool is_searched(Index cavity) const {
    if (!solver_) {
      return true;
    }
    // Samples of a curve that nothing fixed touches are for the program to cover.
    return cavities_.candidates_in.size(cavity) <= options_.search_candidates &&
           (fixed_.arity > 2 ||
            std::none_of(cavities_.facets_in.begin(cavity),
                         cavities_.facets_in.end(cavity),
                         [&](Index f) { return cavities_.rims[f] == kOpen; }));
  }

  void search_all() {
    const Index count = cavities_.count();
    std::vector<std::vector<Index>> chosen(count);
    std::vector<std::uint8_t> finished(count, 0);
    detail::PerThread<detail::CavitySearch> searches(
        [&] { return detail::CavitySearch(cavities_, execution_); });
    detail::for_each_block_uncounted(
        count, kBlock, execution_, [&](Offset begin, Offset end) {
          detail::CavitySearch& search = searches.local();
          for (Offset c = begin; c < end; ++c) {
            const auto cavity = static_cast<Index>(c);
            if (is_searched(cavity)) {
              execution_.poll();
              finished[c] = search.run(cavity, options_.search_steps) ? 1 : 0;
              chosen[c] = search.chosen();
            }
          }
        });
    for (Index c = 0; c < count; ++c) {
      if (finished[c] != 0 || !solver_) {
        fill_.searched += finished[c];
        fill_.unsolved += 1 - finished[c];
        fill_.chosen.insert(fill_.chosen.end(), chosen[c].begin(), chosen[c].end());
      } else {
        large_.push_back(c);
      }
    }
  }

  void solve_degrees() {
    for (const Index cavity : large_) {
      execution_.poll();
      ++fill_.integer_programs;
      const std::vector<double> x = solver_(degree_program(cavities_, cavity));
      if (x.empty()) {
        ++fill_.unsolved;
        continue;
      }
      for (Offset i = 0; i < cavities_.candidates_in.size(cavity); ++i) {
        if (x[i] > 0.5) {
          fill_.chosen.push_back(cavities_.candidates_in.begin(cavity)[i]);
        }
      }
    }
  }

  void solve_oriented() {
    std::optional<detail::RimOrientation> orientation;
    if (cavities_.orientations.empty()) {
      orientation.emplace(fixed_, num_vertices_, execution_);
    }
    for (const Index cavity : large_) {
      execution_.poll();
      if (!orientation) {
        solve(cavity, {own_signs(cavity)});
        continue;
      }
      const auto rims = orientation->orient(rims_of(cavity));
      const std::vector<std::int8_t> likely =
          detail::relative_signs(cavities_, cavity, rims);
      const bool few = rims.num_groups <= kFewGroups &&
                       cavities_.candidates_in.size(cavity) <= kFewCandidates;
      solve(cavity, few ? all_signs(cavity, likely, rims)
                        : std::vector<std::vector<std::int8_t>>{likely});
    }
  }

  /// K = D: what is positive is known.
  std::vector<std::int8_t> own_signs(Index cavity) const {
    std::vector<std::int8_t> signs;
    for (const Index* f = cavities_.facets_in.begin(cavity);
         f != cavities_.facets_in.end(cavity); ++f) {
      signs.push_back(cavities_.rim_orientations[*f]);
    }
    return signs;
  }

  std::vector<FacetNumber> rims_of(Index cavity) const {
    std::vector<FacetNumber> rims;
    for (const Index* f = cavities_.facets_in.begin(cavity);
         f != cavities_.facets_in.end(cavity); ++f) {
      if (cavities_.rims[*f] != kOpen) {
        rims.push_back(cavities_.rims[*f]);
      }
    }
    return rims;
  }

  /// The likely signs, and those that differ by turning some of the groups around.
  std::vector<std::vector<std::int8_t>> all_signs(
      Index cavity, const std::vector<std::int8_t>& likely,
      const detail::RimOrientation::Signs& rims) const {
    std::vector<std::vector<std::int8_t>> all;
    for (int turned = 0; turned < 1 << (std::max<Index>(rims.num_groups, 1) - 1);
         ++turned) {
      all.push_back(likely);
      std::size_t rim = 0;
      for (std::size_t f = 0; f < likely.size(); ++f) {
        if (cavities_.rims[cavities_.facets_in.begin(cavity)[f]] == kOpen) {
          continue;
        }
        const Index group = rims.group[rim++];
        if (group > 0 && (turned >> (group - 1) & 1) != 0) {
          all.back()[f] = static_cast<std::int8_t>(-likely[f]);
        }
      }
    }
    return all;
  }

  /// The linear program of least energy, and the integer one where it takes a candidate in
  /// part.
  void solve(Index cavity, const std::vector<std::vector<std::int8_t>>& choices) {
    OrientedProgram program(cavities_, cavity, choices.front());
    ++fill_.programs;
    std::vector<double> best;
    double least = std::numeric_limits<double>::infinity();
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      execution_.poll();
      program.set_signs(choices[i]);
      std::vector<double> x = solver_(program.program());
      const double energy = x.empty() ? least : program.energy(x);
      if (energy < least) {
        least = energy;
        best.swap(x);
        chosen = i;
      }
    }
    if (!best.empty() && !program.is_integral(best)) {
      program.set_signs(choices[chosen]);
      program.make_integral(best);
      ++fill_.integer_programs;
      best = solver_(program.program());
    }
    if (best.empty()) {
      ++fill_.unsolved;
      return;
    }
    program.append_chosen(best, fill_.chosen);
  }

  void mark_open() {
    const int arity = fixed_.arity;
    std::vector<std::uint8_t> cofaces(cavities_.rims.size());
    for (std::size_t f = 0; f < cofaces.size(); ++f) {
      cofaces[f] = cavities_.rims[f] == kOpen ? 0 : 1;
    }
    for (const Index c : fill_.chosen) {
      for (int i = 0; i < arity; ++i) {
        ++cofaces[cavities_.facets_of[static_cast<std::size_t>(c) * arity + i]];
      }
    }
    fill_.open.assign(cavities_.count(), 0);
    for (Index cavity = 0; cavity < cavities_.count(); ++cavity) {
      fill_.open[cavity] = std::any_of(
          cavities_.facets_in.begin(cavity), cavities_.facets_in.end(cavity),
          [&](Index f) { return cofaces[f] == 1 || (arity == 2 && cofaces[f] == 0); });
    }
  }

  const Cavities& cavities_;
  const SimplexArray& fixed_;
  Index num_vertices_;
  const ChainOptions& options_;
  const ProgramSolver& solver_;
  const Execution& execution_;
  std::vector<Index> large_;
  ChainFill fill_;
};

}  // namespace

ChainFill fill_cavities(const Cavities& cavities, const SimplexArray& fixed,
                        Index num_vertices, const ChainOptions& options,
                        const ProgramSolver& solver, const Execution& execution) {
  return ChainSolver(cavities, fixed, num_vertices, options, solver, execution).run();
}

}  // namespace remanifold
