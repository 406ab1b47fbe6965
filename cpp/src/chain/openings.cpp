// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csr.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/sort_unique.hpp"
#include "chain/opening_finder.hpp"
#include "complex/simplex_rows.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/simplex_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace remanifold {
namespace {

using detail::OpeningLevels;
using detail::WeighedOpenings;

constexpr Offset kBlock = 1024;

/// What independent samples do, for one K.
struct Chance {
  double simplices_per_sample;
  /// A simplex is large with this times the local scale as its circumradius. Few are, so
  /// that they do not percolate.
  double large_radius;
  /// Squared coefficient of variation of the volumes of those that are not.
  double variation;
  /// Clusters a sample with a weight above w: rate * exp(-decay * w).
  double rate;
  double decay;
  /// Logarithm of the number of rims that are longer by a spacing, for K = 3 larger by its
  /// square: 4.15 for paths without crossings on the triangular lattice (Jensen, 2004), 1.7
  /// for surfaces on the cubic one.
  double rim_choices;
};

/// Simplices a sample by Miles (1974); the rest was fitted to simulations, see
/// benchmarks/openings.py.
constexpr std::array<Chance, kMaxOpeningDim> kChances{{
    {1, 0.5, 0.84, 0.15, 0.95, 0},
    {2, 1.2, 0.69, 0.016, 0.70, 1.42},
    {6.7677, 1.2, 0.75, 0.0021, 0.72, 0.55},
}};

/// Each simplex of a cluster counts less by this many mean volumes: there are the more
/// clusters to choose from the larger they are.
constexpr double kChoice = 1;
/// Samples around a cluster that its volume is weighed against.
constexpr double kRingSamples = 150;
/// So many of them and more, each time so many times as many, are compared with all: they
/// are weighed against alone where their mean is larger by so many standard errors.
constexpr double kLeastNested = 8;
constexpr double kNestedGrowth = 1.5;
constexpr double kNestedErrors = 1.5;
/// A circumcenter counts as inside down to this share of a height outside: of samples on a
/// circle it may lie on an edge.
constexpr double kCentered = 1e-6;
/// With fewer there is nothing to weigh by.
constexpr double kLeastRing = 8;
/// Even samples have smaller gaps, but no sample tells how much smaller than this.
constexpr double kLeastDispersion = 0.2;
/// The dispersion among so many independent samples is known up to 2 / sqrt(samples), its
/// standard error for exponential gaps; within so many of these it counts as 1.
constexpr double kDispersionErrors = 3;
/// Next to a bridge those go as well whose radius is this share of a large one: where both
/// rims come near each other they would go on bridging it.
constexpr double kNextToBridge = 0.9;
/// The local scale is up to 2^(1/K) times too large at a rim, where half of the
/// neighborhood is missing; this quartile of it among the neighbors is not.
constexpr double kInside = 0.25;
/// So many neighbors are asked, times those that the scale spans: never more than are known
/// of every sample, whatever the kind of search.
constexpr int inside_neighbors(int dim) { return dim == 1 ? 1 : 3; }

/// K = 1: an edge that is so many times longer than those next to it joins two ends. These
/// have to continue each other: so many steps before the edge and behind it, or as many as
/// lead as far, may turn by 120 degrees against each other, besides what they turn on their
/// way. A corner of the curve has an edge of length t with a chance of e^-t, less where
/// samples lie evenly: below a chance it is open. All of them are listed.
constexpr double kLongJoint = 1.5;
constexpr double kOpenJoint = 5;  // -log
constexpr double kMostTurn = 2.0944;
constexpr int kJointSteps = 6;
constexpr int kMostJointSteps = 24;
/// Where the steps lead less far than this share of their length there is no direction.
constexpr double kStraight = 0.5;

class OpeningFinder {
 public:
  OpeningFinder(const Samples& samples, const Neighborhoods& neighborhoods,
                const std::vector<double>& scales, const std::vector<double>& stretch,
                const SimplexArray& simplices, const OpeningLevels& levels,
                const Execution& execution)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        simplices_(simplices),
        levels_(levels),
        execution_(execution),
        scales_(scales),
        stretch_(stretch),
        ruler_(samples, scales),
        arity_(simplices.arity),
        dim_(simplices.arity - 1),
        num_samples_(static_cast<double>(samples.whole_size())),
        chance_(kChances[dim_ - 1]) {}

