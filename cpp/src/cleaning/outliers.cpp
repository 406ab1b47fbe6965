// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/outliers.hpp"

#include "base/parallel.hpp"
#include "local/local_coordinates.hpp"
#include "local/quadratic_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

constexpr Offset kBlock = 1024;
constexpr Index kFewestVotes = 15;
/// Share of the votes that is passed over: the quadrics of some neighbors miss what lies
/// behind a crease, but at a corner of three sides there is still a third on each.
constexpr double kQuantile = 0.25;
constexpr double kNoiseQuantile = 0.75;
constexpr double kNoiseFactor = 8;
/// Outliers that are strewn put as many into each distance from the shape, out to many of
/// these. Where fewer than half of what lies between a half and one limit is there
/// between two and four, the former are of the shape itself: of coarse parts, corners,
/// or rugged ones. Fewer than these say nothing.
constexpr double kStrewnShare = 0.5;
constexpr double kFewestUsual = 5;
/// How far the limit moves out for these.
constexpr double kUsualFactor = 2;
/// Outliers far from everything are each other's neighbors. There they and those around
/// are sparse, this many times the median scale, and no quadrics agree on where they are:
/// on average over the neighbors, distances in units of the local scale reach this, and
/// this many times that of all samples.
constexpr double kSparse = 3;
constexpr double kScattered = 0.25;
constexpr double kScatteredFactor = 1.5;
/// Of those whose neighbors are outliers for a good part, this share of it: what is left
/// of a cloud is thin, and a surface happens to be near.
constexpr double kAmongOutliers = 0.5;
constexpr double kScatteredAmongOutliers = 0.7;
/// Where coarse sampling is all there is to it, few of the sparse samples are like that;
/// but where outliers were found before, no more is needed.
constexpr std::size_t kScatteredShare = 3;
/// Samples that stand for all others.
constexpr Index kProbes = 300;
/// More sparse samples than this are looked at only where some of them are scattered.
constexpr std::size_t kManySparse = 2000;
constexpr Index kSparseStride = 16;
constexpr int kMostRounds = 20;

