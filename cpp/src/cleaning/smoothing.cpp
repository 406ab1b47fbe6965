// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/smoothing.hpp"

#include "base/parallel.hpp"
#include "local/local_coordinates.hpp"
#include "local/quadratic_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

constexpr Offset kBlock = 32;
/// Samples at which sizes of neighborhoods are tried.
constexpr Index kProbes = 400;
/// Sizes tried, in unknowns of the quadric.
constexpr double kSizes[] = {1.5, 2, 3, 4.5, 7, 10, 15, 22, 33, 50, 75};
/// No neighborhood holds a larger share of the samples.
constexpr Index kLargestShare = 4;
/// Where predictions have become this much worse, and the samples lie farther off their
/// quadrics than the best prediction, larger neighborhoods are not tried. Predictions by
/// few of very noisy samples alone are no reason to stop: now and then they extrapolate.
constexpr double kHopeless = 1.3;
/// The worst predictions do not count, for a few outliers; no more, since the worst show
/// where neighborhoods are too small to know the tangent space.
constexpr double kTrimmed = 0.01;
/// Noise is where neighborhoods of so many unknowns predict better than smaller ones, and
/// where it is more than this share of the distance to the nearest neighbor.
constexpr double kLeastNoisySize = 6;
constexpr double kLeastNoise = 0.01;
/// Where the members of a neighborhood lie this much farther from its quadric than its
/// middle does, the neighborhood is more than the graph of a quadric.
constexpr double kBiased = 1.25;
/// Noise of this many nearest-neighbor distances mixes up who is whose neighbor.
constexpr double kConfusing = 0.5;

/// Neighborhoods in one arrangement of the samples (the given one, or a smoothed one) and
/// quadrics through the given positions of their members.
class Projector {
 public:
  /// \param arranged  the samples where the neighborhoods are looked for; numbers of the
  ///                  given samples are its input numbers
  Projector(const Samples& given, const Samples& arranged, const NeighborSearch& search,
            const Execution& execution, int dim)
      : given_(given),
        arranged_(arranged),
        query_(search.query(execution)),
        fit_(dim),
        same_(&given == &arranged) {}

  /// Fits the neighborhood of an arranged sample; it may be that of several given ones.
  bool fit(Index arranged, Index count) {
    query_->nearest(arranged, count, std::numeric_limits<double>::infinity(), found_);
    members_.clear();
    members_.push_back(number(arranged));
    weights_.resize(static_cast<Eigen::Index>(found_.size()) + 1);
    weights_[0] = 1;
    const double end =
        found_.empty() ? 1 : std::sqrt(found_.back().squared_distance) * (1 + 1e-6);
    for (const Neighbor& neighbor : found_) {
      const double ratio = std::sqrt(neighbor.squared_distance) / end;
      const double rest = 1 - ratio * ratio * ratio;
      weights_[static_cast<Eigen::Index>(members_.size())] = rest * rest * rest;
      members_.push_back(number(neighbor.index));
    }
    // The first member is the origin.
    coordinates_.load(given_, members_[0], members_.data(),
                      static_cast<Index>(members_.size()));
    return fit_.fit(coordinates_.vectors(), weights_);
  }

  double prediction_error() { return fit_.distance_without(0); }
  double variance() const { return fit_.variance(); }

  void write_projection(double* out) {
    fit_.predict(0, combination_);
    const int ambient_dim = given_.ambient_dim();
    std::fill_n(out, ambient_dim, 0.0);
    // As a move of the sample: weights sum to one, and small moves keep their digits.
    const double* origin = given_.point(members_[0]);
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const double* point = given_.point(members_[i]);
      const double weight = combination_[static_cast<Eigen::Index>(i)];
      for (int axis = 0; axis < ambient_dim; ++axis) {
        out[axis] += weight * (point[axis] - origin[axis]);
      }
    }
    for (int axis = 0; axis < ambient_dim; ++axis) {
      out[axis] += origin[axis];
    }
  }

 private:
  Index number(Index arranged) const {
    return same_ ? arranged : arranged_.input_index(arranged);
  }

  const Samples& given_;
  const Samples& arranged_;
  std::unique_ptr<NeighborSearch::Query> query_;
  detail::QuadraticFit fit_;
  bool same_;
  std::vector<Neighbor> found_;
  std::vector<Index> members_;
  Eigen::VectorXd weights_;
  Eigen::VectorXd combination_;
  detail::LocalCoordinates coordinates_;
};

double trimmed_root_mean_square(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::sort(values.begin(), values.end());
  const auto kept = std::max<std::size_t>(
      1, values.size() -
             static_cast<std::size_t>(kTrimmed * static_cast<double>(values.size())));
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    sum += values[i] * values[i];
  }
  return std::sqrt(sum / static_cast<double>(kept));
}

struct Choice {
  Index num_neighbors = 0;
  double error = std::numeric_limits<double>::infinity();
  double noise = std::numeric_limits<double>::quiet_NaN();
};

class Smoother {
 public:
  Smoother(const Samples& samples, const SmoothingOptions& options,
           const Execution& execution)
      : samples_(samples), options_(options), execution_(execution) {}