  WeighedOpenings run() {
    find_large();
    find_clusters();
    for (std::vector<Offset>& cluster : clusters_) {
      execution_.poll();
      weigh(cluster);
    }
    if (dim_ == 1 && (levels_.significance > 0 || !levels_.decisions.empty())) {
      find_joints();
    }
    std::sort(found_.openings.begin(), found_.openings.end(),
              [](const Opening& a, const Opening& b) {
                return a.expected != b.expected ? a.expected < b.expected
                                                : a.samples < b.samples;
              });
    detail::sort_unique(found_.bridges);
    return std::move(found_);
  }

 private:
  /// The local scale further inside, which on lines is too small.
  double least_inner_scale(Index x, std::vector<double>& near) const {
    const Index rank = std::min(scale_neighbors(dim_), neighborhoods_.count) - 1;
    const Index count =
        std::min(inside_neighbors(dim_) * scale_neighbors(dim_), neighborhoods_.count);
    const auto scale = [&](Index y) {
      return samples_.squared_distance(y, neighborhoods_.of(y)[rank]);
    };
    near.assign(1, scale(x));
    for (Index k = 0; k < count; ++k) {
      near.push_back(scale(neighborhoods_.of(x)[k]));
    }
    const auto inside = near.begin() + static_cast<Offset>(kInside * count);
    std::nth_element(near.begin(), inside, near.end());
    return std::sqrt(*inside);
  }

  double inner_scale(Index x, std::vector<double>& near) const {
    return least_inner_scale(x, near) * (stretch_.empty() ? 1 : stretch_[x]);
  }

  /// The circumradius over the inner scale.
  double relative_radius(const Index* simplex, double radius,
                         std::vector<double>& near) const {
    double sum = 0;
    for (int i = 0; i < arity_; ++i) {
      sum += inner_scale(simplex[i], near);
    }
    return sum > 0 ? radius * arity_ / sum : 0;
  }

  double least_scale(const Index* simplex) const {
    double least = scales_[simplex[0]];
    for (int i = 1; i < arity_; ++i) {
      least = std::min(least, scales_[simplex[i]]);
    }
    return least;
  }

  void find_large() {
    const Offset count = simplices_.size();
    large_.assign(count, 0);
    // The scale is too large by less than this at a rim; at a small part far away, whose
    // neighbors are elsewhere, it says nothing, but that of the other side does.
    const double screen =
        chance_.large_radius * std::pow(0.5, 1.0 / dim_) * kInsideOverScale;
    detail::for_each_block_uncounted(
        count, kBlock, execution_, [&](Offset begin, Offset end) {
          std::vector<double> near;
          for (Offset s = begin; s < end; ++s) {
            const Index* simplex = simplices_[s];
            const double radius = ruler_.measure(simplex, arity_).circumradius;
            large_[s] =
                radius > screen * least_scale(simplex) &&
                        relative_radius(simplex, radius, near) > chance_.large_radius
                    ? 1
                    : 0;
          }
        });
  }

  /// Large simplices that share facets.
  void find_clusters() {
    std::vector<Offset> rows;
    for (Offset s = 0; s < simplices_.size(); ++s) {
      if (large_[s] != 0) {
        rows.push_back(s);
      }
    }
    clusters_ = parts_of(rows);
    std::vector<double> near;
    clusters_.erase(
        std::remove_if(
            clusters_.begin(), clusters_.end(),
            [&](const std::vector<Offset>& cluster) {
              return expected(most_weight(cluster, near) / kLeastDispersion) >
                         levels_.most_expected &&
                     expected_balls(most_in_ball(cluster, near) / kLeastDispersion) >
                         levels_.most_expected;
            }),
        clusters_.end());
    for (const std::vector<Offset>& cluster : clusters_) {
      for (const Offset s : cluster) {
        large_[s] = kCandidate;
      }
    }
  }

