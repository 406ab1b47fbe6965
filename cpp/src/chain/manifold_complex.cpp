// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/manifold_complex.hpp"

#include "base/assertions.hpp"
#include "base/disjoint_sets.hpp"
#include "base/free_memory.hpp"
#include "base/parallel.hpp"
#include "base/signed_sets.hpp"
#include "base/sort_unique.hpp"
#include "chain/candidates.hpp"
#include "chain/opening_finder.hpp"
#include "chain/stretched_scales.hpp"
#include "complex/simplex_rows.hpp"
#include "remanifold/cavities.hpp"
#include "remanifold/curve_repair.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/link_repair.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/star_consensus.hpp"
#include "remanifold/topology.hpp"
#include "remanifold/verify.hpp"
#include "remanifold/vertex_insertion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

namespace remanifold {
namespace {

constexpr Offset kBlock = 1024;
/// Price of an open facet where none may be.
constexpr double kForbidden = 1e5;
/// Price of an open facet at samples that are known to lie on the boundary.
constexpr double kAllowed = 1;
/// Cosine of the angle at a facet above which a fold is sharp: less than 120 degrees.
constexpr double kSharpFold = -0.5;
/// Neighbors joined by edges for the widest choice of candidates where there is no
/// ambient Delaunay triangulation.
constexpr int kNeighborsPerDim = 4;
/// Openings of which more are to be expected by chance are not worth a mention.
constexpr double kMostExpected = 1;
/// Samples of a small part are no farther from each other, in median scales.
constexpr double kPartReach = 2;
/// What is opened shows more around it; rounds of that.
constexpr int kOpeningRounds = 3;
/// More cliques than this for each sample around what is open are too many to choose from.
constexpr std::size_t kCliquesPerSample = 500;
/// Edges from what stays open within which cavities are filled again.
constexpr int kRings = 2;

class ManifoldBuilder {
 public:
  ManifoldBuilder(const Samples& samples, const Neighborhoods& neighborhoods,
                  const TangentSpaces& tangents, LocalRegions regions,
                  const ManifoldOptions& options, const ProgramSolver& solver,
                  const Execution& execution)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        tangents_(tangents),
        regions_(std::move(regions)),
        options_(options),
        solver_(solver),
        execution_(execution),
        dim_(regions_.dim),
        arity_(regions_.dim + 1),
        scales_(local_scales(samples, neighborhoods, regions_.dim, execution)),
        ruler_(samples, scales_),
        price_([this](const Index* facet) { return price_of(facet); }) {
    if (samples.whole() != nullptr) {
      options_.chain.orientable = samples.whole()->orientable;
    }
    const std::vector<std::uint8_t>& marked = options_.boundary_samples;
    if (options_.boundary == BoundaryRule::kGiven &&
        std::find(marked.begin(), marked.end(), 1) == marked.end()) {
      options_.boundary = BoundaryRule::kNone;
    }
    by_evidence_ =
        options_.hole_radius == 0 && options_.boundary == BoundaryRule::kAuto;
    if (options_.hole_radius == 0) {
      const double even = evenness(samples, neighborhoods, scales_, dim_, execution);
      options_.hole_radius =
          (kRandomHoleRadius + even * (kEvenHoleRadius - kRandomHoleRadius)) *
          hole_radius_share(dim_);
    }
    if (options_.boundary != BoundaryRule::kNone) {
      options_.fixed_radius =
          std::min(options_.fixed_radius, options_.hole_share * options_.hole_radius);
    }
    result_.report.hole_radius = options_.hole_radius;
    std::vector<double> scales = scales_;
    if (!scales.empty()) {
      const auto middle = scales.begin() + static_cast<Offset>(scales.size() / 2);
      std::nth_element(scales.begin(), middle, scales.end());
      median_scale_ = *middle;
      result_.report.hole_size = options_.hole_radius * median_scale_;
    }
  }

  ManifoldComplex run() {
    fix_agreed();
    find_unsettled();
    pool_ = disputed_;
    pool_.vertices.insert(pool_.vertices.end(), large_.vertices.begin(),
                          large_.vertices.end());
    // Each time with more candidates, for what is still open.
    const Index refill = std::exchange(options_.chain.refill, 0);
    fill(false);
    options_.chain.refill = refill;
    options_.chain.search_oriented = true;
    for (int widening = 0; widening < 2 && !open_region_.empty(); ++widening) {
      if (widening == 1) {
        result_.open_region = open_region_;
      }
      widen(widening);
      fill(widening == 1);
    }
    finish();
    return std::move(result_);
  }

