// SPDX-License-Identifier: GPL-3.0-or-later
// The dimension of the affine hull of the samples.
#include "remanifold/samples.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

namespace remanifold {
namespace {

/// Of canonical lengths: the extent is one of them or two.
constexpr double kFlat = 1e-6;
/// Coordinates multiplied at most. More directions than this are not told apart from all.
constexpr Offset kMostWork = Offset{1} << 28;
constexpr int kMostDirections = 64;

}  // namespace

int Samples::affine_dim() const {
  if (whole_) {
    return whole_->affine_dim;
  }
  const Index count = size();
  const auto most = static_cast<int>(varying_axes_.size());
  const auto dim = static_cast<std::size_t>(ambient_dim_);
  if (count == 0 || most == 0) {
    return 0;
  }
  const int limit = std::min(most, kMostDirections);
  const auto afforded = kMostWork / (static_cast<Offset>(dim) * limit);
  const Offset looks = std::min<Offset>(count, std::max<Offset>(afforded, 4 * limit));
  const auto sample = [&](Offset i) {
    return point(static_cast<Index>(i * (count - 1) / std::max<Offset>(1, looks - 1)));
  };
  const double* origin = sample(0);
  std::vector<double> row(dim);
  const auto load = [&](Offset i) {
    const double* given = sample(i);
    std::transform(given, given + dim, origin, row.begin(), std::minus<>());
    return std::sqrt(std::inner_product(row.begin(), row.end(), row.begin(), 0.0));
  };
  std::vector<std::vector<double>> directions;
  for (Offset i = 0; i < looks; ++i) {
    double length = load(i);
    // Twice: what is left of a row near the flat is rounding after the first time.
    for (int pass = 0; pass < 2 && length > kFlat; ++pass) {
      for (const std::vector<double>& direction : directions) {
        const double along =
            std::inner_product(row.begin(), row.end(), direction.begin(), 0.0);
        for (std::size_t axis = 0; axis < dim; ++axis) {
          row[axis] -= along * direction[axis];
        }
      }
      length = std::sqrt(std::inner_product(row.begin(), row.end(), row.begin(), 0.0));
    }
    if (!(length > kFlat)) {
      continue;
    }
    if (static_cast<int>(directions.size()) + 1 >= limit) {
      return most;
    }
    for (double& value : row) {
      value /= length;
    }
    directions.push_back(row);
  }
  return static_cast<int>(directions.size());
}

}  // namespace remanifold
