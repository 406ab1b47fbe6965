// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/outliers.hpp"

#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "local/local_coordinates.hpp"
#include "local/parabola.hpp"
#include "local/quadratic_fit.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace remanifold {
namespace {

constexpr Offset kBlock = 1024;
constexpr Index kFewestVotes = 15;
/// Share of the votes that is passed over: the quadrics of some neighbors miss what lies
/// behind a crease, but at a corner of three sides there is still a third on each.
constexpr double kQuantile = 0.25;
/// So many radii of its neighborhood away, a quadric says nothing.
constexpr double kBeyond = 8;
constexpr double kMedianScales = 2;
constexpr double kNoiseQuantile = 0.75;
constexpr double kNoiseFactor = 8;
/// Outliers far from everything are each other's neighbors. There they are sparse, this
/// many times the median scale, and no quadrics agree on where they are: on average over
/// the neighbors, distances in units of the local scale reach this, and this many times
/// that of all samples.
constexpr double kSparse = kSparseScale;
constexpr double kScattered = 0.25;
constexpr double kScatteredFactor = 2;
/// Of those that are left when most have gone, on average over all that are next to each
/// other. (Coarse parts of uneven samplings: 0.1. Left of clutter: 0.2.)
constexpr double kLeftOver = 0.15;
/// So many times the median scale: no surface is as unevenly sampled as that.
constexpr double kVerySparse = 10;
/// Where samples are sparse, an outlier is at least this many of the scales there away.
constexpr double kLocalScales = 0.75;
/// Where coarse sampling is all there is to it, few of the sparse samples are like that.
constexpr std::size_t kScatteredShare = 3;
/// Samples that stand for all others.
constexpr Index kProbes = 300;
/// More sparse samples than this are looked at only where some of them are scattered.
constexpr std::size_t kManySparse = 2000;
constexpr Index kSparseStride = 16;
constexpr int kMostRounds = 20;
/// Clutter: see Outliers.
constexpr double kFarther = 2;
constexpr std::size_t kFewestFar = 5;
constexpr std::size_t kFarShare = 3;
/// Samples lie along a curve, and no clump beside others, where no step between them is
/// longer than this share of all.
constexpr double kLongStep = 0.5;
/// Neighbors among which one across the curve is looked for.
constexpr Index kMostAcross = 512;

template <class T>
T quantile(std::vector<T> values, double share) {
  const auto at = values.begin() +
                  static_cast<Offset>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The median, of an even number the upper one. Reorders the values.
double middle_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<Offset>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class OutlierFinder {
 public:
  OutlierFinder(const Samples& samples, const NeighborSearch& search,
                const Neighborhoods& neighborhoods, const OutlierOptions& options,
                const Execution& execution)
      : samples_(samples),
        search_(search),
        neighborhoods_(neighborhoods),
        options_(options),
        execution_(execution),
        near_count_(outlier_scale_neighbors(options.dim)),
        vote_count_(outlier_votes(options.dim, samples.whole_size())),
        out_(samples.size(), kIn),
        known_(samples.size()),
        known_in_(samples.size(), kNever),
        apart_(samples.size()),
        reach_(samples.size()),
        scales_(samples.size()),
        wide_(samples.size()) {}

  ~OutlierFinder() {
    for (std::atomic<Wide*>& slot : wide_) {
      for (const Wide* wide = slot.load(); wide != nullptr;) {
        delete std::exchange(wide, wide->before);
      }
    }
  }
  OutlierFinder(const OutlierFinder&) = delete;
  OutlierFinder& operator=(const OutlierFinder&) = delete;

  Outliers run() {
    Outliers result;
    std::vector<Index>& outliers = result.samples;
    if (vote_count_ <= near_count_) {
      return result;
    }
    measure_all();
    for (round_ = 0; round_ < kMostRounds; ++round_) {
      const std::vector<Index> found = find();
      if (found.empty()) {
        break;
      }
      outliers.insert(outliers.end(), found.begin(), found.end());
      for (const Index x : found) {
        out_[x] = static_cast<std::int8_t>(round_);
      }
      measure_all();
    }
    std::sort(outliers.begin(), outliers.end());
    result.are_clutter = are_clutter(outliers);
    return result;
  }

  /// What the first round of run() asks about some samples, whatever is found elsewhere.
  OutlierEvidence evidence(const OutlierQuestions& asked) {
    OutlierEvidence result;
    measure_all();
    median_scale_ = asked.median_scale;
    Scratch scratch;
    std::vector<Unit> units;
    for (const Index x : asked.apart) {
      const double local = median_around(x, vote_count_, scales_, scratch);
      units.push_back({local, std::min(local, kMedianScales * median_scale_)});
    }
    std::vector<Index> apart = asked.apart;
    keep_beside_curves(apart, units);
    const std::vector<double> values = distances(apart);
    for (std::size_t i = 0; i < apart.size(); ++i) {
      const double away = std::min(values[i], apart_[apart[i]]);
      if (away > kLocalScales * units[i].local) {
        result.away.push_back(away / units[i].capped);
      }
    }
    std::vector<double> own;
    probe(asked.probes, scratch, result.relative, own);
    for (const std::vector<Index>* some : {&asked.apart, &asked.probes}) {
      for (const Index x : *some) {
        result.reach = std::max(result.reach, reach_of(x, scratch));
      }
    }
    return result;
  }

 private:
  struct Scratch {
    std::unique_ptr<NeighborSearch::Query> query;
    std::vector<Neighbor> found;
    std::vector<Index> near;
    std::int8_t latest = kNever;  // round in which the last that is passed over went
    std::vector<double> values;
  };
  static constexpr std::int8_t kIn = -1;
  static constexpr std::int8_t kNever = -1;

  /// The nearest others that are no outliers, from the neighborhoods where these suffice.
  void nearest(Index x, Index count, Scratch& scratch) const {
    std::vector<Index>& near = scratch.near;
    const auto take = [&](Index y) {
      if (out_[y] == kIn) {
        near.push_back(y);
      } else {
        scratch.latest = std::max(scratch.latest, out_[y]);
      }
    };
    near.clear();
    scratch.latest = kNever;
    const Index* known = neighborhoods_.of(x);
    for (Index k = 0; k < neighborhoods_.count && as_index(near) < count; ++k) {
      take(known[k]);
    }
    if (as_index(near) >= count) {
      return;
    }
    Index asked = 2 * std::max(neighborhoods_.count, vote_count_);
    for (const Index all = samples_.size() - 1;; asked = std::max(2 * asked, count)) {
      near.clear();
      const std::vector<Index>& more = wide(x, std::min(asked, all), scratch);
      for (std::size_t k = 0; k < more.size() && as_index(near) < count; ++k) {
        take(more[k]);
      }
      if (as_index(near) >= count || as_index(more) >= all) {
        return;
      }
      asked = as_index(more);
    }
  }

  /// What a search has found, and with fewer before.
  struct Wide {
    std::vector<Index> samples;
    const Wide* before;
  };

  /// So many nearest others or more, each number searched for once.
  const std::vector<Index>& wide(Index x, Index count, Scratch& scratch) const {
    std::atomic<Wide*>& slot = wide_[x];
    Wide* known = slot.load(std::memory_order_acquire);
    if (known != nullptr && as_index(known->samples) >= count) {
      return known->samples;
    }
    if (!scratch.query) {
      scratch.query = search_.query(execution_);
    }
    scratch.query->nearest(x, count, std::numeric_limits<double>::infinity(),
                           scratch.found);
    auto found = std::make_unique<Wide>();
    found->before = known;
    found->samples.reserve(scratch.found.size());
    for (const Neighbor& neighbor : scratch.found) {
      found->samples.push_back(neighbor.index);
    }
    if (slot.compare_exchange_strong(known, found.get(), std::memory_order_acq_rel)) {
      return found.release()->samples;
    }
    return wide(x, count, scratch);  // another thread was faster
  }

  static Index as_index(const std::vector<Index>& values) {
    return static_cast<Index>(values.size());
  }

  double distance(Index a, Index b) const {
    return std::sqrt(samples_.squared_distance(a, b));
  }

  /// apart_: distance to the (K+1)-th neighbor; reach_: to the (2K+2)-th; scales_: median
  /// of reach_ around. Only where something changed.
  void measure_all() {
    const bool first = alive_.empty();
    if (first) {
      alive_.resize(samples_.size());
      for (Index x = 0; x < samples_.size(); ++x) {
        alive_[x] = x;
      }
    } else {
      alive_.erase(std::remove_if(alive_.begin(), alive_.end(),
                                  [&](Index x) { return out_[x] != kIn; }),
                   alive_.end());
    }
    detail::ThreadScratch<Scratch> scratches;
    const auto over_alive = [&](const auto& body) {
      detail::for_each_block_uncounted(static_cast<Offset>(alive_.size()), kBlock,
                                       execution_, [&](Offset begin, Offset end) {
                                         scratches.use([&](Scratch& scratch) {
                                           for (Offset i = begin; i < end; ++i) {
                                             body(alive_[i], scratch);
                                           }
                                         });
                                       });
    };
    over_alive([&](Index x, Scratch& scratch) {
      nearest(x, near_count_, scratch);
      const std::vector<Index>& near = scratch.near;
      apart_[x] =
          near.empty()
              ? 0
              : distance(x, near[std::min<std::size_t>(options_.dim, near.size() - 1)]);
      reach_[x] = near.empty() ? 0 : distance(x, near.back());
    });
    over_alive([&](Index x, Scratch& scratch) {
      scales_[x] = median_around(x, near_count_, reach_, scratch);
    });
    std::vector<double> all;
    all.reserve(alive_.size());
    for (const Index x : alive_) {
      all.push_back(scales_[x]);
    }
    median_scale_ = quantile(std::move(all), 0.5);
  }

  double median_around(Index x, Index count, const std::vector<double>& values,
                       Scratch& scratch) const {
    nearest(x, count, scratch);
    std::vector<double>& around = scratch.values;
    around.clear();
    if (out_[x] == kIn) {
      around.push_back(values[x]);
    }
    for (const Index y : scratch.near) {
      around.push_back(values[y]);
    }
    return middle_of(around);
  }

  /// The scale at x; where samples are dense along curves and sparse across them, the
  /// distance across: the next curve is no farther than it has to be.
  double scale_across(Index x, Scratch& scratch) const {
    if (options_.dim < 2) {
      return scales_[x];
    }
    nearest(x, kCurveNeighbors, scratch);
    if (as_index(scratch.near) < kCurveNeighbors) {
      return scales_[x];
    }
    std::array<Index, kCurveNeighbors + 1> places;
    places[0] = x;
    std::copy_n(scratch.near.begin(), kCurveNeighbors, places.begin() + 1);
    detail::Chord chord;
    const auto squared = [&](Index a, Index b) {
      return samples_.squared_distance(a, b);
    };
    if (!detail::lie_on_parabola(places, squared, chord) ||
        chord.largest_step > kLongStep) {
      return scales_[x];
    }
    const auto place = [&](Index y) {
      return (squared(chord.from, y) - squared(chord.to, y)) / (2 * chord.length);
    };
    const double here = place(x);
    const Index most = std::min(kMostAcross, as_index(alive_) - 1);
    for (Index count = std::min(2 * neighborhoods_.count, most);;
         count = std::min(2 * count, most)) {
      nearest(x, count, scratch);
      for (const Index y : scratch.near) {
        const double along = place(y) - here;
        if (squared(x, y) > 2 * along * along) {
          return std::max(scales_[x], distance(x, y));
        }
      }
      if (count == most) {
        return scales_[x];
      }
    }
  }

  /// As median_around(), of scales across.
  double median_across(Index x, Scratch& scratch) const {
    nearest(x, vote_count_, scratch);
    std::vector<Index> around = scratch.near;
    around.push_back(x);
    std::vector<double> values;
    for (const Index y : around) {
      values.push_back(scale_across(y, scratch));
    }
    return middle_of(values);
  }

  struct Unit {
    double local;
    double capped;
  };

  std::vector<Index> find() {
    Scratch scratch;
    std::vector<Index> apart;
    std::vector<Unit> units;
    std::vector<Index> sparse;
    for (const Index x : alive_) {
      // Cheap, and passes nearly all.
      if (apart_[x] > options_.distance * std::min(scales_[x] / 2, median_scale_)) {
        const double local = median_around(x, vote_count_, scales_, scratch);
        const Unit unit{local, std::min(local, kMedianScales * median_scale_)};
        if (apart_[x] > options_.distance * unit.capped) {
          apart.push_back(x);
          units.push_back(unit);
        }
      }
      if (scales_[x] > kSparse * median_scale_) {
        sparse.push_back(x);
      }
    }
    keep_beside_curves(apart, units);
    std::vector<Index> found;
    if (apart.empty() && sparse.empty()) {
      return found;
    }
    std::vector<Index> probes;
    const auto stride =
        static_cast<Index>(outlier_probe_stride(static_cast<Offset>(alive_.size())));
    for (Index i = 0; i < as_index(alive_); i += stride) {
      probes.push_back(alive_[i]);
    }
    std::vector<double> relative;
    std::vector<double> own;
    probe(probes, scratch, relative, own);
    const double least = least_outlier_distance(options_.distance, std::move(relative));

    const std::vector<double> values = distances(apart);
    for (std::size_t i = 0; i < apart.size(); ++i) {
      const double away = std::min(values[i], apart_[apart[i]]);
      if (away > least * units[i].capped && away > kLocalScales * units[i].local) {
        found.push_back(apart[i]);
      }
    }
    const double scattered =
        std::max(kScattered, kScatteredFactor * quantile(own, 0.5));
    if (scattered < 1) {
      if (sparse.size() > kManySparse) {
        std::vector<Index> some;
        for (std::size_t i = 0; i < sparse.size(); i += kSparseStride) {
          some.push_back(sparse[i]);
        }
        if (find_scattered(some, scattered).empty()) {
          sparse.clear();
        }
      }
      std::vector<Index> far = find_scattered(sparse, scattered);
      if (far.size() * kScatteredShare < sparse.size()) {
        far.clear();
        if (num_scattered_ > sparse.size()) {
          sparse.erase(
              std::remove_if(
                  sparse.begin(), sparse.end(),
                  [&](Index x) { return !(scales_[x] > kVerySparse * median_scale_); }),
              sparse.end());
          far = find_left_over(sparse);
        }
      }
      num_scattered_ += far.size();
      found.insert(found.end(), far.begin(), far.end());
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  bool are_clutter(const std::vector<Index>& outliers) const {
    Scratch scratch;
    std::size_t looked_at = 0;
    std::size_t far = 0;
    const std::size_t stride = 1 + outliers.size() / kProbes;
    for (std::size_t i = 0; i < outliers.size(); i += stride) {
      const Index x = outliers[i];
      const double scale = median_around(x, vote_count_, scales_, scratch);
      ++looked_at;
      if (!scratch.near.empty() &&
          distance(x, scratch.near[0]) > kFarther * options_.distance * scale) {
        ++far;
      }
    }
    return far >= kFewestFar && far * kFarShare >= looked_at;
  }

  /// Within which evidence() depends on others; infinite where samples lie along curves.
  double reach_of(Index x, Scratch& scratch) {
    nearest(x, vote_count_, scratch);
    std::vector<Index> voters = scratch.near;
    const double to_voters = distance(x, voters.back());
    voters.push_back(x);
    double from_voters = 0;
    for (const Index y : voters) {
      if (scale_across(y, scratch) > scales_[y]) {
        return std::numeric_limits<double>::infinity();
      }
      nearest(y, vote_count_, scratch);
      from_voters = std::max(from_voters, distance(y, scratch.near.back()));
    }
    return to_voters + 2 * from_voters;
  }

  /// Normal distances of samples that stand for all, in two units.
  void probe(const std::vector<Index>& probes, Scratch& scratch,
             std::vector<double>& relative, std::vector<double>& own) {
    const std::vector<double> typical = distances(probes);
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const double scale = scales_[probes[i]];
      own.push_back(std::min(1.0, typical[i] / scale));
      const double across = scale_across(probes[i], scratch);
      relative.push_back(
          typical[i] /
          (across > scale ? across : std::min(scale, kMedianScales * median_scale_)));
    }
  }

  /// Leaves those out that are no farther apart than the curves around on which samples
  /// are dense. What lies on a curve is no clutter: its scale needs no limit.
  void keep_beside_curves(std::vector<Index>& apart, std::vector<Unit>& units) const {
    Scratch scratch;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < apart.size(); ++i) {
      Unit unit = units[i];
      const double across = median_across(apart[i], scratch);
      if (across > unit.local) {
        unit = {across, across};
      }
      if (apart_[apart[i]] > options_.distance * unit.capped) {
        apart[kept] = apart[i];
        units[kept++] = unit;
      }
    }
    apart.resize(kept);
    units.resize(kept);
  }

  /// What stays of many scattered samples seems to be less so, since the others have gone.
  /// Together, those that are each other's neighbors still tell.
  std::vector<Index> find_left_over(const std::vector<Index>& sparse) {
    std::vector<double> means;
    find_scattered(sparse, 0, &means);
    std::vector<Index> number(samples_.size(), -1);
    for (std::size_t i = 0; i < sparse.size(); ++i) {
      number[sparse[i]] = static_cast<Index>(i);
    }
    Scratch scratch;
    detail::DisjointSets sets(static_cast<Offset>(sparse.size()));
    for (const Index x : sparse) {
      nearest(x, vote_count_, scratch);
      for (const Index y : scratch.near) {
        if (number[y] >= 0) {
          sets.join(number[x], number[y]);
        }
      }
    }
    std::vector<double> sums(sparse.size(), 0.0);
    std::vector<Index> counts(sparse.size(), 0);
    for (std::size_t i = 0; i < sparse.size(); ++i) {
      const Offset root = sets.find(static_cast<Offset>(i));
      sums[root] += means[i];
      ++counts[root];
    }
    std::vector<Index> found;
    for (std::size_t i = 0; i < sparse.size(); ++i) {
      const Offset root = sets.find(static_cast<Offset>(i));
      if (sums[root] > kLeftOver * counts[root]) {
        found.push_back(sparse[i]);
      }
    }
    return found;
  }

  /// Those around which distances are this large on average.
  /// \param means  if given, these averages
  std::vector<Index> find_scattered(const std::vector<Index>& sparse, double least,
                                    std::vector<double>* means = nullptr) {
    Scratch scratch;
    std::vector<Index> around;
    std::vector<std::size_t> offsets{0};
    for (const Index x : sparse) {
      nearest(x, vote_count_, scratch);
      around.push_back(x);
      around.insert(around.end(), scratch.near.begin(), scratch.near.end());
      offsets.push_back(around.size());
    }
    std::vector<Index> asked = around;
    std::sort(asked.begin(), asked.end());
    asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
    const std::vector<double> values = distances(asked);
    std::vector<Index> found;
    for (std::size_t i = 0; i < sparse.size(); ++i) {
      double sum = 0;
      for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k) {
        const auto at = std::lower_bound(asked.begin(), asked.end(), around[k]);
        sum += std::min(1.0, values[at - asked.begin()] / scales_[around[k]]);
      }
      const double mean = sum / static_cast<double>(offsets[i + 1] - offsets[i]);
      if (means != nullptr) {
        means->push_back(mean);
      }
      if (mean > least) {
        found.push_back(sparse[i]);
      }
    }
    return found;
  }

  /// Lower quartile of the normal distances of each of these samples from the quadrics of
  /// its neighbors, as it is known from an earlier round where none of them went since.
  std::vector<double> distances(const std::vector<Index>& asked) {
    std::vector<Index> changed;
    Scratch scratch;
    for (const Index x : asked) {
      if (!is_known(x, scratch)) {
        changed.push_back(x);
      }
    }
    const std::vector<double> values = distances_now(changed);
    for (std::size_t i = 0; i < changed.size(); ++i) {
      known_[changed[i]] = values[i];
      known_in_[changed[i]] = static_cast<std::int8_t>(round_);
    }
    std::vector<double> result;
    for (const Index x : asked) {
      result.push_back(known_[x]);
    }
    return result;
  }

  bool is_known(Index x, Scratch& scratch) const {
    if (known_in_[x] == kNever) {
      return false;
    }
    nearest(x, vote_count_, scratch);
    bool same = scratch.latest < known_in_[x];
    const std::vector<Index> voters = scratch.near;
    for (std::size_t i = 0; i < voters.size() && same; ++i) {
      nearest(voters[i], vote_count_, scratch);
      same = scratch.latest < known_in_[x];
    }
    return same;
  }

  std::vector<double> distances_now(const std::vector<Index>& asked) {
    struct Vote {
      Index voter;
      Index sample;
      std::size_t slot;
    };
    std::vector<Vote> votes;
    std::vector<std::size_t> offsets{0};
    {
      Scratch scratch;
      for (const Index x : asked) {
        nearest(x, vote_count_, scratch);
        for (const Index y : scratch.near) {
          votes.push_back({y, x, votes.size()});
        }
        offsets.push_back(votes.size());
      }
    }
    std::sort(votes.begin(), votes.end(), [](const Vote& a, const Vote& b) {
      return a.voter != b.voter ? a.voter < b.voter : a.slot < b.slot;
    });
    std::vector<std::size_t> starts;
    for (std::size_t v = 0; v < votes.size(); ++v) {
      if (v == 0 || votes[v].voter != votes[v - 1].voter) {
        starts.push_back(v);
      }
    }
    starts.push_back(votes.size());
    std::vector<double> given(votes.size());

    struct Voter {
      Scratch scratch;
      detail::LocalCoordinates coordinates;
      detail::QuadraticFit fit;
      std::vector<Index> members;
      Eigen::VectorXd weights;
    };
    detail::ThreadScratch<Voter> voters([&] {
      return Voter{{}, {}, detail::QuadraticFit(options_.dim), {}, {}};
    });
    detail::for_each_block_uncounted(
        static_cast<Offset>(starts.size()) - 1, 16, execution_,
        [&](Offset begin, Offset end) {
          voters.use([&](Voter& voter) {
            for (Offset i = begin; i < end; ++i) {
              const Index y = votes[starts[i]].voter;
              nearest(y, vote_count_, voter.scratch);
              std::vector<Index>& members = voter.members;
              members = voter.scratch.near;
              members.push_back(y);
              const std::size_t fitted = members.size();
              const double end_of = distance(y, members[fitted - 2]) * (1 + 1e-6);
              voter.weights.resize(
                  static_cast<Eigen::Index>(fitted + (starts[i + 1] - starts[i])));
              for (std::size_t k = 0; k < fitted; ++k) {
                const double ratio = distance(y, members[k]) / end_of;
                voter.weights[static_cast<Eigen::Index>(k)] = 1 - ratio * ratio;
              }
              for (std::size_t v = starts[i]; v < starts[i + 1]; ++v) {
                voter.weights[static_cast<Eigen::Index>(members.size())] = 0;
                members.push_back(votes[v].sample);
              }
              voter.coordinates.load(samples_, y, members.data(), as_index(members));
              const bool fits =
                  voter.fit.fit(voter.coordinates.vectors(), voter.weights);
              for (std::size_t v = starts[i]; v < starts[i + 1]; ++v) {
                const auto own = std::find(members.begin(), members.begin() + fitted,
                                           votes[v].sample);
                const auto row =
                    own != members.begin() + fitted
                        ? own - members.begin()
                        : static_cast<std::ptrdiff_t>(fitted + (v - starts[i]));
                const double away = distance(y, votes[v].sample);
                given[votes[v].slot] = away > kBeyond * end_of ? away
                                       : fits ? voter.fit.distance_without(row)
                                              : std::numeric_limits<double>::infinity();
              }
            }
          });
        });

    std::vector<double> result;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const auto from = given.begin() + static_cast<Offset>(offsets[i]);
      const auto to = given.begin() + static_cast<Offset>(offsets[i + 1]);
      result.push_back(quantile(std::vector<double>(from, to), kQuantile));
    }
    return result;
  }

