// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/minimum_chain.hpp"

#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "chain/cavity_part.hpp"
#include "chain/cavity_refill.hpp"
#include "chain/cavity_search.hpp"
#include "chain/chain_program.hpp"
#include "chain/relative_signs.hpp"
#include "chain/rim_orientation.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace remanifold {
namespace {

constexpr Offset kBlock = 16;
/// Groups of rims and candidates up to which all relative signs of the groups are tried: no
/// more than eight programs, each a matter of milliseconds.
constexpr Index kFewGroups = 4;
constexpr Offset kFewCandidates = 4000;
/// Steps through the simplices around a window, for each of its candidates, in which rims
/// have to meet whose orientation is to count as known.
constexpr std::size_t kStepsPerCandidate = 4;

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
      solve_all();
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
    if (options_.search_oriented && fixed_.arity == 2) {
      return false;
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
    detail::ThreadScratch<detail::CavitySearch> searches(
        [&] { return detail::CavitySearch(cavities_, execution_); });
    detail::for_each_block_uncounted(
        count, kBlock, execution_, [&](Offset begin, Offset end) {
          searches.use([&](detail::CavitySearch& search) {
            for (Offset c = begin; c < end; ++c) {
              const auto cavity = static_cast<Index>(c);
              if (is_searched(cavity)) {
                execution_.poll();
                finished[c] = search.run(cavity, options_.search_steps) ? 1 : 0;
                chosen[c] = search.chosen();
              }
            }
          });
        });
    const bool oriented = needs_orientation() && solver_;
    for (Index c = 0; c < count; ++c) {
      if (oriented && finished[c] != 0) {
        large_.push_back(c);
        found_.push_back(std::move(chosen[c]));
      } else if (finished[c] != 0 || !solver_) {
        fill_.searched += finished[c];
        fill_.unsolved += 1 - finished[c];
        fill_.chosen.insert(fill_.chosen.end(), chosen[c].begin(), chosen[c].end());
      } else {
        large_.push_back(c);
        found_.emplace_back(std::nullopt);
      }
    }
  }

  /// Where K = D every candidate has the sign that it must have.
  bool needs_orientation() const {
    return options_.search_oriented && cavities_.orientations.empty();
  }

  void solve_all() {
    std::optional<detail::RimOrientation> orientation;
    if (fixed_.arity > 2 && cavities_.orientations.empty()) {
      orientation.emplace(fixed_, num_vertices_, options_.orientable, execution_);
    }
    std::optional<detail::CavityWindows> windows;
    std::optional<detail::CavityRefill> refill;
    if (orientation && options_.refill > 0) {
      refill.emplace(cavities_, options_.refill);
    }
    for (std::size_t i = 0; i < large_.size(); ++i) {
      const Index cavity = large_[i];
      if (cavities_.candidates_in.size(cavity) <= options_.largest_program) {
        const detail::CavityPart part = detail::whole_cavity(cavities_, cavity);
        bool guessed = false;
        const std::vector<Signs> signs =
            orientation ? choices(part, *orientation, guessed) : own_signs(part);
        if (found_[i] && detail::has_orientation(part, signs[0], *found_[i])) {
          ++fill_.searched;
          keep(*found_[i]);
          continue;
        }
        std::vector<Index> filling = solve(part, signs);
        if (refill && guessed) {
          refill->run(cavity, solver_, execution_, filling);
        }
        keep(filling);
        continue;
      }
      ++fill_.cut;
      if (!windows) {
        windows.emplace(cavities_, fixed_.size(), options_.window);
      }
      windows->start(cavity);
      for (detail::CavityPart part = windows->next(); !part.candidates.empty();
           part = windows->next()) {
        const std::vector<Index> chosen =
            solve(part, orientation ? signs_near(part, *orientation) : own_signs(part));
        windows->decide(part, chosen, orientation ? &*orientation : nullptr);
        keep(chosen);
      }
      if (orientation) {
        orientation->forget();
      }
    }
    if (refill) {
      fill_.refilled = refill->num_bettered();
      fill_.refills = refill->num_programs();
    }
  }

  void keep(const std::vector<Index>& chosen) {
    fill_.chosen.insert(fill_.chosen.end(), chosen.begin(), chosen.end());
  }

  using Signs = std::vector<std::int8_t>;

  /// K = D: what is positive is known. K = 1: nobody asks.
  static std::vector<Signs> own_signs(const detail::CavityPart& part) {
    return {part.rim_orientations};
  }

  static std::vector<FacetNumber> rims_of(const detail::CavityPart& part) {
    std::vector<FacetNumber> rims;
    std::copy_if(part.rims.begin(), part.rims.end(), std::back_inserter(rims),
                 [](FacetNumber rim) { return rim != kOpen; });
    return rims;
  }

