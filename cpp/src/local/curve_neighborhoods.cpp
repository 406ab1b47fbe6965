// SPDX-License-Identifier: GPL-3.0-or-later
// Tangent spaces where samples are dense along curves and sparse across them. The nearest
// neighbors lie on one curve there, whose bend says nothing about the other directions.
#include "base/dispatch.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "local/frame_fit.hpp"
#include "local/local_coordinates.hpp"
#include "local/parabola.hpp"
#include "remanifold/tangent_space.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace remanifold {
namespace {

constexpr Offset kBlock = 256;
/// Neighbors that are asked for at first and, doubling, at most, until there are some
/// across the curve and as far again.
constexpr Index kFirstWide = 64;
constexpr Index kMostWide = 512;

/// Of the samples of one thread.
template <int K>
class CurveKernel {
 public:
  CurveKernel(const Samples& samples, const NeighborSearch& search,
              const Neighborhoods& neighborhoods, const TangentOptions& options,
              const Execution& execution)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        options_(options),
        count_(std::min(options.num_neighbors, neighborhoods.count)),
        query_(search.query(execution)),
        fit_(options.dim) {}

  /// \returns whether there is another basis
  bool refit(Index x, double* basis) {
    if (!on_curve(x) || !choose_neighbors(x) || !fit(x)) {
      return false;
    }
    std::copy_n(frame_.data(), frame_.size(), basis);
    return true;
  }

 private:
  bool on_curve(Index x) {
    std::array<Index, kCurveNeighbors + 1> places;
    places[0] = x;
    std::copy_n(neighborhoods_.of(x), kCurveNeighbors, places.begin() + 1);
    return detail::lie_on_parabola(
        places, [&](Index a, Index b) { return samples_.squared_distance(a, b); },
        chord_);
  }

  /// The nearest ones in a metric in which they are as dense along the curve as across.
  bool choose_neighbors(Index x) {
    const auto ambient = static_cast<Eigen::Index>(samples_.ambient_dim());
    const Eigen::Map<const Eigen::VectorXd> origin(samples_.point(x), ambient);
    direction_ =
        Eigen::Map<const Eigen::VectorXd>(samples_.point(chord_.to), ambient) -
        Eigen::Map<const Eigen::VectorXd>(samples_.point(chord_.from), ambient);
    direction_ /= chord_.length;
    const Index most = std::min(kMostWide, samples_.size() - 1);
    for (Index wide = std::min(kFirstWide, most);; wide = std::min(2 * wide, most)) {
      query_->nearest(x, wide, std::numeric_limits<double>::infinity(), near_);
      across_ = std::numeric_limits<double>::infinity();
      keys_.clear();
      for (const Neighbor& neighbor : near_) {
        const double along = direction_.dot(
            Eigen::Map<const Eigen::VectorXd>(samples_.point(neighbor.index), ambient) -
            origin);
        const double off =
            std::sqrt(std::max(0.0, neighbor.squared_distance - along * along));
        keys_.push_back({along, off, neighbor.index});
        if (off > std::abs(along)) {
          across_ = std::min(across_, off);
        }
      }
      if (std::isfinite(across_) &&
          near_.back().squared_distance >= 4 * across_ * across_) {
        break;
      }
      if (wide == most) {
        return false;
      }
    }
    const double step = chord_.length / kCurveNeighbors;
    stretch_ = std::max(1.0, across_ / step);
    const auto key = [&](const Place& place) {
      const double along = place.along * stretch_;
      return along * along + place.off * place.off;
    };
    std::stable_sort(keys_.begin(), keys_.end(),
                     [&](const Place& a, const Place& b) { return key(a) < key(b); });
    keys_.resize(std::min<std::size_t>(keys_.size(), count_));
    return true;
  }

  /// In coordinates in which the samples are as dense along the curve as across.
  bool fit(Index x) {
    const auto ambient = static_cast<Eigen::Index>(samples_.ambient_dim());
    const double* px = samples_.point(x);
    fit_.resize(static_cast<Index>(keys_.size()), ambient);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const double* pq = samples_.point(keys_[i].index);
      const double more = (stretch_ - 1) * keys_[i].along;
      for (Eigen::Index axis = 0; axis < ambient; ++axis) {
        fit_.coordinate(static_cast<Index>(i), axis) =
            pq[axis] - px[axis] + more * direction_[axis];
      }
    }
    if (!fit_.fit(options_.estimator == Estimator::kJet)) {
      return false;
    }
    frame_ = fit_.frame();
    for (Eigen::Index row = 0; row < frame_.rows(); ++row) {
      const double along = frame_.row(row).dot(direction_);
      frame_.row(row) += (1 / stretch_ - 1) * along * direction_.transpose();
    }
    return detail::orthonormalize(frame_);
  }

  struct Place {
    double along;
    double off;
    Index index;
  };

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  const TangentOptions& options_;
  Index count_;
  std::unique_ptr<NeighborSearch::Query> query_;
  detail::FrameFit<K, Eigen::Dynamic> fit_;
  detail::Chord chord_;
  double across_ = 0;
  double stretch_ = 1;
  Eigen::VectorXd direction_;
  std::vector<Neighbor> near_;
  std::vector<Place> keys_;
  detail::RowMatrix frame_;
};

}  // namespace

void refit_along_curves(const Samples& samples, const NeighborSearch& search,
                        const Neighborhoods& neighborhoods,
                        const TangentOptions& options, TangentSpaces& tangents,
                        const Execution& execution) {
  if (options.dim < 2 || options.estimator == Estimator::kEnclosure ||
      tangents.bases.empty() || samples.ambient_dim() == options.dim ||
      neighborhoods.count < kCurveNeighbors) {
    return;
  }
  const auto size = static_cast<std::size_t>(options.dim) * samples.ambient_dim();
  detail::dispatch_dim(options.dim, [&](auto k) {
    using Kernel = CurveKernel<decltype(k)::value>;
    detail::ThreadScratch<Kernel> kernels(
        [&] { return Kernel(samples, search, neighborhoods, options, execution); });
    detail::for_each_block_uncounted(
        samples.size(), kBlock, execution, [&](Offset begin, Offset end) {
          kernels.use([&](Kernel& kernel) {
            for (Offset x = begin; x < end; ++x) {
              // On a straight line there was none.
              if (kernel.refit(static_cast<Index>(x),
                               tangents.bases.data() + x * size)) {
                tangents.boundary[x] = 0;
              }
            }
          });
        });
  });
}

}  // namespace remanifold