  /// More than the ring will say: by the density that the inner scale stands for.
  double most_weight(const std::vector<Offset>& cluster, std::vector<double>& near) {
    double weight = 0;
    for (const Offset s : cluster) {
      const Index* simplex = simplices_[s];
      double scale = 0;
      for (int i = 0; i < arity_; ++i) {
        scale += least_inner_scale(simplex[i], near) / arity_;
      }
      const double held = scale_neighbors(dim_) *
                          ruler_.measure(simplex, arity_).volume /
                          (unit_ball() * std::pow(scale, dim_));
      weight += held - (1 + kChoice) / chance_.simplices_per_sample;
    }
    return weight;
  }

  /// What the largest ball inside a cluster would hold, as far as the inner scale tells.
  double most_in_ball(const std::vector<Offset>& cluster, std::vector<double>& near) {
    if (dim_ == 1) {
      return 0;
    }
    double most = 0;
    for (const Offset s : cluster) {
      const double radius = ruler_.measure(simplices_[s], arity_).circumradius;
      double scale = 0;
      for (int i = 0; i < arity_; ++i) {
        scale += least_inner_scale(simplices_[s][i], near) / arity_;
      }
      const double held = scale_neighbors(dim_) * std::pow(radius / scale, dim_);
      if (held > most && has_inner_ball(s)) {
        most = held;
      }
    }
    return most;
  }

  /// Whether the empty ball of a simplex is about a point inside it, and none of its
  /// vertices on a rim, beyond which there is nothing that could be empty.
  bool has_inner_ball(Offset s) {
    make_stars();
    const Index* simplex = simplices_[s];
    return ruler_.holds_center(simplex, arity_, kCentered) &&
           std::none_of(simplex, simplex + arity_, [&](Index v) { return at_rim(v); });
  }

  bool at_rim(Index v) const {
    for (const Index* s = stars_.begin(v); s != stars_.end(v); ++s) {
      for (int j = 0; j < arity_; ++j) {
        bool open = simplices_[*s][j] != v;
        if (open) {
          across(*s, j, [&](Offset) { open = false; });
        }
        if (open) {
          return true;
        }
      }
    }
    return false;
  }

  double unit_ball() const {
    constexpr double kPi = 3.14159265358979323846;
    return dim_ == 1 ? 2 : dim_ == 2 ? kPi : 4 * kPi / 3;
  }

  double expected(double weight) const {
    return num_samples_ * chance_.rate * std::exp(-chance_.decay * weight);
  }

  void make_stars() {
    if (stars_.rows() == 0) {
      stars_ = detail::csr_of(samples_.size(), [&](const auto& add) {
        for (Offset s = 0; s < simplices_.size(); ++s) {
          for (int i = 0; i < arity_; ++i) {
            add(simplices_[s][i], static_cast<Index>(s));
          }
        }
      });
      seen_.assign(simplices_.size(), 0);
      reached_.assign(samples_.size(), 0);
    }
  }