 private:
  /// Splits the simplices of the stars into fixed_, disputed_ and large_.
  void fix_agreed() {
    StarSimplices stars = count_votes(regions_, execution_);
    const std::size_t freed =
        regions_.stars.size() + regions_.edge_sets.indices.size() * sizeof(Index);
    std::vector<std::uint8_t>().swap(regions_.stars);  // they have voted
    std::vector<Offset>().swap(regions_.star_starts);
    regions_.edge_sets = {};
    const Offset count = stars.simplices.size();
    enum : std::uint8_t { kFixed, kLarge, kDisputed, kDropped };
    std::vector<std::uint8_t> kind(count, kDropped);
    std::vector<float> radii = relative_radii(stars.simplices);
    if (stretch_scales(stars, radii)) {
      radii = relative_radii(stars.simplices);
    }
    detail::for_each_block_uncounted(
        count, kBlock, execution_, [&](Offset begin, Offset end) {
          for (Offset s = begin; s < end; ++s) {
            const float radius = radii[s];
            if (stars.agreed(s) && radius <= options_.fixed_radius) {
              kind[s] = kFixed;
            } else if (radius <= options_.largest_radius) {
              kind[s] = stars.agreed(s) ? kLarge : kDisputed;
            }
          }
        });
    fixed_.arity = disputed_.arity = large_.arity = pool_.arity = arity_;
    fixed_.vertices.reserve(std::count(kind.begin(), kind.end(), kFixed) * arity_);
    result_.report.disputed.arity = arity_;
    for (Offset s = 0; s < count; ++s) {
      const Index* simplex = stars.simplices[s];
      result_.report.agreed += stars.agreed(s) ? 1 : 0;
      if (!stars.agreed(s)) {
        detail::append_row(result_.report.disputed, simplex);
      }
      if (kind[s] != kDropped) {
        detail::append_row(kind[s] == kFixed   ? fixed_
                           : kind[s] == kLarge ? large_
                                               : disputed_,
                           simplex);
      }
    }
    stars = {};
    detail::give_back_memory(freed + count * arity_ * sizeof(Index));
    if (has_few_facets(fixed_)) {
      free_small_patches<std::int32_t>();
    } else {
      free_small_patches<FacetNumber>();
    }
  }

  /// Circumradii over the local scale.
  std::vector<float> relative_radii(const SimplexArray& simplices) const {
    std::vector<float> radii(simplices.size());
    detail::for_each_block_uncounted(
        simplices.size(), kBlock, execution_, [&](Offset begin, Offset end) {
          for (Offset s = begin; s < end; ++s) {
            radii[s] =
                static_cast<float>(ruler_.measure(simplices[s], arity_).circumradius /
                                   ruler_.scale(simplices[s], arity_));
          }
        });
    return radii;
  }

  /// Where the nearest neighbors do not tell the spacing; whether there is such a place.
  bool stretch_scales(const StarSimplices& stars, const std::vector<float>& radii) {
    if (dim_ == 1) {
      return false;
    }
    stretch_ = detail::stretch_of_scales(stars, radii, samples_.size(), execution_);
    for (std::size_t x = 0; x < stretch_.size(); ++x) {
      scales_[x] *= stretch_[x];
      if (stretch_[x] != 1 && is_part()) {
        result_.part.stretched.push_back(static_cast<Index>(x));
      }
    }
    return !stretch_.empty();
  }

