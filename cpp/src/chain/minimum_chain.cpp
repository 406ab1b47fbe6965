// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/minimum_chain.hpp"

#include "base/parallel.hpp"
#include "base/signed_sets.hpp"
#include "base/sort_unique.hpp"
#include "chain/cavity_search.hpp"
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
/// Groups of rims for which all relative signs are tried; of more, each is flipped once.
constexpr Index kAllSigns = 4;

/// The columns and rows of some cavities in one program over oriented simplices: for each
/// candidate one column a sign, for each facet two for what is left open, a sign each.
class OrientedProgram {
 public:
  OrientedProgram(const Cavities& cavities, const std::vector<Index>& which)
      : cavities_(cavities), arity_(cavities.candidates.arity) {
    for (const Index cavity : which) {
      candidates_.insert(candidates_.end(), cavities.candidates_in.begin(cavity),
                         cavities.candidates_in.end(cavity));
      facets_.insert(facets_.end(), cavities.facets_in.begin(cavity),
                     cavities.facets_in.end(cavity));
    }
    build();
  }

  /// The sign of the fixed simplex at each facet; 0 where there is none.
  void set_signs(const std::vector<std::int8_t>& signs) {
    for (std::size_t i = 0; i < facets_.size(); ++i) {
      const FacetNumber rim = cavities_.rims[facets_[i]];
      const double inward =
          rim == kOpen ? 0.0 : signs[i] * ((rim % arity_) % 2 == 0 ? 1.0 : -1.0);
      program_.row_lower[i] = program_.row_upper[i] = -inward;
    }
  }