  /// Simplices around the cluster that are not large, whole layers of stars at a time,
  /// through large ones as well that are no candidates.
  /// \param layers  how many there are up to the end of each layer
  std::vector<Offset> ring_of(const std::vector<Offset>& cluster,
                              std::vector<std::size_t>& layers) {
    make_stars();
    const auto wanted =
        static_cast<std::size_t>(kRingSamples * chance_.simplices_per_sample);
    std::vector<Index> reached;
    const auto reach = [&](Offset s) {
      for (int i = 0; i < arity_; ++i) {
        const Index v = simplices_[s][i];
        if (reached_[v] == 0) {
          reached_[v] = 1;
          reached.push_back(v);
        }
      }
    };
    for (const Offset s : cluster) {
      reach(s);
    }
    std::vector<Offset> ring;
    std::vector<Offset> passed;
    for (std::size_t begin = 0; ring.size() < wanted && begin < reached.size();) {
      const std::size_t end = reached.size();
      for (; begin < end; ++begin) {
        const Index v = reached[begin];
        for (const Index* s = stars_.begin(v); s != stars_.end(v); ++s) {
          if (large_[*s] != kCandidate && seen_[*s] == 0) {
            seen_[*s] = 1;
            (large_[*s] == 0 ? ring : passed).push_back(*s);
            reach(*s);
          }
        }
      }
      layers.push_back(ring.size());
    }
    for (const Index v : reached) {
      reached_[v] = 0;
    }
    for (const std::vector<Offset>* simplices : {&ring, &passed}) {
      for (const Offset s : *simplices) {
        seen_[s] = 0;
      }
    }
    return ring;
  }

  /// Simplices around a cluster.
  struct Ring {
    double samples = 0;
    double mean = 0;  ///< volume
    double dispersion = 1;
  };

  void weigh(const std::vector<Offset>& cluster) {
    if (dim_ == 1 && cluster.size() == 1 && joint_at(cluster[0]).length > 0) {
      return;  // weighed as one
    }
    const Ring measured = measure_around(cluster);
    if (measured.samples < kLeastRing) {
      return;
    }
    Opening whole = weighed(cluster, measured);
    const auto evident = [&] { return whole.significance() <= levels_.significance; };
    const bool by_volume = evident();
    whole.expected = std::min(whole.expected, least_balls(cluster, measured));
    if (whole.expected > levels_.most_expected) {
      return;
    }
    const bool only_ball = evident() && !by_volume;
    decide(whole, evident());
    if (whole.open && dim_ > 1) {
      open_parts(cluster, measured, std::move(whole), only_ball);
      return;
    }
    if (whole.open) {
      add_bridge(cluster);
    }
    found_.openings.push_back(std::move(whole));
  }

  /// By as much around as is alike: where what is near lies sparser than what is farther,
  /// by more than chance explains, the density changes there, and what is near tells it.
  Ring measure_around(const std::vector<Offset>& cluster) {
    std::vector<std::size_t> layers;
    const std::vector<Offset> ring = ring_of(cluster, layers);
    std::vector<Moments> nested;
    Moments sums;
    std::size_t next = 0;
    for (const std::size_t end : layers) {
      for (; next < end; ++next) {
        sums.add(ruler_.measure(simplices_[ring[next]], arity_).volume);
      }
      const double around = sums.count / chance_.simplices_per_sample;
      if (around >= kLeastNested &&
          (nested.empty() || sums.count >= kNestedGrowth * nested.back().count)) {
        nested.push_back(sums);
      }
    }
    if (nested.empty() || nested.back().count < sums.count) {
      nested.push_back(sums);
    }
    while (nested.size() > 1 && differs_inside(nested)) {
      nested.pop_back();
    }
    return ring_from(nested.back());
  }

  /// Of the volumes of some simplices.
  struct Moments {
    double count = 0;
    double sum = 0;
    double squares = 0;
    void add(double volume) {
      count += 1;
      sum += volume;
      squares += volume * volume;
    }
    double mean() const { return sum / count; }
  };

  bool differs_inside(const std::vector<Moments>& nested) const {
    const Moments& whole = nested.back();
    return std::any_of(nested.begin(), nested.end() - 1, [&](const Moments& near) {
      const double open =
          chance_.simplices_per_sample * (1 / near.count - 1 / whole.count);
      return std::log(near.mean() / whole.mean()) > kNestedErrors * std::sqrt(open);
    });
  }

