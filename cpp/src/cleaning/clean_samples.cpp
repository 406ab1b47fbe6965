// SPDX-License-Identifier: GPL-3.0-or-later
#include "cleaning/clean_samples.hpp"

#include "base/parallel.hpp"
#include "remanifold/constants.hpp"
#include "remanifold/outliers.hpp"
#include "remanifold/smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace remanifold {
namespace {

/// Samples at which the spacing is looked at.
constexpr Index kSpacingProbes = 400;

}  // namespace

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
  report_.noise = report_.prediction_error = report_.remaining_error = nan;
  if (count > 0 || outlier_distance_ > 0) {
    find(std::max<Index>(count, outlier_scale_neighbors(options_.dim)));
  }
  std::vector<Index> outliers;
  bool moved = false;
  if (outlier_distance_ > 0) {
    const Timed timed(cleaning_seconds_);
    begin_step(execution_, Step::kOutliers, 0);
    Outliers found = find_outliers(given_, *search_, neighborhoods_,
                                   {options_.dim, outlier_distance_}, execution_);
    report_.clutter = found.are_clutter;
    outliers = std::move(found.samples);
    if (!outliers.empty()) {
      report_.outliers = to_input(outliers);
      change(given_.without(outliers));
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
    report_.remaining_error = smoothed.remaining_error * given_.scale();
    report_.drowned = smoothed.drowned;
    report_.layers = smoothed.layers;
    report_.growth = smoothed.growth;
    report_.fitting_dim = smoothed.fitting_dim;
    if (smoothed.fitting_dim != options_.dim && options_.on_other_dim) {
      options_.on_other_dim(smoothed.fitting_dim);
    }
    report_.smoothing_neighbors = smoothed.num_neighbors;
    report_.smoothing_rounds = smoothed.rounds;
    if (!smoothed.points.empty()) {
      move(smoothed.points);
      moved = true;
      if (thins_) {
        thin(smoothed.resolution * given_.scale() / samples().scale());
      }
    }
  }
  if (count > 0 && moved) {
    find(count);
  } else if (count > 0 && !outliers.empty()) {
    keep(outliers, count);
  }
}

void CleanSamples::find(Index count) {
  const Timed timed(neighborhood_seconds_);
  neighborhoods_ = find_neighborhoods(samples(), *search_, count, execution_);
}

void CleanSamples::keep(const std::vector<Index>& outliers, Index count) {
  if (search_->method() == SearchMethod::kApproximate ||
      !neighborhoods_.squared_distances.empty()) {
    find(count);
    return;
  }
  const Timed timed(neighborhood_seconds_);
  neighborhoods_ = keep_neighborhoods(neighborhoods_, outliers, samples(), *search_,
                                      count, execution_);
}

void CleanSamples::change(Samples samples) {
  search_.reset();
  changed_ = std::move(samples);
  search_.emplace(*changed_, options_.search, execution_);
}

std::vector<Index> CleanSamples::to_input(const std::vector<Index>& chosen) const {
  std::vector<std::uint8_t> marked(samples().size(), 0);
  for (const Index x : chosen) {
    marked[x] = 1;
  }
  const std::vector<Index> canonical = samples().canonical_indices();
  std::vector<Index> result;
  for (Index i = 0; i < samples().input_size(); ++i) {
    if (canonical[i] >= 0 && marked[canonical[i]] != 0) {
      result.push_back(i);
    }
  }
  return result;
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

// One of those near each other is kept: the first along the curve that they are sorted by.
// The kept ones are farther apart than the distance, and no other is farther from them.
void CleanSamples::thin(double distance) {
  const Samples& all = samples();
  const auto query = search_->query(execution_);
  std::vector<Neighbor> near;
  std::vector<double> nearest;
  const Index stride = std::max<Index>(1, all.size() / kSpacingProbes);
  for (Index x = 0; x < all.size(); x += stride) {
    query->nearest(x, 1, std::numeric_limits<double>::infinity(), near);
    nearest.push_back(near.empty() ? 0 : std::sqrt(near[0].squared_distance));
  }
  const auto middle = nearest.begin() + static_cast<Offset>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  if (!(distance > *middle)) {
    return;
  }
  std::vector<std::uint8_t> left_out(all.size(), 0);
  std::vector<Index> rest;
  for (Index x = 0; x < all.size(); ++x) {
    if (left_out[x] != 0) {
      rest.push_back(x);
      continue;
    }
    execution_.poll();
    query->nearest(x, all.size() - 1, distance * distance, near);
    for (const Neighbor& neighbor : near) {
      if (neighbor.index > x) {
        left_out[neighbor.index] = 1;
      }
    }
  }
  if (rest.empty()) {
    return;
  }
  report_.resolution = distance * all.scale();
  report_.attached = to_input(rest);
  change(all.without(rest));
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