  /// Candidates that the linear program leaves out, and that share no facet with one it
  /// takes in part, stay out.
  void make_integral(const std::vector<double>& shares) {
    const std::size_t columns = candidates_.size();
    program_.integral.assign(program_.costs.size(), 0);
    std::fill_n(program_.integral.begin(), 2 * columns, 1);
    std::vector<std::uint8_t> touched(cavities_.rims.size(), 0);
    for (std::size_t c = 0; c < columns; ++c) {
      if (std::abs(shares[c] - std::round(shares[c])) >= kIntegral) {
        for (int i = 0; i < arity_; ++i) {
          touched[cavities_.facets_without(candidates_[c])[i]] = 1;
        }
      }
    }
    for (std::size_t c = 0; c < columns; ++c) {
      const Index* facets = cavities_.facets_without(candidates_[c]);
      if (shares[c] < kIntegral &&
          std::none_of(facets, facets + arity_, [&](Index f) { return touched[f]; })) {
        program_.upper[c] = program_.upper[columns + c] = 0;
      }
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

  /// Share of a candidate in the solution.
  double share(const std::vector<double>& x, std::size_t candidate) const {
    return x[candidate] + x[candidates_.size() + candidate];
  }
  std::vector<double> shares(const std::vector<double>& x, std::size_t begin,
                             std::size_t end) const {
    std::vector<double> result;
    for (std::size_t c = begin; c < end; ++c) {
      result.push_back(share(x, c));
    }
    return result;
  }
  const std::vector<Index>& candidates() const { return candidates_; }

 private:
  void build() {
    const std::size_t columns = candidates_.size();
    const std::size_t rows = facets_.size();
    std::vector<Index> column_of(cavities_.energies.size(), -1);
    for (std::size_t c = 0; c < columns; ++c) {
      column_of[candidates_[c]] = static_cast<Index>(c);
    }
    LinearProgram& p = program_;
    for (int sign = 0; sign < 2; ++sign) {
      for (const Index c : candidates_) {
        p.costs.push_back(cavities_.energies[c]);
        const bool wrong = !cavities_.orientations.empty() &&
                           (cavities_.orientations[c] > 0) != (sign == 0);
        p.upper.push_back(wrong ? 0 : 1);
      }
    }
    for (int sign = 0; sign < 2; ++sign) {
      for (const Index f : facets_) {
        p.costs.push_back(cavities_.prices[f]);
        p.upper.push_back(2);
      }
    }
    const auto add = [&](std::size_t column, double value) {
      p.columns.push_back(static_cast<Index>(column));
      p.values.push_back(value);
    };
    const auto end_row = [&](double lower, double upper) {
      p.row_lower.push_back(lower);
      p.row_upper.push_back(upper);
      p.offsets.push_back(static_cast<Offset>(p.columns.size()));
    };
    for (std::size_t r = 0; r < rows; ++r) {
      const Index facet = facets_[r];
      for (const Index* c = cavities_.candidates_on.begin(facet);
           c != cavities_.candidates_on.end(facet); ++c) {
        const double sign = position_of(facet, *c) % 2 == 0 ? 1 : -1;
        add(column_of[*c], sign);
        add(columns + column_of[*c], -sign);
      }
      add(2 * columns + r, -1);
      add(2 * columns + rows + r, 1);
      end_row(0, 0);
    }
    // No more than two simplices on a facet.
    for (const Index facet : facets_) {
      const int room = cavities_.rims[facet] == kOpen ? 2 : 1;
      if (cavities_.candidates_on.size(facet) <= room) {
        continue;
      }
      for (const Index* c = cavities_.candidates_on.begin(facet);
           c != cavities_.candidates_on.end(facet); ++c) {
        add(column_of[*c], 1);
        add(columns + column_of[*c], 1);
      }
      end_row(-std::numeric_limits<double>::infinity(), room);
    }
  }

  int position_of(Index facet, Index candidate) const {
    const Index* facets = cavities_.facets_without(candidate);
    return static_cast<int>(std::find(facets, facets + arity_, facet) - facets);
  }

  const Cavities& cavities_;
  int arity_;
  std::vector<Index> candidates_;
  std::vector<Index> facets_;
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
  ChainSolver(const Cavities& cavities, const SimplexArray& fixed,
              const OrientedPatches* patches, Index num_vertices,
              const ChainOptions& options, const ProgramSolver& solver,
              const Execution& execution)
      : cavities_(cavities),
        fixed_(fixed),
        patches_(patches),
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

  /// Whether a filling continues the orientation of the patches around it.
  bool is_oriented(Index cavity, const std::vector<Index>& chosen) const {
    if (patches_ == nullptr || fixed_.arity == 2) {
      return true;
    }
    const int arity = fixed_.arity;
    std::vector<Index> patches;  // their nodes follow those of the chosen simplices
    for (const Index* f = cavities_.facets_in.begin(cavity);
         f != cavities_.facets_in.end(cavity); ++f) {
      if (cavities_.rims[*f] != kOpen) {
        patches.push_back(patches_->patch[cavities_.rims[*f] / arity]);
      }
    }
    detail::sort_unique(patches);
    const auto num_chosen = static_cast<Offset>(chosen.size());
    detail::SignedSets sets(num_chosen + static_cast<Offset>(patches.size()));
    for (const Index* f = cavities_.facets_in.begin(cavity);
         f != cavities_.facets_in.end(cavity); ++f) {
      // A node for each patch and for each chosen simplex, at most two on a facet.
      Offset node = -1;
      FacetNumber number = 0;
      int sign = 1;
      const FacetNumber rim = cavities_.rims[*f];
      if (rim != kOpen) {
        const Index patch = patches_->patch[rim / arity];
        if (patches_->orientable[patch] == 0) {
          continue;
        }
        node = num_chosen + (std::lower_bound(patches.begin(), patches.end(), patch) -
                             patches.begin());
        number = rim;
        sign = patches_->sign[rim / arity];
      }
      for (Offset other = 0; other < num_chosen; ++other) {
        const Index* facets = cavities_.facets_without(chosen[other]);
        const auto position = std::find(facets, facets + arity, *f) - facets;
        if (position == arity) {
          continue;
        }
        if (node >= 0) {
          const int flip = flips_across(number, position, arity) ? -1 : 1;
          if (!sets.join(node, other, sign * flip)) {
            return false;
          }
        }
        node = other;
        number = position;
        sign = 1;
      }
    }
    return true;
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
    std::vector<Index> together;
    std::vector<std::int8_t> signs_together;
    for (const Index cavity : large_) {
      execution_.poll();
      if (!orientation) {
        together.push_back(cavity);
        for (const Index* f = cavities_.facets_in.begin(cavity);
             f != cavities_.facets_in.end(cavity); ++f) {
          signs_together.push_back(cavities_.rim_orientations[*f]);
        }
        continue;
      }
      std::vector<FacetNumber> rims;
      for (const Index* f = cavities_.facets_in.begin(cavity);
           f != cavities_.facets_in.end(cavity); ++f) {
        if (cavities_.rims[*f] != kOpen) {
          rims.push_back(cavities_.rims[*f]);
        }
      }
      const auto signs = orientation->orient(rims);
      if (signs.num_groups <= 1) {
        together.push_back(cavity);
        spread(cavity, signs.sign, signs_together);
      } else {
        solve_groups(cavity, signs);
      }
    }
    if (together.empty()) {
      return;
    }
    OrientedProgram program(cavities_, together);
    program.set_signs(signs_together);
    fill_.programs += static_cast<Index>(together.size());
    const std::vector<double> x = solver_(program.program());
    if (x.empty()) {
      fill_.unsolved += static_cast<Index>(together.size());
      return;
    }
    std::size_t first = 0;
    std::size_t first_sign = 0;
    for (const Index cavity : together) {
      const auto size = static_cast<std::size_t>(cavities_.candidates_in.size(cavity));
      bool integral = true;
      for (std::size_t c = first; c < first + size; ++c) {
        const double share = program.share(x, c);
        integral = integral && std::abs(share - std::round(share)) < kIntegral;
      }
      const auto num_facets = static_cast<Offset>(cavities_.facets_in.size(cavity));
      if (integral) {
        take(program, x, first, first + size);
      } else {
        const auto begin = signs_together.begin() + static_cast<Offset>(first_sign);
        solve_integral(cavity, {begin, begin + num_facets},
                       program.shares(x, first, first + size));
      }
      first += size;
      first_sign += num_facets;
    }
  }

  /// From the rims of a cavity to its facets.
  void spread(Index cavity, const std::vector<std::int8_t>& rim_signs,
              std::vector<std::int8_t>& out) const {
    std::size_t rim = 0;
    for (const Index* f = cavities_.facets_in.begin(cavity);
         f != cavities_.facets_in.end(cavity); ++f) {
      out.push_back(cavities_.rims[*f] == kOpen ? std::int8_t{0} : rim_signs[rim++]);
    }
  }

  /// Several groups of rims, of unknown orientation to each other: the choice of least
  /// energy.
  void solve_groups(Index cavity, const detail::RimOrientation::Signs& rims) {
    OrientedProgram program(cavities_, {cavity});
    ++fill_.programs;
    std::vector<std::int8_t> flip(rims.num_groups, 1);
    const auto attempt = [&](std::vector<double>& x, std::vector<std::int8_t>& signs) {
      std::vector<std::int8_t> rim_signs = rims.sign;
      for (std::size_t i = 0; i < rim_signs.size(); ++i) {
        rim_signs[i] = static_cast<std::int8_t>(rim_signs[i] * flip[rims.group[i]]);
      }
      signs.clear();
      spread(cavity, rim_signs, signs);
      program.set_signs(signs);
      x = solver_(program.program());
      return x.empty() ? std::numeric_limits<double>::infinity() : program.energy(x);
    };
    std::vector<double> x, best_x;
    std::vector<std::int8_t> signs, best_signs;
    double best = attempt(best_x, best_signs);
    const auto keep_if_better = [&] {
      execution_.poll();
      const double energy = attempt(x, signs);
      if (energy < best) {
        best = energy;
        best_x.swap(x);
        best_signs.swap(signs);
        return true;
      }
      return false;
    };
    if (rims.num_groups <= kAllSigns) {
      for (int bits = 1; bits < 1 << (rims.num_groups - 1); ++bits) {
        for (Index g = 1; g < rims.num_groups; ++g) {
          flip[g] = (bits >> (g - 1) & 1) != 0 ? std::int8_t{-1} : std::int8_t{1};
        }
        keep_if_better();
      }
    } else {
      for (Index g = 1; g < rims.num_groups; ++g) {
        flip[g] = static_cast<std::int8_t>(-flip[g]);
        if (!keep_if_better()) {
          flip[g] = static_cast<std::int8_t>(-flip[g]);
        }
      }
    }
    if (best_x.empty()) {
      ++fill_.unsolved;
      return;
    }
    for (std::size_t c = 0; c < program.candidates().size(); ++c) {
      const double share = program.share(best_x, c);
      if (std::abs(share - std::round(share)) >= kIntegral) {
        solve_integral(cavity, best_signs,
                       program.shares(best_x, 0, program.candidates().size()));
        return;
      }
    }
    take(program, best_x, 0, program.candidates().size());
  }

  void solve_integral(Index cavity, const std::vector<std::int8_t>& signs,
                      const std::vector<double>& shares) {
    OrientedProgram program(cavities_, {cavity});
    program.set_signs(signs);
    program.make_integral(shares);
    ++fill_.integer_programs;
    const std::vector<double> x = solver_(program.program());
    if (x.empty()) {
      ++fill_.unsolved;
      return;
    }
    take(program, x, 0, program.candidates().size());
  }

  void take(const OrientedProgram& program, const std::vector<double>& x,
            std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      if (program.share(x, c) > 0.5) {
        fill_.chosen.push_back(program.candidates()[c]);
      }
    }
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
  const OrientedPatches* patches_;
  Index num_vertices_;
  const ChainOptions& options_;
  const ProgramSolver& solver_;
  const Execution& execution_;
  std::vector<Index> large_;
  ChainFill fill_;
};

}  // namespace

ChainFill fill_cavities(const Cavities& cavities, const SimplexArray& fixed,
                        const OrientedPatches* patches, Index num_vertices,
                        const ChainOptions& options, const ProgramSolver& solver,
                        const Execution& execution) {
  return ChainSolver(cavities, fixed, patches, num_vertices, options, solver, execution)
      .run();
}

}  // namespace remanifold
