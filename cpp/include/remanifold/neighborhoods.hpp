// SPDX-License-Identifier: GPL-3.0-or-later
// NBD(x): the nearest other samples of each sample (Freedman 2002, section 3), exact and
// with ties by number: of points in their order along a curve, not in that of the input, so
// that the order of the samples decides nothing. FLANN's single kd-tree serves small ambient dimensions,
// blocked matrix products followed by exact distances for a shortlist serve large ones,
// Gram and distance matrices. Cost O(N log N) or O(N^2 D).
#pragma once

#include "remanifold/constants.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace remanifold {

struct Neighbor {
  double squared_distance;
  Index index;
};

enum class SearchMethod {
  kAuto,
  kKdTree,      ///< FLANN KDTreeSingleIndex, exact
  kBruteForce,  ///< exact
  kApproximate  ///< FLANN KMeansIndex: opt-in, not exact, recall to be measured
};

struct SearchOptions {
  SearchMethod method = SearchMethod::kAuto;
  int checks = kChecks;  ///< leaves visited by the approximate search
};

/// Growing nearest-neighbor queries. One Query per thread; queries of one search are
/// independent of each other.
class NeighborSearch {
 public:
  class Query {
   public:
    virtual ~Query() = default;
    /// Announces that nearest() will be asked for the samples [begin, end), with up to
    /// `count` neighbors.
    virtual void prepare(Index /*begin*/, Index /*end*/) {}
    /// The `count` nearest others of x no farther than the squared radius, sorted by
    /// squared distance, then by number.
    virtual void nearest(Index x, Index count, double squared_radius,
                         std::vector<Neighbor>& out) = 0;
    /// Whether each nearest() looks at every sample.
    virtual bool looks_at_all() const { return false; }
    /// The same for any point of R^D in canonical coordinates, where the search can do
    /// that faster than by looking at all samples.
    /// \returns false where it cannot
    virtual bool nearest_to(const double* /*position*/, Index /*count*/,
                            double /*squared_radius*/, std::vector<Neighbor>& /*out*/) {
      return false;
    }
  };

  /// The samples must outlive the search.
  /// \throws std::invalid_argument  a kd-tree or approximate search without points
  explicit NeighborSearch(const Samples& samples, SearchOptions options = {},
                          const Execution& execution = {});
  ~NeighborSearch();
  NeighborSearch(NeighborSearch&&) noexcept;
  NeighborSearch& operator=(NeighborSearch&&) noexcept;

  /// The execution is looked at for cancellation.
  std::unique_ptr<Query> query(const Execution& execution = {}) const;
  /// What kAuto decided.
  SearchMethod method() const { return method_; }
  /// Samples that one prepare() should cover.
  Index block_size() const;

  class Implementation;
  const Implementation& implementation() const { return *implementation_; }

 private:
  SearchMethod method_;
  std::unique_ptr<Implementation> implementation_;
};

/// The `count` nearest neighbors of each sample, nearest first.
struct Neighborhoods {
  Index count = 0;
  std::vector<Index> indices;  ///< size() x count
  /// size() x count, where the search found all at once: brute force on points.
  std::vector<double> squared_distances;

  const Index* of(Index i) const {
    return indices.data() + static_cast<std::size_t>(i) * count;
  }
};

/// count is cut to size() - 1.
Neighborhoods find_neighborhoods(const Samples& samples, const NeighborSearch& search,
                                 Index count, const Execution& execution = {});

/// The first of each.
Neighborhoods nearest_of(const Neighborhoods& known, Index count);

/// What find_neighborhoods finds where the search is exact and some samples were left out
/// since these neighborhoods were found: the search is only asked where too few are left.
/// \param left_out  ascending numbers among the samples of the known neighborhoods
/// \param samples   the others, in the same order
Neighborhoods keep_neighborhoods(const Neighborhoods& known,
                                 const std::vector<Index>& left_out,
                                 const Samples& samples, const NeighborSearch& search,
                                 Index count, const Execution& execution = {});

/// Share of the exact neighbors that the search finds, over `num_queries` evenly spread
/// samples.
double measure_recall(const Samples& samples, const NeighborSearch& search, Index count,
                      Index num_queries, const Execution& execution = {});

}  // namespace remanifold