  /// Small patches have an orientation of their own, which may be wrong, and facets with
  /// more than two cofaces cannot stay.
  template <class Number>
  void free_small_patches() {
    const std::vector<Number> neighbors =
        facet_neighbors<Number>(fixed_, samples_.size(), execution_);
    std::vector<std::uint8_t> freed(fixed_.size(), 0);
    for (std::size_t f = 0; f < neighbors.size(); ++f) {
      if (neighbors[f] == kBranching) {
        freed[f / arity_] = 1;
      }
    }
    if (dim_ > 1) {
      patches_ = orient_patches(neighbors, arity_, execution_);
      const OrientedPatches& patches = patches_;
      const Offset largest =
          patches.sizes.empty()
              ? 0
              : *std::max_element(patches.sizes.begin(), patches.sizes.end());
      for (Offset s = 0; s < fixed_.size(); ++s) {
        const Offset size = patches.sizes[patches.patch[s]];
        if (size < options_.smallest_patch && (is_part() || size < largest)) {
          freed[s] = 1;
        }
      }
      const bool twisted =
          std::count(patches.orientable.begin(), patches.orientable.end(), 0) > 0;
      if (is_part()) {
        result_.part.agreed_orientable = !twisted;
        list_sharp_folds(neighbors);
      } else if (twisted) {
        free_twisted_folds(neighbors, freed);
      }
    }
    for (Offset s = 0; s < fixed_.size(); ++s) {
      if (freed[s] != 0) {
        detail::append_row(disputed_, fixed_[s]);
        // Not as part of a patch that goes as a whole.
        split_ = split_ || dim_ == 1 ||
                 patches_.sizes[patches_.patch[s]] >= options_.smallest_patch;
      }
    }
    Offset kept = 0;
    for (Offset s = 0; dim_ > 1 && s < fixed_.size(); ++s) {
      if (freed[s] == 0) {
        patches_.patch[kept] = patches_.patch[s];
        patches_.sign[kept] = patches_.sign[s];
        ++kept;
      }
    }
    detail::erase_rows(fixed_, freed);
    num_agreed_ = fixed_.size();
  }

  /// Those of a whole without orientation, whose loops a part does not see.
  template <class Number>
  void list_sharp_folds(const std::vector<Number>& neighbors) {
    if (samples_.whole()->orientable) {
      return;
    }
    std::vector<Index> facet(dim_);
    std::vector<Index>& listed = result_.part.sharp_folds;
    for (std::size_t i = 0; i < neighbors.size(); ++i) {
      const auto a = static_cast<FacetNumber>(i);
      const FacetNumber b = neighbors[i];
      if (b > a) {
        copy_facet(fixed_, a, facet.data());
        if (ruler_.fold(facet.data(), dim_, fixed_[a / arity_][a % arity_],
                        fixed_[b / arity_][b % arity_]) > kSharpFold) {
          listed.insert(listed.end(), facet.begin(), facet.end());
        }
      }
    }
    detail::sort_unique(listed);
  }

  /// Where a patch has no orientation because of a sharp fold, its simplices there are not
  /// to be believed: orients facet by facet, the flattest first, and frees both simplices
  /// at sharp folds that contradict.
  template <class Number>
  void free_twisted_folds(const std::vector<Number>& neighbors,
                          std::vector<std::uint8_t>& freed) {
    struct Crossing {
      double fold;
      FacetNumber a, b;
      bool operator<(const Crossing& other) const {
        return fold != other.fold ? fold < other.fold : a < other.a;
      }
    };
    std::vector<Crossing> crossings;
    std::vector<Index> facet(dim_);
    for (std::size_t i = 0; i < neighbors.size(); ++i) {
      const auto a = static_cast<FacetNumber>(i);
      const FacetNumber b = neighbors[i];
      if (b <= a || patches_.orientable[patches_.patch[a / arity_]] != 0) {
        continue;
      }
      copy_facet(fixed_, a, facet.data());
      crossings.push_back(
          {ruler_.fold(facet.data(), dim_, fixed_[a / arity_][a % arity_],
                       fixed_[b / arity_][b % arity_]),
           a, b});
    }
    std::sort(crossings.begin(), crossings.end());
    detail::SignedSets<Offset> sets(fixed_.size());
    bool changed = false;
    for (const Crossing& crossing : crossings) {
      const Offset s = crossing.a / arity_;
      const Offset t = crossing.b / arity_;
      const int product = flips_across(crossing.a, crossing.b, arity_) ? -1 : 1;
      if (!sets.join(s, t, product) && crossing.fold > kSharpFold) {
        freed[s] = freed[t] = 1;
        changed = true;
      }
    }
    if (changed) {
      SimplexArray kept = fixed_;
      detail::erase_rows(kept, freed);
      const OrientedPatches again = orient_patches(kept, samples_.size(), execution_);
      Offset next = 0;
      for (Offset s = 0; s < fixed_.size(); ++s) {
        if (freed[s] == 0) {
          patches_.patch[s] = again.patch[next];
          patches_.sign[s] = again.sign[next];
          ++next;
        }
      }
      patches_.sizes = again.sizes;
      patches_.orientable = again.orientable;
    }
  }