  /// The likely signs of a whole cavity, and where that is cheap all others.
  /// \param guessed  set where there are others
  static std::vector<Signs> choices(const detail::CavityPart& part,
                                    detail::RimOrientation& orientation,
                                    bool& guessed) {
    const auto rims = orientation.orient(rims_of(part));
    const Signs likely = detail::relative_signs(part, rims);
    guessed = !rims.certain;
    if (rims.num_groups <= kFewGroups && part.num_candidates() <= kFewCandidates) {
      return all_signs(part, likely, rims);
    }
    guessed = guessed || rims.num_groups > 1;
    return {likely};
  }

  /// Those of a window: its orientation is its own.
  std::vector<Signs> signs_near(const detail::CavityPart& part,
                                detail::RimOrientation& orientation) const {
    return {detail::relative_signs(
        part, orientation.orient_near(
                  rims_of(part), kStepsPerCandidate *
                                     static_cast<std::size_t>(part.num_candidates())))};
  }

  /// The likely signs, and those that differ by turning some of the groups around.
  static std::vector<Signs> all_signs(const detail::CavityPart& part,
                                      const Signs& likely,
                                      const detail::RimOrientation::Signs& rims) {
    std::vector<Signs> all;
    for (int turned = 0; turned < 1 << (std::max<Index>(rims.num_groups, 1) - 1);
         ++turned) {
      all.push_back(likely);
      std::size_t rim = 0;
      for (std::size_t f = 0; f < likely.size(); ++f) {
        if (part.rims[f] == kOpen) {
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

  /// \returns the candidates of the part's core that a filling of least energy has
  std::vector<Index> solve(const detail::CavityPart& part,
                           const std::vector<Signs>& choices) {
    execution_.poll();
    fill_.largest_program =
        std::max(fill_.largest_program, static_cast<Index>(part.num_candidates()));
    return part.arity() == 2 ? solve_degrees(part) : solve_oriented(part, choices);
  }

  std::vector<Index> solve_degrees(const detail::CavityPart& part) {
    ++fill_.integer_programs;
    const std::vector<double> x = solver_(detail::degree_program(part));
    std::vector<Index> chosen;
    if (x.empty()) {
      ++fill_.unsolved;
      return chosen;
    }
    for (Offset c = 0; c < part.num_candidates(); ++c) {
      if (part.core[c] != 0 && x[c] > 0.5) {
        chosen.push_back(part.candidates[c]);
      }
    }
    return chosen;
  }

  /// The linear program of least energy, and the integer one where it takes a candidate in
  /// part.
  std::vector<Index> solve_oriented(const detail::CavityPart& part,
                                    const std::vector<Signs>& choices) {
    detail::OrientedProgram program(part, choices.front());
    ++fill_.programs;
    std::vector<double> best;
    double least = std::numeric_limits<double>::infinity();
    std::size_t best_choice = 0;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      execution_.poll();
      program.set_signs(choices[i]);
      std::vector<double> x = solver_(program.program());
      const double energy = x.empty() ? least : program.energy(x);
      if (energy < least) {
        least = energy;
        best.swap(x);
        best_choice = i;
      }
    }
    if (best.empty()) {
      ++fill_.unsolved;
      return {};
    }
    if (program.is_integral(best)) {
      return program.chosen(best);
    }
    program.set_signs(choices[best_choice]);
    program.make_integral(best);
    ++fill_.integer_programs;
    execution_.poll();
    const std::vector<double> integral = solver_(program.program());
    if (integral.empty()) {
      ++fill_.unsolved;
      return program.rounded(best);
    }
    return program.chosen(integral);
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
      for (const Index* f = cavities_.facets_in.begin(cavity);
           f != cavities_.facets_in.end(cavity); ++f) {
        if (cofaces[*f] == 1 || (arity == 2 && cofaces[*f] == 0)) {
          fill_.open[cavity] = 1;
          fill_.open_facets.push_back(*f);
        }
      }
    }
  }

  const Cavities& cavities_;
  const SimplexArray& fixed_;
  Index num_vertices_;
  const ChainOptions& options_;
  const ProgramSolver& solver_;
  const Execution& execution_;
  std::vector<Index> large_;  // cavities for programs
  /// Of each of them: a filling of least energy whatever its orientation, if known.
  std::vector<std::optional<std::vector<Index>>> found_;
  ChainFill fill_;
};

}  // namespace

ChainFill fill_cavities(const Cavities& cavities, const SimplexArray& fixed,
                        Index num_vertices, const ChainOptions& options,
                        const ProgramSolver& solver, const Execution& execution) {
  return ChainSolver(cavities, fixed, num_vertices, options, solver, execution).run();
}

}  // namespace remanifold
