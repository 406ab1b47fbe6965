// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that knows FLANN.
#include "remanifold/neighborhoods.hpp"

#include "base/assertions.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "neighbors/flann_allocator.hpp"
#include "neighbors/neighbor_search.hpp"
#include "neighbors/shared_candidates.hpp"
#include "remanifold/verify.hpp"
#include "samples/distance.hpp"

#include <flann/flann.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace remanifold {
namespace {

/// FLANN's distance functor on the distance of the core, which can count its calls.
struct SquaredEuclidean {
  using is_kdtree_distance = bool;
  using ElementType = double;
  using ResultType = double;

  Offset* calls = nullptr;

  template <class A, class B>
  double operator()(A a, B b, std::size_t size, double worst = -1) const {
    if (size < 8) {
      return detail::squared_distance(&*a, &*b, size);
    }
    if (calls != nullptr) {
      ++*calls;
    }
    return worst > 0 ? detail::squared_distance(&*a, &*b, size, worst)
                     : detail::squared_distance(&*a, &*b, size);
  }
  double accum_dist(double a, double b, int /*axis*/) const {
    return (a - b) * (a - b);
  }
};

/// The same, and looks for cancellation while a tree is built.
struct PolledSquaredEuclidean : SquaredEuclidean {
  template <class A, class B>
  double operator()(A a, B b, std::size_t size, double worst = -1) const {
    flann::PooledAllocator::poll();
    return SquaredEuclidean::operator()(a, b, size, worst);
  }
};

/// The nearest samples met so far, kept sorted by insertion while few are asked for and as
/// a heap otherwise. Unlike FLANN's own result sets it breaks ties by number, leaves
/// out the sample itself and allocates nothing once it has grown.
class NearestSet final : public flann::ResultSet<double> {
 public:
  void reset(Index self, Index count, double squared_radius,
             std::vector<Neighbor>& list) {
    self_ = self;
    count_ = static_cast<std::size_t>(count);
    list_ = &list;
    list.clear();
    // FLANN passes over what is exactly as far as the worst; ties have to be seen.
    limit_ = just_above(squared_radius);
  }

  bool full() const override { return list_->size() == count_; }
  double worstDist() const override { return limit_; }

  void addPoint(double squared_distance, std::size_t index) override {
    const Neighbor candidate{squared_distance, static_cast<Index>(index)};
    if (candidate.index == self_ || squared_distance >= limit_) {
      return;
    }
    if (count_ <= kInsertionLimit) {
      insert_sorted(candidate);
    } else {
      insert_heap(candidate);
    }
  }

  void finish() {
    if (count_ > kInsertionLimit) {
      std::sort(list_->begin(), list_->end(), order_);
    }
  }

 private:
  static constexpr std::size_t kInsertionLimit = 64;

  static double just_above(double value) {
    return std::nextafter(value, std::numeric_limits<double>::infinity());
  }

  void insert_sorted(const Neighbor& candidate) {
    std::vector<Neighbor>& list = *list_;
    if (list.size() == count_) {
      if (!order_(candidate, list.back())) {
        return;
      }
      list.pop_back();
    }
    list.push_back(candidate);
    std::size_t i = list.size() - 1;
    for (; i > 0 && order_(candidate, list[i - 1]); --i) {
      list[i] = list[i - 1];
    }
    list[i] = candidate;
    if (list.size() == count_) {
      limit_ = just_above(list.back().squared_distance);
    }
  }

  void insert_heap(const Neighbor& candidate) {
    std::vector<Neighbor>& list = *list_;
    if (list.size() == count_) {
      if (!order_(candidate, list.front())) {
        return;
      }
      std::pop_heap(list.begin(), list.end(), order_);
      list.pop_back();
    }
    list.push_back(candidate);
    std::push_heap(list.begin(), list.end(), order_);
    if (list.size() == count_) {
      limit_ = just_above(list.front().squared_distance);
    }
  }

  detail::NeighborOrder order_;
  Index self_ = -1;
  std::size_t count_ = 0;
  double limit_ = 0;
  std::vector<Neighbor>* list_ = nullptr;
};

/// All samples of a ball, as long as they are not too many.
class Ball final : public flann::ResultSet<double> {
 public:
  explicit Ball(detail::SharedCandidates& candidates)
      : candidates_(candidates), squared_radius_(candidates.squared_radius()) {}
  bool full() const override { return true; }
  double worstDist() const override { return squared_radius_; }
  void addPoint(double /*squared_distance*/, std::size_t index) override {
    if (!candidates_.add(static_cast<Index>(index))) {
      squared_radius_ = -1;  // ends the search
    }
  }