  Ring ring_from(const Moments& sums) const {
    if (!(sums.sum > 0)) {
      return {};
    }
    const double around = sums.count / chance_.simplices_per_sample;
    const double variation =
        std::max(0.0, sums.squares * sums.count / (sums.sum * sums.sum) - 1);
    // Where the density changes, by that of the sparser side: the mean by volume.
    Ring measured;
    measured.samples = around;
    measured.mean =
        sums.mean() * std::max(1.0, (1 + variation) / (1 + chance_.variation));
    measured.dispersion = dispersion_of(variation, around);
    return measured;
  }

  /// By what was given, or by the evidence.
  void decide(Opening& opening, bool evident) const {
    opening.open = evident;
    for (const OpeningDecision& decision : levels_.decisions) {
      std::size_t common = 0;
      for (const Index v : opening.samples) {
        common +=
            std::binary_search(decision.samples.begin(), decision.samples.end(), v) ? 1
                                                                                    : 0;
      }
      if (2 * common > std::max(opening.samples.size(), decision.samples.size())) {
        opening.open = decision.open;
        opening.given = true;
      }
    }
  }

  Opening weighed(const std::vector<Offset>& cluster, const Ring& ring) const {
    Opening opening;
    opening.kind = dim_ == 1 ? OpeningKind::kGap : OpeningKind::kHole;
    opening.simplices = detail::select_rows(simplices_, cluster);
    for (const Offset s : cluster) {
      opening.volume += ruler_.measure(simplices_[s], arity_).volume;
      opening.samples.insert(opening.samples.end(), simplices_[s],
                             simplices_[s] + arity_);
    }
    detail::sort_unique(opening.samples);
    opening.dispersion = ring.dispersion;
    opening.spacing = std::pow(ring.mean * chance_.simplices_per_sample, 1.0 / dim_);
    const auto size = static_cast<double>(cluster.size());
    opening.missing =
        (opening.volume / ring.mean - size) / chance_.simplices_per_sample;
    const double weight =
        opening.missing - kChoice * size / chance_.simplices_per_sample;
    opening.expected = expected(counted(weight, ring));
    return opening;
  }

  /// The density around is known from so many samples only, and even samples have smaller
  /// gaps.
  static double counted(double weight, const Ring& ring) {
    return ring.samples * std::log1p(std::max(0.0, weight) / ring.samples) /
           ring.dispersion;
  }

  /// Simplices whose empty balls are no smaller than this one are expected among
  /// independent samples: what it holds is distributed as Gamma(K) (Miles, 1974).
  double expected_balls(double content) const {
    double sum = 0;
    double term = 1;
    for (int i = 0; i < dim_; ++i) {
      sum += term;
      term *= content / (i + 1);
    }
    return num_samples_ * chance_.simplices_per_sample * std::exp(-content) * sum;
  }

  double expected_balls(double radius, const Ring& ring) const {
    const double held = unit_ball() * std::pow(radius, dim_) /
                        (ring.mean * chance_.simplices_per_sample);
    return expected_balls(counted(held, ring));
  }

  /// The same of the largest ball inside a cluster: a round hole whose rim has many samples
  /// falls into many simplices, none of which is large for itself, but all in one ball.
  double least_balls(const std::vector<Offset>& cluster, const Ring& ring) {
    double largest = 0;
    for (const Offset s : cluster) {
      const double radius =
          dim_ > 1 ? ruler_.measure(simplices_[s], arity_).circumradius : 0;
      if (radius > largest && has_inner_ball(s)) {
        largest = radius;
      }
    }
    return largest > 0 ? expected_balls(largest, ring)
                       : std::numeric_limits<double>::infinity();
  }

