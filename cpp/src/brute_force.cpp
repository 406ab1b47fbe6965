// SPDX-License-Identifier: GPL-3.0-or-later
// Exact nearest neighbors by looking at every sample. Points in blocks: one matrix product
// gives distances up to a known rounding error, and the exact distance is computed only
// for samples that this error leaves in doubt.
#include "detail/distance.hpp"
#include "detail/neighbor_search.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace remanifold::detail {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Doubles of scratch for the block of products of a thread (32 MB).
constexpr Offset kBlockElements = Offset{1} << 22;

class BruteForce final : public NeighborSearch::Implementation {
 public:
  explicit BruteForce(const Samples& samples) : samples_(samples) {
    if (!samples.has_points()) {
      return;
    }
    const Eigen::Map<const Matrix> points(samples.point(0), samples.size(),
                                          samples.ambient_dim());
    center_ = points.colwise().mean();
    squared_norms_ = (points.rowwise() - center_).rowwise().squaredNorm();
    // |fl(x.y) - x.y| <= D eps |x||y|; twice that covers the sums with the norms.
    error_ = 4.0 * (samples.ambient_dim() + 8) *
             std::numeric_limits<double>::epsilon() * squared_norms_.maxCoeff();
  }

  std::unique_ptr<NeighborSearch::Query> query(
      const Execution& execution) const override {
    return std::make_unique<BruteForceQuery>(*this, execution);
  }

  Index block_size() const override {
    if (!samples_.has_points()) {
      return 16;
    }
    return static_cast<Index>(std::clamp<Offset>(
        kBlockElements / std::max<Index>(samples_.size(), 1), 4, 256));
  }

 private:
  class BruteForceQuery final : public NeighborSearch::Query {
   public:
    BruteForceQuery(const BruteForce& search, const Execution& execution)
        : search_(search), execution_(execution), order_(search.samples_) {}

    void prepare(Index begin, Index end) override {
      const Samples& samples = search_.samples_;
      begin_ = begin;
      end_ = samples.has_points() ? end : begin;
      if (begin_ == end_) {
        return;
      }
      // Columns in tiles, so that a tile of centered points stays in cache.
      const Index dim = samples.ambient_dim();
      const Index tile = std::clamp<Index>(static_cast<Index>((1 << 18) / dim), 16,
                                           samples.size() + 16);
      const auto centered = [&](Index first, Index count) {
        return Eigen::Map<const Matrix>(samples.point(first), count, dim).rowwise() -
               search_.center_;
      };
      rows_ = centered(begin, end - begin);
      products_.resize(end - begin, samples.size());
      for (Index first = 0; first < samples.size(); first += tile) {
        execution_.poll();
        const Index count = std::min<Index>(tile, samples.size() - first);
        columns_ = centered(first, count);
        products_.middleCols(first, count).noalias() = rows_ * columns_.transpose();
      }
    }

    bool looks_at_all() const override { return true; }

    void nearest(Index x, Index count, double squared_radius,
                 std::vector<Neighbor>& out) override {
      const Samples& samples = search_.samples_;
      count = std::min(count, samples.size() - 1);
      out.clear();
      if (count < 1) {
        return;
      }
      if (x >= begin_ && x < end_) {
        shortlist(x, count, squared_radius, out);
      } else {
        for (Index q = 0; q < samples.size(); ++q) {
          const double squared_distance = samples.squared_distance(x, q);
          if (q != x && squared_distance <= squared_radius) {
            out.push_back({squared_distance, q});
          }
        }
      }
      keep_nearest(out, count, order_);
    }

   private:
    /// All samples that may be among the nearest, with their exact distances.
    void shortlist(Index x, Index count, double squared_radius,
                   std::vector<Neighbor>& out) {
      const Samples& samples = search_.samples_;
      const Index n = samples.size();
      const double* products = products_.row(x - begin_).data();
      const double* norms = search_.squared_norms_.data();
      // Half the approximate squared distance, short of the term that all share.
      approximate_.resize(n);
      for (Index q = 0; q < n; ++q) {
        approximate_[q] = 0.5 * norms[q] - products[q];
      }
      approximate_[x] = std::numeric_limits<double>::infinity();
      selected_ = approximate_;
      std::nth_element(selected_.begin(), selected_.begin() + (count - 1),
                       selected_.end());
      const double limit = selected_[count - 1] + 2 * search_.error_;
      for (Index q = 0; q < n; ++q) {
        if (approximate_[q] <= limit && q != x) {
          const double squared_distance = samples.squared_distance(x, q);
          if (squared_distance <= squared_radius) {
            out.push_back({squared_distance, q});
          }
        }
      }
    }

    const BruteForce& search_;
    Execution execution_;
    NeighborOrder order_;
    Index begin_ = 0;
    Index end_ = 0;
    Matrix rows_;
    Matrix columns_;
    Matrix products_;
    std::vector<double> approximate_;
    std::vector<double> selected_;
  };

  const Samples& samples_;
  Eigen::RowVectorXd center_;
  Eigen::VectorXd squared_norms_;
  double error_ = 0;
};

}  // namespace

std::unique_ptr<NeighborSearch::Implementation> make_brute_force(
    const Samples& samples) {
  return std::make_unique<BruteForce>(samples);
}

}  // namespace remanifold::detail