 private:
  detail::SharedCandidates& candidates_;
  double squared_radius_;
};

/// Up to this many coordinates the kd-tree is always taken, and samples share searches.
constexpr int kFewCoordinates = 8;
/// Larger neighborhoods are not shared: sorting them would cost more than finding them.
constexpr Index kMostShared = 64;

template <template <class> class Tree, class Distance>
class FlannSearch final : public NeighborSearch::Implementation {
 public:
  FlannSearch(const Samples& samples, const flann::IndexParams& parameters,
              flann::SearchParams search_parameters, bool exact,
              const Execution& execution, Distance distance = {})
      : samples_(samples),
        exact_(exact),
        index_(std::make_unique<Tree<Distance>>(
            flann::Matrix<double>(const_cast<double*>(samples.point(0)), samples.size(),
                                  samples.ambient_dim()),
            parameters, distance)),
        search_parameters_(search_parameters) {
    const flann::PooledAllocator::Polled polled(execution);
    try {
      index_->buildIndex();
    } catch (...) {
      // The destructor of the k-means tree follows children that are not there yet.
      if (!exact) {
        static_cast<void>(index_.release());
      }
      throw;
    }
  }

  std::unique_ptr<NeighborSearch::Query> query(
      const Execution& /*execution*/) const override {
    return std::make_unique<FlannQuery>(*this);
  }
  Index block_size() const override { return 256; }

 private:
  class FlannQuery final : public NeighborSearch::Query {
   public:
    explicit FlannQuery(const FlannSearch& search)
        : search_(search), shared_(search.samples_) {}

    void prepare(Index begin, Index end) override {
      end_ = end;
      shared_.begin(begin, end);
    }

    void nearest(Index x, Index count, double squared_radius,
                 std::vector<Neighbor>& out) override {
      const Samples& samples = search_.samples_;
      count = std::min(count, samples.size() - 1);
      const bool shared = search_.exact_ && x < end_ && count > 0 &&
                          count <= kMostShared &&
                          samples.ambient_dim() <= kFewCoordinates &&
                          squared_radius == std::numeric_limits<double>::infinity();
      if (shared) {
        if (shared_.take(x, out)) {
          return;
        }
        if (shared_.gather(x, end_, count)) {
          Ball ball(shared_);
          search_.index_->findNeighbors(ball, shared_.center(),
                                        search_.search_parameters_);
          shared_.load();
          shared_.serve(count);
          if (shared_.take(x, out)) {
            return;
          }
        }
      }
      find(x, samples.point(x), count, squared_radius, out);
      if (shared) {
        shared_.observe(out.back().squared_distance);
      }
    }

    bool nearest_to(const double* position, Index count, double squared_radius,
                    std::vector<Neighbor>& out) override {
      if (search_.exact_) {
        find(-1, position, count, squared_radius, out);
      }
      return search_.exact_;
    }

   private:
    void find(Index self, const double* position, Index count, double squared_radius,
              std::vector<Neighbor>& out) {
      set_.reset(self, count, squared_radius, out);
      if (count > 0) {
        search_.index_->findNeighbors(set_, position, search_.search_parameters_);
        set_.finish();
      }
    }

    const FlannSearch& search_;
    NearestSet set_;
    detail::SharedCandidates shared_;
    Index end_ = 0;  // of the samples announced
  };