  /// What of a cluster shows itself to be open. Its core is what chance does not leave
  /// empty, simplex by simplex. What that leaves of it, with what is next to it and nearly
  /// as large, goes as well where it is unlikely by itself, or where the rim would not be
  /// longer around it, or not so much longer that among all the rims there are one as empty
  /// is to be expected: else large simplices in a thin place of a band would cut it.
  /// Without a core the cluster counts as a whole. Around a ball that alone is evidence
  /// those are of the core that are not to be expected, or the hole would be filled again.
  void open_parts(const std::vector<Offset>& cluster, const Ring& ring, Opening whole,
                  bool only_ball) {
    std::vector<Offset> core;
    std::vector<Offset> rest;
    const double most = only_ball ? levels_.most_expected
                                  : -std::log1p(-std::min(levels_.significance, 0.999));
    for (const Offset s : cluster) {
      const double radius = ruler_.measure(simplices_[s], arity_).circumradius;
      (expected_balls(radius, ring) <= most ? core : rest).push_back(s);
    }
    if (core.empty() || rest.empty()) {
      add_bridge(cluster);
      found_.openings.push_back(std::move(whole));
      return;
    }
    std::vector<Offset> all = cluster;
    extend(all);
    rest.insert(rest.end(), all.begin() + static_cast<Offset>(cluster.size()),
                all.end());
    for (const std::vector<Offset>& part : parts_of(rest)) {
      Opening opening = weighed(part, ring);
      const double ways = chance_.rim_choices * growth_of_rim(part) /
                          std::pow(opening.spacing, dim_ - 1);
      decide(opening,
             opening.significance() <= levels_.significance ||
                 std::exp(ways) * opening.expected <= num_samples_ * chance_.rate);
      if (opening.open) {
        core.insert(core.end(), part.begin(), part.end());
      } else if (opening.expected <= levels_.most_expected) {
        found_.openings.push_back(std::move(opening));
      }
    }
    Opening opening = weighed(core, ring);
    opening.expected = std::min(opening.expected, whole.expected);
    decide(opening, true);
    opening.given = opening.given || whole.given;
    if (opening.open) {
      found_.bridges.insert(found_.bridges.end(), core.begin(), core.end());
    }
    found_.openings.push_back(std::move(opening));
  }

  /// Those that share facets are in one part.
  std::vector<std::vector<Offset>> parts_of(const std::vector<Offset>& rows) const {
    const SimplexArray chosen = detail::select_rows(simplices_, rows);
    const FacetGroups groups = group_facets(chosen, samples_.size(), execution_);
    detail::DisjointSets sets(chosen.size());
    for (Offset g = 0; g < groups.size(); ++g) {
      for (Offset i = groups.offsets[g] + 1; i < groups.offsets[g + 1]; ++i) {
        sets.join(groups.facets[groups.offsets[g]] / arity_, groups.facets[i] / arity_);
      }
    }
    std::vector<Offset> number(rows.size(), -1);
    std::vector<std::vector<Offset>> parts;
    for (Offset s = 0; s < chosen.size(); ++s) {
      const Offset root = sets.find(s);
      if (number[root] < 0) {
        number[root] = static_cast<Offset>(parts.size());
        parts.emplace_back();
      }
      parts[number[root]].push_back(rows[s]);
    }
    return parts;
  }

  void add_bridge(std::vector<Offset> bridge) {
    extend(bridge);
    found_.bridges.insert(found_.bridges.end(), bridge.begin(), bridge.end());
  }

  /// With what is nearly as large and reached through facets.
  void extend(std::vector<Offset>& rows) {
    std::vector<double> near;
    for (const Offset s : rows) {
      seen_[s] = 1;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (int j = 0; j < arity_; ++j) {
        across(rows[i], j, [&](Offset s) {
          if (seen_[s] == 0 &&
              relative_radius(simplices_[s],
                              ruler_.measure(simplices_[s], arity_).circumradius,
                              near) > kNextToBridge * chance_.large_radius) {
            seen_[s] = 1;
            rows.push_back(s);
          }
        });
      }
    }
    for (const Offset s : rows) {
      seen_[s] = 0;
    }
  }