  /// A sample whose star is all fixed has no open facet, nor room for a candidate.
  void find_unsettled() {
    const auto n = static_cast<std::size_t>(samples_.size());
    std::vector<Offset> fixed_cofaces(n, 0);
    for (const Index v : fixed_.vertices) {
      ++fixed_cofaces[v];
    }
    unsettled_.assign(n, 0);
    for (Index x = 0; x < samples_.size(); ++x) {
      const bool whole =
          tangents_.boundary[x] == 0 && std::isfinite(regions_.squared_radii[x]) &&
          fixed_cofaces[x] == regions_.star_offsets[x + 1] - regions_.star_offsets[x];
      unsettled_[x] = whole ? 0 : 1;
    }
    regions_ = {};
  }

  /// Fills the cavities from the pool. What stays open is left for the next time, with
  /// what is near, unless this is the last.
  void fill(bool last) {
    const auto [near, cavities, chain] =
        fill_from_pool(fixed_, unsettled_, options_.boundary == BoundaryRule::kNone);

    // What stays open is up for choice again, with what is near.
    std::vector<std::uint8_t> open_again(cavities.energies.size(), 0);
    pool_.vertices.clear();
    open_region_.clear();
    if (!chain.open_facets.empty()) {
      const std::vector<std::uint8_t> around = samples_near_open(near, cavities, chain);
      for (Index c = 0; c < cavities.count(); ++c) {
        for (Offset i = 0; chain.open[c] != 0 && i < cavities.candidates_in.size(c);
             ++i) {
          const Index number = cavities.candidates_in.begin(c)[i];
          const Index* simplex = cavities.candidates[number];
          if (std::all_of(simplex, simplex + arity_,
                          [&](Index v) { return around[v] != 0; })) {
            open_again[number] = 1;
            detail::append_row(pool_, simplex);
            open_region_.insert(open_region_.end(), simplex, simplex + arity_);
          }
        }
      }
    }
    std::vector<Index> facet(dim_);
    for (const FacetNumber f : cavities.dead_ends) {
      copy_facet(near, f, facet.data());
      open_region_.insert(open_region_.end(), facet.begin(), facet.end());
    }
    detail::sort_unique(open_region_);
    fixed_.vertices.reserve(fixed_.vertices.size() + chain.chosen.size() * arity_);
    for (const Index c : chain.chosen) {
      if (last || open_again[c] == 0) {
        detail::append_row(fixed_, cavities.candidates[c]);
      }
    }
  }

  struct Filling {
    SimplexArray near;  ///< fixed simplices around the cavities
    Cavities cavities;
    ChainFill chain;
  };
  /// Fills what the fixed simplices leave inside with candidates of the pool.
  Filling fill_from_pool(const SimplexArray& fixed,
                         const std::vector<std::uint8_t>& inside, bool fold_back) {
    const std::vector<Offset> numbers =
        detail::rows_near(fixed, inside, dim_, execution_);
    Filling filling;
    filling.near = detail::select_rows(fixed, numbers);
    filling.cavities = find_cavities(filling.near, inside, pool_, ruler_, price_,
                                     fold_back, execution_);
    for (FacetNumber& rim : filling.cavities.rims) {
      if (rim != kOpen) {
        rim = numbers[rim / arity_] * arity_ + rim % arity_;
      }
    }
    filling.chain = fill_cavities(filling.cavities, fixed, samples_.size(),
                                  options_.chain, solver_, execution_);
    count_programs(filling.cavities, filling.chain);
    return filling;
  }

  void count_programs(const Cavities& cavities, const ChainFill& chain) {
    ManifoldReport& report = result_.report;
    report.cavities += cavities.count();
    report.cut += chain.cut;
    report.programs += chain.programs;
    report.integer_programs += chain.integer_programs;
    report.largest_program = std::max(report.largest_program, chain.largest_program);
    report.unsolved += chain.unsolved;
  }