  const Samples& samples_;
  const NeighborSearch& search_;
  const Neighborhoods& neighborhoods_;
  const OutlierOptions& options_;
  const Execution& execution_;
  Index near_count_;
  Index vote_count_;
  int round_ = 0;
  std::vector<std::int8_t> out_;       // the round in which a sample went, or kIn
  std::vector<double> known_;          // what distances() found
  std::vector<std::int8_t> known_in_;  // in which round, or kNever
  std::vector<Index> alive_;
  std::vector<double> apart_;
  std::vector<double> reach_;
  std::vector<double> scales_;
  mutable std::vector<std::atomic<Wide*>> wide_;  // of each sample, the longest
  double median_scale_ = 0;
  std::size_t num_scattered_ = 0;
};

}  // namespace

Offset outlier_probe_stride(Offset size) { return std::max<Offset>(1, size / kProbes); }

double least_outlier_distance(double distance, std::vector<double> relative) {
  return std::max(distance,
                  kNoiseFactor * quantile(std::move(relative), kNoiseQuantile));
}

OutlierEvidence outlier_evidence(const Samples& samples, const NeighborSearch& search,
                                 const Neighborhoods& neighborhoods,
                                 const OutlierOptions& options,
                                 const OutlierQuestions& asked,
                                 const Execution& execution) {
  return OutlierFinder(samples, search, neighborhoods, options, execution)
      .evidence(asked);
}

Index outlier_votes(int dim, Offset size) {
  return static_cast<Index>(std::min<Offset>(
      size / 2,
      std::max<Offset>(3 * detail::QuadraticFit::unknowns(dim), kFewestVotes)));
}

Outliers find_outliers(const Samples& samples, const NeighborSearch& search,
                       const Neighborhoods& neighborhoods,
                       const OutlierOptions& options, const Execution& execution) {
  if (options.dim < 1) {
    throw std::invalid_argument("dim is " + std::to_string(options.dim) +
                                ", expected at least 1");
  }
  if (!(options.distance > 0)) {
    throw std::invalid_argument("the distance of outliers is " +
                                std::to_string(options.distance) +
                                ", expected a positive number");
  }
  return OutlierFinder(samples, search, neighborhoods, options, execution).run();
}

}  // namespace remanifold