  /// Calls with the simplices on the other side of the facet without vertex j.
  template <class Function>
  void across(Offset s, int j, Function&& function) const {
    const Index* simplex = simplices_[s];
    const Index v = simplex[j == 0 ? 1 : 0];
    for (const Index* t = stars_.begin(v); t != stars_.end(v); ++t) {
      const Index* other = simplices_[*t];
      bool has_facet = *t != s;
      for (int i = 0; i < arity_ && has_facet; ++i) {
        has_facet =
            i == j || std::find(other, other + arity_, simplex[i]) != other + arity_;
      }
      if (has_facet) {
        function(Offset{*t});
      }
    }
  }

  /// Size of the rim around a part, less that of the rim without it.
  double growth_of_rim(const std::vector<Offset>& part) {
    for (const Offset s : part) {
      seen_[s] = 1;
    }
    std::array<Index, kMaxOpeningDim> facet{};
    double growth = 0;
    for (const Offset s : part) {
      for (int j = 0; j < arity_; ++j) {
        bool inside = false;
        bool stays = false;
        across(s, j, [&](Offset t) {
          inside = inside || seen_[t] != 0;
          stays = stays || large_[t] != kCandidate;
        });
        if (!inside) {
          std::copy_if(simplices_[s], simplices_[s] + arity_, facet.begin(),
                       [&](const Index& v) { return &v != simplices_[s] + j; });
          const double size = ruler_.measure(facet.data(), dim_).volume;
          growth += stays ? size : -size;
        }
      }
    }
    for (const Offset s : part) {
      seen_[s] = 0;
    }
    return growth;
  }

  /// As far as it differs from 1 by more than the ring leaves open.
  double dispersion_of(double variation, double around) const {
    const double found = variation / chance_.variation;
    const double open = kDispersionErrors * 2 / std::sqrt(around);
    const double beyond =
        found > 1 ? std::max(1.0, found - open) : std::min(1.0, found + open);
    return std::max(kLeastDispersion, beyond);
  }

  int shared(const Index* a, const Index* b) const {
    int count = 0;
    for (int i = 0; i < arity_; ++i) {
      count += std::find(b, b + arity_, a[i]) != b + arity_ ? 1 : 0;
    }
    return count;
  }

  /// The way along a curve from an end, away from the other end of its edge, as long as
  /// that is, to tell a direction.
  struct Way {
    Index last = -1;
    Index middle = -1;
    int steps = 0;
    double length = 0;
  };
  Way way_from(Index v, Index before, double length) const {
    std::array<Index, kMostJointSteps + 1> passed{v};
    Way way{v, v, 0, 0};
    while (way.steps < kMostJointSteps &&
           (way.steps < kJointSteps || way.length < length)) {
      Index after = -1;
      for (const Index* s = stars_.begin(way.last); s != stars_.end(way.last); ++s) {
        const Index* edge = simplices_[*s];
        const Index other = edge[0] == way.last ? edge[1] : edge[0];
        after = other != before ? other : after;
      }
      if (after < 0 || after == v) {
        break;
      }
      way.length += std::sqrt(samples_.squared_distance(way.last, after));
      before = way.last;
      way.last = after;
      ++way.steps;
      passed[way.steps] = after;
    }
    way.middle = passed[way.steps / 2];
    return way;
  }

  /// An edge between two ends that do not continue each other.
  struct Joint {
    double length = 0;  // 0: it is none
    double mean = 0;    // length of the edges before and behind
  };
  Joint joint_at(Offset e) {
    make_stars();
    const Index a = simplices_[e][0];
    const Index b = simplices_[e][1];
    const double length = std::sqrt(samples_.squared_distance(a, b));
    if (stars_.size(a) > 2 || stars_.size(b) > 2 ||
        !(length > kLongJoint * shortest_at(a, b))) {
      return {};
    }
    const Way from = way_from(a, b, length);
    const Way to = way_from(b, a, length);
    if (from.steps < kJointSteps || to.steps < kJointSteps) {
      return {};
    }
    const double mean = (from.length + to.length) / (from.steps + to.steps);
    if (length <= kLongJoint * mean || !is_straight(a, from) || !is_straight(b, to)) {
      return {};
    }
    // What both sides turn by themselves they go on turning.
    const double turn = angle(from.last, a, b, to.last);
    const double own = angle(from.last, from.middle, from.middle, a) +
                       angle(b, to.middle, to.middle, to.last);
    return turn > kMostTurn + own ? Joint{length, mean} : Joint{};
  }