  /// Within kRings edges of a facet that stays open, and samples in no simplex there.
  std::vector<std::uint8_t> samples_near_open(const SimplexArray& near,
                                              const Cavities& cavities,
                                              const ChainFill& chain) const {
    SimplexArray simplices = near;
    for (const Index c : chain.chosen) {
      detail::append_row(simplices, cavities.candidates[c]);
    }
    std::vector<std::uint8_t> marked(samples_.size(), 0);
    for (const Index f : chain.open_facets) {
      for (int i = 0; i < dim_; ++i) {
        marked[cavities.facets[f][i]] = 1;
      }
    }
    const auto any_marked = [&](const std::vector<std::uint8_t>& of, const Index* row) {
      return std::any_of(row, row + arity_, [&](Index v) { return of[v] != 0; });
    };
    for (int ring = 0; ring < kRings; ++ring) {
      const std::vector<std::uint8_t> before = marked;
      for (Offset s = 0; s < simplices.size(); ++s) {
        const bool reached = any_marked(before, simplices[s]);
        for (int i = 0; i < arity_; ++i) {
          marked[simplices[s][i]] |= static_cast<std::uint8_t>(reached);
        }
      }
    }
    std::vector<std::uint8_t> covered(samples_.size(), 0);
    for (const Index v : simplices.vertices) {
      covered[v] = 1;
    }
    const std::vector<std::uint8_t> reached = marked;
    for (Offset s = 0; s < cavities.candidates.size(); ++s) {
      if (any_marked(reached, cavities.candidates[s])) {
        for (int i = 0; i < arity_; ++i) {
          const Index v = cavities.candidates[s][i];
          marked[v] |= static_cast<std::uint8_t>(covered[v] == 0);
        }
      }
    }
    return marked;
  }

  /// What was opened by evidence stays open where it is wider than gaps of even samples.
  double price_of(const Index* facet) {
    const double size = ruler_.facet_size(facet, dim_);
    const bool opened =
        !opened_.empty() &&
        std::all_of(facet, facet + dim_, [&](Index v) { return opened_[v] != 0; });
    if (opened || options_.boundary == BoundaryRule::kAuto) {
      return size *
             open_price(dim_, opened ? std::min(kEvenHoleRadius, options_.hole_radius)
                                     : options_.hole_radius);
    }
    const bool allowed = options_.boundary == BoundaryRule::kGiven &&
                         std::all_of(facet, facet + dim_, [&](Index v) {
                           return options_.boundary_samples[v] != 0;
                         });
    return size * (allowed ? kAllowed : kForbidden);
  }

  /// More candidates around what is open: first all cliques of the edges that some star
  /// has, then the ambient Delaunay triangulation or, where there is none, all cliques of
  /// near neighbors.
  void widen(int step) {
    std::vector<std::uint8_t> marked(samples_.size(), 0);
    for (const Index v : open_region_) {
      marked[v] = 1;
    }
    SimplexArray more{arity_, {}};
    const std::size_t axes = samples_.varying_axes().size();
    if (step == 1 && (axes == 2 || axes == 3)) {
      const bool known = options_.open_region.has_value();
      more = detail::delaunay_faces(
          samples_, known ? options_.open_region->here : open_region_,
          known ? options_.open_region->elsewhere : std::vector<double>{}, dim_);
    } else {
      const std::size_t most = kCliquesPerSample * open_region_.size();
      std::vector<Index> pairs;
      for (const SimplexArray* simplices : {&fixed_, &disputed_, &large_}) {
        detail::append_edges(*simplices, marked, pairs);
      }
      if (step == 1) {
        detail::append_neighbor_edges(neighborhoods_, kNeighborsPerDim * dim_,
                                      open_region_, marked, pairs);
      }
      more = detail::cliques_of(pairs, dim_, most, execution_);
    }
    for (Offset s = 0; s < more.size(); ++s) {
      const Index* simplex = more[s];
      if (ruler_.measure(simplex, arity_).circumradius <=
          options_.largest_radius * ruler_.scale(simplex, arity_)) {
        detail::append_row(pool_, simplex);
      }
    }
    for (const Index v : open_region_) {
      unsettled_[v] = 1;
    }
  }

  void finish() {
    ManifoldReport& report = result_.report;
    result_.simplices = detail::sorted_unique(fixed_, execution_);
    if (dim_ == 1) {
      repair_curves(samples_, neighborhoods_, scales_, price_, options_.smallest_loop,
                    result_.simplices, execution_);
    }
    mend();
    if (options_.among_clutter && level()) {
      mend();
    }
    for (int round = 0; round < kOpeningRounds; ++round) {
      if (is_part()) {
        list_unmended();
      }
      const bool found = open_by_evidence(round);
      const int rounds = is_part() ? samples_.whole()->opening_rounds : -1;
      if (!(rounds < 0 ? found : round < rounds)) {
        break;
      }
      mend();
    }
    settle_openings();
    list_parts();
    unsettle_changed();
    list_filled();
    // Around what was inserted, links have changed as well.
    report.singular =
        singular_vertices(result_.simplices, next_to(unsettled_), execution_);
    list_unpaired();
    orient_result();
  }

  /// Where mend() would change something once more: at broken links next to what it has put
  /// back itself.
  void list_unmended() {
    result_.part.unmended.push_back(
        singular_vertices(result_.simplices, next_to(changed_), execution_));
  }