  Smoothing run(const NeighborSearch& search) {
    const Choice choice = choose(search);
    Smoothing result;
    result.noise = choice.noise;
    result.prediction_error = choice.error;
    const double nearest = median_nearest(search);
    const bool noisy =
        choice.num_neighbors >=
            kLeastNoisySize * detail::QuadraticFit::unknowns(options_.dim) &&
        choice.noise > kLeastNoise * nearest;
    if (options_.only_noise && !noisy) {
      return result;
    }
    result.num_neighbors = std::min(
        options_.num_neighbors > 0 ? options_.num_neighbors : choice.num_neighbors,
        samples_.size() - 1);
    result.points = project(samples_, search, result.num_neighbors);
    result.rounds = 1;
    if (result.noise > kConfusing * nearest) {
      const Samples moved = Samples::from_points(
          {result.points.data(), samples_.size(), samples_.ambient_dim()}, execution_);
      const NeighborSearch again(moved, options_.search, execution_);
      result.points = project(moved, again, result.num_neighbors);
      result.rounds = 2;
    }
    return result;
  }

 private:
  /// The size of neighborhoods that predicts best.
  Choice choose(const NeighborSearch& search) const {
    const Index stride = std::max<Index>(1, samples_.size() / kProbes);
    const Index probes = (samples_.size() + stride - 1) / stride;
    const double unknowns = detail::QuadraticFit::unknowns(options_.dim);
    Choice best;
    for (const double size : kSizes) {
      const auto count = static_cast<Index>(std::ceil(size * unknowns));
      if (count > samples_.size() / kLargestShare && best.num_neighbors > 0) {
        break;
      }
      std::vector<double> errors(probes, -1);
      std::vector<double> deviations(probes, -1);
      over(samples_, search, probes, [&](Projector& projector, Offset i) {
        if (projector.fit(static_cast<Index>(i) * stride, count)) {
          errors[i] = projector.prediction_error();
          deviations[i] = std::sqrt(projector.variance());
        }
      });
      for (std::vector<double>* values : {&errors, &deviations}) {
        values->erase(std::remove_if(values->begin(), values->end(),
                                     [](double v) { return !(v >= 0); }),
                      values->end());
      }
      const double error = trimmed_root_mean_square(errors);
      const double noise = trimmed_root_mean_square(deviations);
      if (best.num_neighbors > 0 && !(noise < kBiased * error)) {
        break;
      }
      if (error < best.error) {
        best.error = error;
        best.num_neighbors = count;
        best.noise = noise;
      } else if (!(error < kHopeless * best.error) && !(noise < best.error)) {
        break;
      }
    }
    return best;
  }

  template <class Body>
  void over(const Samples& arranged, const NeighborSearch& search, Offset count,
            const Body& body) const {
    detail::PerThread<Projector> projectors([&] {
      return Projector(samples_, arranged, search, execution_, options_.dim);
    });
    detail::for_each_block(count, kBlock, execution_, [&](Offset begin, Offset end) {
      Projector& projector = projectors.local();
      for (Offset i = begin; i < end; ++i) {
        body(projector, i);
      }
    });
  }

  std::vector<double> project(const Samples& arranged, const NeighborSearch& search,
                              Index count) const {
    const auto dim = static_cast<std::size_t>(samples_.ambient_dim());
    std::vector<double> points(samples_.size() * dim);
    detail::begin_step(execution_, Step::kSmoothing, arranged.size());
    over(arranged, search, arranged.size(), [&](Projector& projector, Offset i) {
      const auto a = static_cast<Index>(i);
      const Index x = &arranged == &samples_ ? a : arranged.input_index(a);
      if (projector.fit(a, count)) {
        projector.write_projection(points.data() + x * dim);
      } else {
        std::copy_n(samples_.point(x), dim, points.data() + x * dim);
      }
    });
    // Given samples that were moved to the same place stay there.
    if (&arranged != &samples_) {
      for (Index x = 0; x < samples_.size(); ++x) {
        const Index first = arranged.representatives()[x];
        if (first != x) {
          std::copy_n(points.data() + first * dim, dim, points.data() + x * dim);
        }
      }
    }
    return points;
  }

  double median_nearest(const NeighborSearch& search) const {
    const Index stride = std::max<Index>(1, samples_.size() / kProbes);
    const auto query = search.query(execution_);
    std::vector<Neighbor> found;
    std::vector<double> nearest;
    for (Index x = 0; x < samples_.size(); x += stride) {
      query->nearest(x, 1, std::numeric_limits<double>::infinity(), found);
      if (!found.empty()) {
        nearest.push_back(std::sqrt(found[0].squared_distance));
      }
    }
    const auto middle = nearest.begin() + static_cast<Offset>(nearest.size() / 2);
    std::nth_element(nearest.begin(), middle, nearest.end());
    return nearest.empty() ? 0 : *middle;
  }

  const Samples& samples_;
  const SmoothingOptions& options_;
  const Execution& execution_;
};

}  // namespace

Smoothing smooth(const Samples& samples, const NeighborSearch& search,
                 const SmoothingOptions& options, const Execution& execution) {
  if (!samples.has_points()) {
    throw std::invalid_argument("smoothing needs points");
  }
  if (options.dim < 1 || options.dim > samples.ambient_dim()) {
    throw std::invalid_argument("dim is " + std::to_string(options.dim) +
                                ", expected 1 to " +
                                std::to_string(samples.ambient_dim()));
  }
  if (options.num_neighbors != 0 && options.num_neighbors < options.dim + 1) {
    throw std::invalid_argument(
        "num_neighbors is " + std::to_string(options.num_neighbors) +
        ", expected at least dim + 1 = " + std::to_string(options.dim + 1));
  }
  detail::begin_step(execution, Step::kSmoothing, 0);
  return Smoother(samples, options, execution).run(search);
}

}  // namespace remanifold