  void find_joints() {
    for (Offset e = 0; e < simplices_.size(); ++e) {
      const Joint found = joint_at(e);
      if (!(found.length > 0)) {
        continue;
      }
      const Ring ring = measure_around({e});
      if (!(ring.samples > 0)) {
        continue;
      }
      const double weight = counted(found.length / found.mean, ring);
      Opening joint = weighed({e}, ring);
      joint.kind = OpeningKind::kJoint;
      joint.spacing = found.mean;
      joint.missing = found.length / found.mean - 1;
      joint.expected = std::min(joint.expected, std::exp(-weight));
      decide(joint, joint.expected < std::exp(-kOpenJoint) && levels_.significance > 0);
      if (joint.open) {
        found_.bridges.push_back(e);
      }
      found_.openings.push_back(std::move(joint));
    }
  }

  bool is_straight(Index end, const Way& way) const {
    return std::sqrt(samples_.squared_distance(end, way.last)) > kStraight * way.length;
  }

  /// Between the vectors from a to b and from c to d.
  double angle(Index a, Index b, Index c, Index d) const {
    const double product =
        samples_.inner_product(a, b, d) - samples_.inner_product(a, b, c);
    const double lengths = std::sqrt(samples_.squared_distance(a, b)) *
                           std::sqrt(samples_.squared_distance(c, d));
    return lengths > 0 ? std::acos(std::clamp(product / lengths, -1.0, 1.0)) : 0;
  }

  /// Of the edges at a and b, but for the one between them.
  double shortest_at(Index a, Index b) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const auto& [v, other] : {std::pair(a, b), std::pair(b, a)}) {
      for (const Index* s = stars_.begin(v); s != stars_.end(v); ++s) {
        const Index* edge = simplices_[*s];
        const Index next = edge[0] == v ? edge[1] : edge[0];
        if (next != other) {
          shortest = std::min(shortest, samples_.squared_distance(v, next));
        }
      }
    }
    return std::sqrt(shortest);
  }

  /// Of independent samples the inner scale is this share of the other, or less.
  static constexpr double kInsideOverScale = 0.9;

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  const SimplexArray& simplices_;
  const OpeningLevels& levels_;
  const Execution& execution_;
  const std::vector<double>& scales_;
  const std::vector<double>& stretch_;
  SimplexRuler ruler_;
  int arity_;
  int dim_;
  double num_samples_;  // of the whole
  const Chance& chance_;
  static constexpr std::uint8_t kCandidate = 2;
  std::vector<std::uint8_t> large_;            // simplices; 0, 1 or kCandidate
  std::vector<std::vector<Offset>> clusters_;  // of large ones
  Csr stars_;                                  // simplices at each sample
  std::vector<std::uint8_t> seen_;             // simplices; 0 between uses
  std::vector<std::uint8_t> reached_;          // samples; 0 between uses
  WeighedOpenings found_;
};

}  // namespace

double opening_decay(int dim) { return kChances.at(dim - 1).decay; }

double Opening::significance() const { return -std::expm1(-expected); }

namespace detail {

WeighedOpenings weigh_openings(const Samples& samples,
                               const Neighborhoods& neighborhoods,
                               const std::vector<double>& scales,
                               const std::vector<double>& stretch,
                               const SimplexArray& simplices,
                               const OpeningLevels& levels,
                               const Execution& execution) {
  const int dim = simplices.arity - 1;
  if (dim < 1 || dim > kMaxOpeningDim || simplices.size() == 0 ||
      neighborhoods.count == 0) {
    return {};
  }
  return OpeningFinder(samples, neighborhoods, scales, stretch, simplices, levels,
                       execution)
      .run();
}

}  // namespace detail
}  // namespace remanifold