  bool is_part() const { return samples_.whole() != nullptr; }

  /// Samples that are not unsettled have whole stars.
  void list_unpaired() {
    const SimplexArray touched = detail::select_rows(
        result_.simplices,
        detail::rows_near(result_.simplices, unsettled_, 1, execution_));
    UnpairedFacets unpaired = unpaired_facets(touched, unsettled_, execution_);
    result_.report.open_facets = std::move(unpaired.open);
    result_.report.branching_facets = std::move(unpaired.branching);
  }

  /// Links, and samples that were left out: at first wherever something is unsettled, then
  /// next to what changed since.
  void mend() {
    ManifoldReport& report = result_.report;
    const std::vector<Index> cut = repair_links(
        samples_, scales_, changed_.empty() ? unsettled_ : next_to(changed_), price_,
        result_.simplices, execution_);
    report.cut_vertices.insert(report.cut_vertices.end(), cut.begin(), cut.end());
    detail::sort_unique(report.cut_vertices);
    for (const Index v : cut) {
      unsettled_[v] = 1;
    }
    Insertion insertion =
        insert_vertices(samples_, neighborhoods_, scales_, options_.outlier_distance,
                        levelled_, result_.simplices, execution_);
    changed_.assign(samples_.size(), 0);
    for (const Index v : insertion.inserted) {
      changed_[v] = 1;
    }
    changed_ = next_to(changed_);
    report.inserted.insert(report.inserted.end(), insertion.inserted.begin(),
                           insertion.inserted.end());
    detail::sort_unique(report.inserted);
    report.outliers = std::move(insertion.outliers);
    // Some of an earlier round may have been taken out since.
    std::vector<Index> still;
    std::set_difference(report.inserted.begin(), report.inserted.end(),
                        report.outliers.begin(), report.outliers.end(),
                        std::back_inserter(still));
    report.inserted = std::move(still);
  }

  /// Where there is clutter, some of it lies so near that it was not told from the
  /// manifold.
  /// \returns whether anything was taken out
  bool level() {
    const SimplexArray before = result_.simplices;
    levelled_ = level_spikes(samples_, scales_, result_.simplices, execution_);
    for (Offset s = 0; s < before.size() && !levelled_.empty(); ++s) {
      if (std::any_of(before[s], before[s] + arity_, [&](Index v) {
            return std::binary_search(levelled_.begin(), levelled_.end(), v);
          })) {
        mark(before[s], unsettled_);
        mark(before[s], changed_);
      }
    }
    return !levelled_.empty();
  }

  /// Marked samples and those that share a simplex with one.
  std::vector<std::uint8_t> next_to(const std::vector<std::uint8_t>& marked) const {
    std::vector<std::uint8_t> result = marked;
    for (const Offset s : detail::rows_near(result_.simplices, marked, 1, execution_)) {
      mark(result_.simplices[s], result);
    }
    return result;
  }

  void mark(const Index* simplex, std::vector<std::uint8_t>& samples) const {
    for (int i = 0; i < arity_; ++i) {
      samples[simplex[i]] = 1;
    }
  }

  /// Takes out what bridges openings that chance does not explain; where another rule
  /// decides they are only listed.
  /// \returns whether there are any
  bool open_by_evidence(int round) {
    detail::WeighedOpenings found = detail::weigh_openings(
        samples_, neighborhoods_, scales_, stretch_, result_.simplices,
        {by_evidence_ ? options_.significance : 0, kMostExpected, options_.decisions},
        execution_);
    list_openings(std::move(found.openings));
    keep_certain(found.bridges);
    if (is_part()) {
      std::vector<Index>& opened = result_.part.opened.emplace_back();
      for (const Offset s : found.bridges) {
        opened.insert(opened.end(), result_.simplices[s],
                      result_.simplices[s] + arity_);
      }
      detail::sort_unique(opened);
      const int rounds = samples_.whole()->opening_rounds;
      if (rounds >= 0 && round >= rounds) {
        return false;  // nothing more is opened in the whole
      }
    }
    if (found.bridges.empty()) {
      return false;
    }
    opened_.resize(samples_.size(), 0);
    std::vector<std::uint8_t> marked(result_.simplices.size(), 0);
    for (const Offset s : found.bridges) {
      marked[s] = 1;
      mark(result_.simplices[s], opened_);
      mark(result_.simplices[s], unsettled_);
      mark(result_.simplices[s], changed_);
    }
    pool_ = detail::select_rows(result_.simplices, found.bridges);
    detail::erase_rows(result_.simplices, marked);
    split_ = true;
    if (dim_ > 1) {
      fill_opened();
    }
    return true;
  }

