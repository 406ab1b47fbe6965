// SPDX-License-Identifier: GPL-3.0-or-later
#include "cleaning/clean_samples.hpp"

#include "base/parallel.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/outliers.hpp"
#include "remanifold/smoothing.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace remanifold {
namespace detail {

CleanSamples::CleanSamples(const Samples& given, const ReconstructOptions& options,
                           double outlier_distance, const Execution& execution)
    : given_(given),
      options_(options),
      outlier_distance_(outlier_distance),
      execution_(execution) {
  search_.emplace(given, options.search, execution);
}

void CleanSamples::run(Index count) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  report_.noise = report_.prediction_error = nan;
  if (count > 0 || outlier_distance_ > 0) {
    find(std::max<Index>(count, outlier_scale_neighbors(options_.dim)));
  }
  bool stale = false;
  if (outlier_distance_ > 0) {
    const Timed timed(cleaning_seconds_);
    begin_step(execution_, Step::kOutliers, 0);
    const std::vector<Index> outliers =
        find_outliers(given_, *search_, neighborhoods_,
                      {options_.dim, outlier_distance_}, execution_);
    if (!outliers.empty()) {
      leave_out(outliers);
      stale = true;
    }
  }
  if (options_.smooth) {
    const Timed timed(cleaning_seconds_);
    SmoothingOptions smoothing = options_.smoothing;
    smoothing.dim = options_.dim;
    smoothing.search = options_.search;
    Smoothing smoothed = smooth(samples(), *search_, smoothing, execution_);
    report_.noise = smoothed.noise * given_.scale();
    report_.prediction_error = smoothed.prediction_error * given_.scale();
    report_.smoothing_neighbors = smoothed.num_neighbors;
    report_.smoothing_rounds = smoothed.rounds;
    if (!smoothed.points.empty()) {
      move(smoothed.points);
      stale = true;
    }
  }
  if (stale && count > 0) {
    find(count);
  }
}

void CleanSamples::find(Index count) {
  const Timed timed(neighborhood_seconds_);
  neighborhoods_ = find_neighborhoods(samples(), *search_, count, execution_);
}

void CleanSamples::change(Samples samples) {
  search_.reset();
  changed_ = std::move(samples);
  search_.emplace(*changed_, options_.search, execution_);
}

void CleanSamples::leave_out(const std::vector<Index>& outliers) {
  std::vector<std::uint8_t> marked(given_.size(), 0);
  for (const Index x : outliers) {
    marked[x] = 1;
  }
  const std::vector<Index> canonical = given_.canonical_indices();
  for (Index i = 0; i < given_.input_size(); ++i) {
    if (marked[canonical[i]] != 0) {
      report_.outliers.push_back(i);
    }
  }
  change(given_.without(outliers));
}

void CleanSamples::move(const std::vector<double>& points) {
  const Samples& before = samples();
  const auto dim = static_cast<std::size_t>(before.ambient_dim());
  report_.displacements.assign(before.input_size() * dim, 0.0);
  const std::vector<Index> canonical = before.canonical_indices();
  for (std::size_t i = 0; i < canonical.size(); ++i) {
    if (canonical[i] >= 0) {
      const double* from = before.point(canonical[i]);
      const double* to = points.data() + canonical[i] * dim;
      for (std::size_t axis = 0; axis < dim; ++axis) {
        report_.displacements[i * dim + axis] =
            (to[axis] - from[axis]) * before.scale();
      }
    }
  }
  change(before.moved_to({points.data(), before.size(), before.ambient_dim()},
                         execution_));
}

}  // namespace detail

Cleaning clean(const Samples& samples, const ReconstructOptions& options,
               const Execution& execution) {
  detail::CleanSamples clean(samples, options, options.outlier_distance.value_or(0),
                             execution);
  clean.run(0);
  return clean.take_report();
}

}  // namespace remanifold