  const Samples& samples_;
  bool exact_;
  std::unique_ptr<Tree<Distance>> index_;
  flann::SearchParams search_parameters_;
};

std::unique_ptr<NeighborSearch::Implementation> make_kd_tree(
    const Samples& samples, const Execution& execution,
    SquaredEuclidean distance = {}) {
  flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
  // The tree compares sums that were rounded on the way down with exact distances; a
  // little slack keeps it from passing over a branch that holds a tie.
  parameters.eps = -1e-5F;
  return std::make_unique<FlannSearch<flann::KDTreeSingleIndex, SquaredEuclidean>>(
      samples, flann::KDTreeSingleIndexParams(10), parameters, true, execution,
      distance);
}

/// A distance in the tree costs as much as this many in a matrix product (measured, with
/// K from 1 to 3, D from 20 to 1,000 and N from 1,000 to 10,000).
Offset tree_cost(int dim) { return 2 + std::min(dim, 720) / 40; }
constexpr Index kProbes = 32;
constexpr Index kProbeCount = 20;

/// So few samples, in more coordinates than half their number, are compared with all.
constexpr Index kNeverTree = 4096;

/// Whether the tree looks at so many samples a query that comparing with all is faster:
/// counted, so that the same input always makes the same choice.
bool is_tree_slow(const Samples& samples, const Execution& execution) {
  Offset calls = 0;
  const auto tree = make_kd_tree(samples, execution, SquaredEuclidean{&calls});
  const auto query = tree->query(execution);
  std::vector<Neighbor> found;
  const Index probes = std::min(kProbes, samples.size());
  for (Index i = 0; i < probes; ++i) {
    execution.poll();
    query->nearest(static_cast<Index>(static_cast<Offset>(i) * samples.size() / probes),
                   kProbeCount, std::numeric_limits<double>::infinity(), found);
  }
  return tree_cost(samples.ambient_dim()) * calls >
         static_cast<Offset>(probes) * samples.size();
}

std::unique_ptr<NeighborSearch::Implementation> make_approximate(
    const Samples& samples, int checks, const Execution& execution) {
  // Randomized kd-trees draw from std::random_device, so that no two builds are alike.
  // The k-means tree with Gonzales' centers draws one number from std::rand.
  flann::seed_random(1);
  return std::make_unique<FlannSearch<flann::KMeansIndex, PolledSquaredEuclidean>>(
      samples, flann::KMeansIndexParams(32, 11, flann::FLANN_CENTERS_GONZALES, 0.2F),
      flann::SearchParams(checks), false, execution);
}

SearchMethod choose(const Samples& samples, SearchMethod method,
                    const Execution& execution) {
  if (!samples.has_points()) {
    if (method == SearchMethod::kKdTree || method == SearchMethod::kApproximate) {
      throw std::invalid_argument(
          "this search needs points; with gram or distances use brute force");
    }
    return SearchMethod::kBruteForce;
  }
  if (method != SearchMethod::kAuto) {
    return method;
  }
  const bool never = samples.size() <= kNeverTree &&
                     samples.size() <= 2 * Offset{samples.ambient_dim()};
  return samples.ambient_dim() > kFewCoordinates &&
                 (never || is_tree_slow(samples, execution))
             ? SearchMethod::kBruteForce
             : SearchMethod::kKdTree;
}

}  // namespace

NeighborSearch::NeighborSearch(const Samples& samples, SearchOptions options,
                               const Execution& execution)
    : method_(choose(samples, options.method, execution)) {
  execution.poll();
  switch (method_) {
    case SearchMethod::kKdTree:
      implementation_ = make_kd_tree(samples, execution);
      break;
    case SearchMethod::kApproximate:
      implementation_ = make_approximate(samples, options.checks, execution);
      break;
    default:
      implementation_ = detail::make_brute_force(samples);
  }
}

NeighborSearch::~NeighborSearch() = default;
NeighborSearch::NeighborSearch(NeighborSearch&&) noexcept = default;
NeighborSearch& NeighborSearch::operator=(NeighborSearch&&) noexcept = default;

std::unique_ptr<NeighborSearch::Query> NeighborSearch::query(
    const Execution& execution) const {
  return implementation_->query(execution);
}

Index NeighborSearch::block_size() const { return implementation_->block_size(); }

namespace {

/// \param known  called with a sample and its row: whether it could fill the row itself
/// \param all    whether it fills none
template <class Known>
void search_rows(const Samples& samples, const NeighborSearch& search,
                 const Known& known, bool all, const Execution& execution,
                 Neighborhoods& result) {
  struct Scratch {
    std::unique_ptr<NeighborSearch::Query> query;
    std::vector<Neighbor> list;
  };
  detail::ThreadScratch<Scratch> scratch;
  detail::for_each_block(
      samples.size(), search.block_size(), execution, [&](Offset begin, Offset end) {
        scratch.use([&](Scratch& local) {
          bool prepared = false;
          for (Offset i = begin; i < end; ++i) {
            const auto row = result.indices.begin() + i * result.count;
            if (known(static_cast<Index>(i), row)) {
              continue;
            }
            if (!local.query) {
              local.query = search.query(execution);
            }
            if (!prepared) {
              // Where some are known nobody asks for all of the block.
              local.query->prepare(static_cast<Index>(all ? begin : i),
                                   static_cast<Index>(all ? end : i));
              prepared = true;
            }
            local.query->nearest(static_cast<Index>(i), result.count,
                                 std::numeric_limits<double>::infinity(), local.list);
            if (static_cast<Index>(local.list.size()) < result.count) {
              throw std::runtime_error(
                  "the search found " + std::to_string(local.list.size()) +
                  " neighbors instead of " + std::to_string(result.count) +
                  "; raise checks or search exactly");
            }
            std::transform(local.list.begin(), local.list.end(), row,
                           [](const Neighbor& neighbor) { return neighbor.index; });
          }
        });
      });
}

}  // namespace