  /// Next to a bridge, what would be fixed with a hole_radius of kEvenHoleRadius stays: a
  /// cluster reaches into the manifold where that is sampled thinly.
  void keep_certain(std::vector<Offset>& bridges) {
    if (bridges.empty() || dim_ == 1) {
      return;
    }
    const double certain = options_.hole_share * kEvenHoleRadius;
    SimplexArray agreed = fixed_;
    agreed.vertices.resize(static_cast<std::size_t>(num_agreed_) * arity_);
    bridges.erase(
        std::remove_if(bridges.begin(), bridges.end(),
                       [&](Offset s) {
                         const Index* simplex = result_.simplices[s];
                         return ruler_.measure(simplex, arity_).circumradius <=
                                    certain * ruler_.scale(simplex, arity_) &&
                                detail::find_row(agreed, simplex) >= 0;
                       }),
        bridges.end());
  }

  /// Samples in no simplex that are next to each other, about as dense as the others: too
  /// few for a manifold of their own, and too far from all others to be part of theirs.
  void list_parts() {
    const std::vector<Index>& unused = result_.report.outliers;
    const double reach = kPartReach * median_scale_;
    std::vector<Index> number(samples_.size(), -1);
    for (std::size_t i = 0; i < unused.size(); ++i) {
      number[unused[i]] = static_cast<Index>(i);
    }
    detail::DisjointSets sets(static_cast<Offset>(unused.size()));
    const Index near = std::min<Index>(arity_, neighborhoods_.count);
    for (const Index x : unused) {
      for (Index k = 0; k < near; ++k) {
        const Index y = neighborhoods_.of(x)[k];
        if (number[y] >= 0 && samples_.squared_distance(x, y) <= reach * reach) {
          sets.join(number[x], number[y]);
        }
      }
    }
    std::vector<Index> part_of(unused.size(), -1);
    std::vector<Opening> parts;
    for (std::size_t i = 0; i < unused.size(); ++i) {
      const Offset root = sets.find(static_cast<Offset>(i));
      if (part_of[root] < 0) {
        part_of[root] = static_cast<Index>(parts.size());
        parts.emplace_back();
      }
      Opening& part = parts[part_of[root]];
      part.samples.push_back(unused[i]);
      if (near > 0) {
        part.spacing += std::sqrt(
            samples_.squared_distance(unused[i], neighborhoods_.of(unused[i])[0]));
      }
    }
    for (Opening& part : parts) {
      if (static_cast<int>(part.samples.size()) > arity_) {
        part.kind = OpeningKind::kPart;
        part.open = true;
        part.spacing /= static_cast<double>(part.samples.size());
        std::sort(part.samples.begin(), part.samples.end());
        result_.report.openings.push_back(std::move(part));
      }
    }
  }

  /// What was opened in earlier rounds, and all of this one.
  void list_openings(std::vector<Opening> found) {
    std::vector<Opening>& openings = result_.report.openings;
    openings.erase(std::remove_if(openings.begin(), openings.end(),
                                  [](const Opening& opening) { return !opening.open; }),
                   openings.end());
    openings.insert(openings.end(), std::make_move_iterator(found.begin()),
                    std::make_move_iterator(found.end()));
  }

  /// What was opened and was filled again, every simplex of it, is closed after all; what
  /// several rounds found in vain is listed once.
  void settle_openings() {
    std::set<std::vector<Index>> filled;
    const auto is_there_again = [&](const SimplexArray& simplices) {
      for (Offset s = 0; s < simplices.size(); ++s) {
        if (detail::find_row(result_.simplices, simplices[s]) < 0) {
          return false;
        }
      }
      return simplices.size() > 0;
    };
    std::vector<Opening> settled;
    for (Opening& opening : result_.report.openings) {
      if (opening.open && is_there_again(opening.simplices)) {
        opening.open = false;
        if (!filled.insert(opening.simplices.vertices).second) {
          continue;
        }
      }
      settled.push_back(std::move(opening));
    }
    result_.report.openings = std::move(settled);
  }