template <class T>
T quantile(std::vector<T> values, double share) {
  const auto at = values.begin() +
                  static_cast<Offset>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
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
        vote_count_(
            std::min(samples.size() / 2,
                     std::max<Index>(3 * detail::QuadraticFit::unknowns(options.dim),
                                     kFewestVotes))),
        out_(samples.size(), kIn),
        known_(samples.size()),
        known_in_(samples.size(), kNever),
        apart_(samples.size()),
        reach_(samples.size()),
        scales_(samples.size()) {}

  std::vector<Outlier> run() {
    std::vector<Outlier> outliers;
    if (vote_count_ <= near_count_) {
      return outliers;
    }
    measure_all();
    for (round_ = 0; round_ < kMostRounds; ++round_) {
      const std::vector<Outlier> found = find();
      if (found.empty()) {
        break;
      }
      outliers.insert(outliers.end(), found.begin(), found.end());
      for (const Outlier& one : found) {
        out_[one.sample] = static_cast<std::int8_t>(round_);
      }
      measure_all();
    }
    std::sort(outliers.begin(), outliers.end(),
              [](const Outlier& a, const Outlier& b) { return a.sample < b.sample; });
    return outliers;
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
    Index asked = std::max(neighborhoods_.count, count);
    while (as_index(near) < count && asked < 2 * samples_.size()) {
      asked *= 2;
      if (!scratch.query) {
        scratch.query = search_.query(execution_);
      }
      scratch.query->nearest(x, std::min(asked, samples_.size() - 1),
                             std::numeric_limits<double>::infinity(), scratch.found);
      near.clear();
      for (const Neighbor& neighbor : scratch.found) {
        if (as_index(near) < count) {
          take(neighbor.index);
        }
      }
    }
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
    detail::PerThread<Scratch> scratches;
    const auto over_alive = [&](const auto& body) {
      detail::for_each_block_uncounted(static_cast<Offset>(alive_.size()), kBlock,
                                       execution_, [&](Offset begin, Offset end) {
                                         Scratch& scratch = scratches.local();
                                         for (Offset i = begin; i < end; ++i) {
                                           body(alive_[i], scratch);
                                         }
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
    around.assign(1, values[x]);
    for (const Index y : scratch.near) {
      around.push_back(values[y]);
    }
    const auto middle = around.begin() + static_cast<Offset>(around.size() / 2);
    std::nth_element(around.begin(), middle, around.end());
    return *middle;
  }

  double local_scale(Index x, Scratch& scratch) const {
    return median_around(x, vote_count_, scales_, scratch);
  }

  /// Samples that are this many local scales from their (K+1)-th neighbor, with the scale.
  struct Apart {
    std::vector<Index> samples;
    std::vector<double> scales;
  };
  Apart find_apart(double least, double most) const {
    Scratch scratch;
    Apart result;
    for (const Index x : alive_) {
      // Cheap, and passes over nearly all.
      if (apart_[x] > least * std::min(scales_[x] / 2, median_scale_)) {
        const double local = local_scale(x, scratch);
        if (apart_[x] > least * local && !(apart_[x] > most * local)) {
          result.samples.push_back(x);
          result.scales.push_back(local);
        }
      }
    }
    return result;
  }

  /// How far off these are, in local scales.
  std::vector<double> distances_off(const Apart& apart) {
    std::vector<double> values = distances(apart.samples);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = std::min(values[i], apart_[apart.samples[i]]) / apart.scales[i];
    }
    return values;
  }

  /// Samples that lie and are surrounded sparsely.
  std::vector<Index> find_sparse() const {
    Scratch scratch;
    std::vector<Index> sparse;
    const double least = kSparse * median_scale_;
    for (const Index x : alive_) {
      if (scales_[x] > least && local_scale(x, scratch) > least) {
        sparse.push_back(x);
      }
    }
    return sparse;
  }

  std::vector<Outlier> find() {
    std::vector<Outlier> found;
    const Apart apart =
        find_apart(options_.distance, std::numeric_limits<double>::infinity());
    const std::vector<Index> sparse = find_sparse();
    if (apart.samples.empty() && sparse.empty()) {
      return found;
    }
    const std::vector<double> noise = noise_of_probes();
    const std::vector<double> off = distances_off(apart);
    double limit =
        std::max(options_.distance, kNoiseFactor * quantile(noise, kNoiseQuantile));
    const double farthest = off.empty() ? 0 : *std::max_element(off.begin(), off.end());
    if (farthest > limit && limit < kUsualFactor * options_.distance && is_usual(off)) {
      limit = kUsualFactor * options_.distance;
    }
    for (std::size_t i = 0; i < off.size(); ++i) {
      if (off[i] > limit) {
        found.push_back({apart.samples[i], OutlierReason::kOff, off[i]});
      }
    }
    const double scattered =
        std::max(kScattered, kScatteredFactor * quantile(noise, 0.5));
    if (scattered < 1) {
      add_scattered(sparse, scattered, found);
    }
    std::stable_sort(
        found.begin(), found.end(),
        [](const Outlier& a, const Outlier& b) { return a.sample < b.sample; });
    found.erase(std::unique(found.begin(), found.end(),
                            [](const Outlier& a, const Outlier& b) {
                              return a.sample == b.sample;
                            }),
                found.end());
    return found;
  }

  /// How far off samples lie that stand for all, in units of their scales.
  std::vector<double> noise_of_probes() {
    std::vector<Index> probes;
    const Index stride = std::max<Index>(1, as_index(alive_) / kProbes);
    for (Index i = 0; i < as_index(alive_); i += stride) {
      probes.push_back(alive_[i]);
    }
    std::vector<double> values = distances(probes);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] /= scales_[probes[i]];
    }
    return values;
  }

  /// Whether samples of the shape itself are as far off as the given ones, which are all
  /// that are apart.
  bool is_usual(const std::vector<double>& off) {
    const double unit = options_.distance;
    const auto counted = [](const std::vector<double>& values, double least,
                            double most) {
      return static_cast<double>(
          std::count_if(values.begin(), values.end(),
                        [&](double value) { return value > least && value <= most; }));
    };
    const Apart all = find_apart(unit / 2, unit);
    Apart some;
    const std::size_t stride = all.samples.size() / kProbes + 1;
    for (std::size_t i = 0; i < all.samples.size(); i += stride) {
      some.samples.push_back(all.samples[i]);
      some.scales.push_back(all.scales[i]);
    }
    const double near =
        counted(off, unit / 2, unit) +
        static_cast<double>(stride) * counted(distances_off(some), unit / 2, unit);
    far_ += counted(off, 2 * unit, 4 * unit);
    // The second of these ranges is four times as long.
    return near >= kFewestUsual && far_ / 4 < kStrewnShare * near;
  }

  void add_scattered(const std::vector<Index>& sparse, double least,
                     std::vector<Outlier>& found) {
    if (sparse.size() > kManySparse) {
      std::vector<Index> some;
      for (std::size_t i = 0; i < sparse.size(); i += kSparseStride) {
        some.push_back(sparse[i]);
      }
      if (find_scattered(some, least).empty()) {
        return;
      }
    }
    const std::vector<Index> far = find_scattered(sparse, least);
    if (round_ == 0 && far.size() * kScatteredShare < sparse.size()) {
      return;
    }
    far_ += static_cast<double>(far.size());
    Scratch scratch;
    for (const Index x : far) {
      const double off = std::min(known_[x], apart_[x]) / local_scale(x, scratch);
      found.push_back({x, OutlierReason::kScattered, off});
    }
  }

  /// Of the nearest that a sample came with, as many whatever the neighborhoods hold.
  double share_of_outliers(Index x) const {
    const Index* known = neighborhoods_.of(x);
    const Index count = std::min(near_count_, neighborhoods_.count);
    const auto out =
        std::count_if(known, known + count, [&](Index y) { return out_[y] != kIn; });
    return static_cast<double>(out) / count;
  }

  /// Those around which distances are this large on average.
  std::vector<Index> find_scattered(const std::vector<Index>& sparse, double least) {
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
      const double share =
          share_of_outliers(sparse[i]) >= kAmongOutliers ? kScatteredAmongOutliers : 1;
      if (sum > share * least * static_cast<double>(offsets[i + 1] - offsets[i])) {
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
    detail::PerThread<Voter> voters([&] {
      return Voter{{}, {}, detail::QuadraticFit(options_.dim), {}, {}};
    });
    detail::for_each_block_uncounted(
        static_cast<Offset>(starts.size()) - 1, 16, execution_,
        [&](Offset begin, Offset end) {
          Voter& voter = voters.local();
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
            const bool fits = voter.fit.fit(voter.coordinates.vectors(), voter.weights);
            for (std::size_t v = starts[i]; v < starts[i + 1]; ++v) {
              const auto own =
                  std::find(members.begin(), members.begin() + fitted, votes[v].sample);
              const auto row =
                  own != members.begin() + fitted
                      ? own - members.begin()
                      : static_cast<std::ptrdiff_t>(fitted + (v - starts[i]));
              given[votes[v].slot] = fits ? voter.fit.distance_without(row)
                                          : std::numeric_limits<double>::infinity();
            }
          }
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
  double far_ = 0;                     // outliers farther off than the limit may move
  std::vector<std::int8_t> out_;       // the round in which a sample went, or kIn
  std::vector<double> known_;          // what distances() found
  std::vector<std::int8_t> known_in_;  // in which round, or kNever
  std::vector<Index> alive_;
  std::vector<double> apart_;
  std::vector<double> reach_;
  std::vector<double> scales_;
  double median_scale_ = 0;
};

}  // namespace

std::vector<Outlier> find_outliers(const Samples& samples, const NeighborSearch& search,
                                   const Neighborhoods& neighborhoods,
                                   const OutlierOptions& options,
                                   const Execution& execution) {
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