Neighborhoods find_neighborhoods(const Samples& samples, const NeighborSearch& search,
                                 Index count, const Execution& execution) {
  if (count < 1) {
    throw std::invalid_argument("number of neighbors is " + std::to_string(count) +
                                ", expected at least 1");
  }
  Neighborhoods result;
  result.count = std::min<Index>(count, samples.size() - 1);
  detail::begin_step(execution, Step::kNeighborhoods, samples.size());
  if (!search.implementation().find_all(result.count, execution, result)) {
    result.indices.resize(static_cast<std::size_t>(samples.size()) * result.count);
    search_rows(
        samples, search, [](Index, std::vector<Index>::iterator) { return false; },
        true, execution, result);
  }
  detail::assert_that([&] { verify_neighborhoods(samples, result); });
  return result;
}

Neighborhoods nearest_of(const Neighborhoods& known, Index count) {
  Neighborhoods result;
  result.count = std::min(count, known.count);
  const auto take = [&](const auto& from, auto& into) {
    for (std::size_t i = 0; i < from.size(); i += known.count) {
      const auto first = from.begin() + static_cast<Offset>(i);
      into.insert(into.end(), first, first + result.count);
    }
  };
  take(known.indices, result.indices);
  take(known.squared_distances, result.squared_distances);
  return result;
}

Neighborhoods keep_neighborhoods(const Neighborhoods& known,
                                 const std::vector<Index>& left_out,
                                 const Samples& samples, const NeighborSearch& search,
                                 Index count, const Execution& execution) {
  constexpr Index kLeftOut = -1;
  const auto num_known = samples.size() + static_cast<Index>(left_out.size());
  std::vector<Index> now(num_known);
  std::vector<Index> before;
  before.reserve(samples.size());
  auto next_out = left_out.begin();
  for (Index x = 0; x < num_known; ++x) {
    if (next_out != left_out.end() && *next_out == x) {
      now[x] = kLeftOut;
      ++next_out;
    } else {
      now[x] = static_cast<Index>(before.size());
      before.push_back(x);
    }
  }
  Neighborhoods result;
  result.count = std::min<Index>(count, samples.size() - 1);
  result.indices.resize(static_cast<std::size_t>(samples.size()) * result.count);
  search_rows(
      samples, search,
      [&](Index x, std::vector<Index>::iterator row) {
        const Index* near = known.of(before[x]);
        Index found = 0;
        for (Index k = 0; k < known.count && found < result.count; ++k) {
          if (now[near[k]] != kLeftOut) {
            row[found++] = now[near[k]];
          }
        }
        return found == result.count;
      },
      known.count < result.count, execution, result);
  detail::assert_that([&] { verify_neighborhoods(samples, result); });
  return result;
}

double measure_recall(const Samples& samples, const NeighborSearch& search, Index count,
                      Index num_queries, const Execution& execution) {
  count = std::min<Index>(count, samples.size() - 1);
  num_queries = std::min(num_queries, samples.size());
  if (count < 1) {
    return 1.0;
  }
  const NeighborSearch exact_search(samples, {SearchMethod::kBruteForce});
  const std::unique_ptr<NeighborSearch::Query> query = search.query();
  const std::unique_ptr<NeighborSearch::Query> exact = exact_search.query();
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  std::vector<Neighbor> found;
  std::vector<Neighbor> expected;
  Offset hits = 0;
  for (Index i = 0; i < num_queries; ++i) {
    execution.poll();
    const auto x =
        static_cast<Index>(static_cast<Offset>(i) * samples.size() / num_queries);
    query->nearest(x, count, everywhere, found);
    exact->nearest(x, count, everywhere, expected);
    for (const Neighbor& neighbor : found) {
      hits += std::any_of(expected.begin(), expected.end(), [&](const Neighbor& other) {
        return other.index == neighbor.index;
      });
    }
  }
  return static_cast<double>(hits) / (static_cast<double>(count) * num_queries);
}

}  // namespace remanifold