  /// Between the opened samples only what is small is filled again: what else ties samples
  /// together that the bridge did.
  void fill_opened() {
    for (const SimplexArray* simplices : {&disputed_, &large_}) {
      for (const Offset s :
           detail::rows_near(*simplices, opened_, arity_, execution_)) {
        detail::append_row(pool_, (*simplices)[s]);
      }
    }
    const auto [near, cavities, chain] =
        fill_from_pool(result_.simplices, opened_, false);
    for (const Index c : chain.chosen) {
      detail::append_row(result_.simplices, cavities.candidates[c]);
      mark(cavities.candidates[c], changed_);
    }
    result_.simplices = detail::sorted_unique(result_.simplices, execution_);
  }

  /// Repairs reach beyond the samples that were unsettled.
  void unsettle_changed() {
    Offset a = 0;  // agreed simplices are sorted as well
    for (Offset s = 0; s < result_.simplices.size(); ++s) {
      const Index* simplex = result_.simplices[s];
      for (; a < num_agreed_ && detail::row_less(fixed_[a], simplex, arity_); ++a) {
        mark(fixed_[a], unsettled_);
      }
      if (a < num_agreed_ && detail::row_equal(fixed_[a], simplex, arity_)) {
        ++a;
      } else {
        mark(simplex, unsettled_);
      }
    }
    for (; a < num_agreed_; ++a) {
      mark(fixed_[a], unsettled_);
    }
  }

  /// The patches of the agreed simplices stay connected as long as all are there.
  void orient_result() {
    std::optional<OrientedPatches> patches;
    if (dim_ > 1 && !split_ && result_.report.branching_facets.size() == 0) {
      patches = extend_patches(fixed_, num_agreed_, patches_, result_.simplices,
                               unsettled_, execution_);
    }
    result_.patches =
        patches ? std::move(*patches)
                : orient_patches(result_.simplices, samples_.size(), execution_);
  }

  /// What is not among the agreed simplices; those with a settled vertex are.
  void list_filled() {
    std::vector<Offset> rows =
        detail::rows_near(fixed_, unsettled_, arity_, execution_);
    rows.erase(std::lower_bound(rows.begin(), rows.end(), num_agreed_), rows.end());
    const SimplexArray agreed =
        detail::sorted_unique(detail::select_rows(fixed_, rows));
    SimplexArray& filled = result_.report.filled;
    filled.arity = arity_;
    for (const Offset s :
         detail::rows_near(result_.simplices, unsettled_, arity_, execution_)) {
      const Index* simplex = result_.simplices[s];
      if (detail::find_row(agreed, simplex) < 0) {
        detail::append_row(filled, simplex);
      }
    }
  }

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  const TangentSpaces& tangents_;
  LocalRegions regions_;
  ManifoldOptions options_;
  const ProgramSolver& solver_;
  const Execution& execution_;
  int dim_;
  int arity_;
  std::vector<double> scales_;
  double median_scale_ = 0;
  std::vector<double> stretch_;  // that they hold, of each sample; empty: 1
  SimplexRuler ruler_;
  bool by_evidence_ = false;
  FacetPrice price_;  // of leaving a facet open

  OrientedPatches patches_;  // of the agreed simplices
  bool split_ = false;       // one of these patches may have come apart
  SimplexArray fixed_;       // agreed simplices, then those chosen
  SimplexArray disputed_;    // simplices of some stars
  SimplexArray large_;       // agreed on, but large
  SimplexArray pool_;        // candidates
  Offset num_agreed_ = 0;
  std::vector<std::uint8_t> unsettled_;  // samples at which facets may be open
  std::vector<std::uint8_t> opened_;     // samples at openings by evidence; or empty
  std::vector<std::uint8_t>
      changed_;                     // samples at what changed since links were mended
  std::vector<Index> open_region_;  // samples around what stayed open, ascending
  std::vector<Index> levelled_;     // samples that were spikes
  ManifoldComplex result_;
};

}  // namespace

double open_price(int dim, double hole_radius) {
  return 2.0 * (dim + 1) / dim * hole_radius * hole_radius * hole_radius;
}

ManifoldComplex build_manifold(const Samples& samples,
                               const Neighborhoods& neighborhoods,
                               const TangentSpaces& tangents, LocalRegions regions,
                               const ManifoldOptions& options,
                               const ProgramSolver& solver,
                               const Execution& execution) {
  ManifoldComplex complex =
      ManifoldBuilder(samples, neighborhoods, tangents, std::move(regions), options,
                      solver, execution)
          .run();
  detail::assert_that(
      [&] { verify_manifold_complex(complex, samples.size(), execution); });
  return complex;
}

}  // namespace remanifold
