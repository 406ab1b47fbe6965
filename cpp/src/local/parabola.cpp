// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/parabola.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>

namespace remanifold::detail {
namespace {

/// Nine of independent samples lie as near to a parabola with a chance of some 1e-6 on a
/// surface, less in more dimensions.
constexpr double kOffCurve = 0.1;

}  // namespace

bool fits_parabola(
    const std::array<double, kCurveNeighbors + 1>& places,
    const std::array<double, kCurveNeighbors*(kCurveNeighbors + 1) / 2>& between,
    double length) {
  constexpr int kPlaces = kCurveNeighbors + 1;
  using Column = std::array<double, kPlaces>;
  const auto dot = [](const Column& a, const Column& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  // An orthonormal basis of the powers of the places.
  std::array<Column, 3> basis;
  basis[0].fill(1);
  basis[1] = places;
  std::transform(places.begin(), places.end(), places.begin(), basis[2].begin(),
                 std::multiplies<>());
  double spread = 0;
  for (std::size_t power = 0; power < basis.size(); ++power) {
    Column& column = basis[power];
    // Once again for what rounding left of the first time.
    for (std::size_t known = 0; known < 2 * power; ++known) {
      const Column& other = basis[known % power];
      const double part = dot(column, other);
      for (int i = 0; i < kPlaces; ++i) {
        column[i] -= part * other[i];
      }
    }
    const double norm = std::sqrt(dot(column, column));
    if (power == 1) {
      spread = length * norm / std::sqrt(double{kPlaces});
    }
    for (double& entry : column) {
      entry = norm > 0 ? entry / norm : 0;
    }
  }
  // The sum of squares off the fit, from the distances alone: with P the projection that
  // it leaves, which takes constants away, -1/2 trace(P D).
  double off = 0;
  auto square = between.begin();
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < i; ++j) {
      for (const Column& column : basis) {
        off += column[i] * column[j] * *square;
      }
      ++square;
    }
  }
  return !(off > kOffCurve * kOffCurve * spread * spread * (kPlaces - 3));
}

}  // namespace remanifold::detail
