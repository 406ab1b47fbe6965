// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/parabola.hpp"

#include <Eigen/Core>
#include <Eigen/QR>

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
  Eigen::Matrix<double, kPlaces, 3> powers;
  for (int i = 0; i < kPlaces; ++i) {
    powers.row(i) << 1, places[i], places[i] * places[i];
  }
  // The sum of squares off the fit, from the distances alone: with P the projection that
  // it leaves, which takes constants away, -1/2 trace(P D).
  using Square = Eigen::Matrix<double, kPlaces, kPlaces>;
  const Eigen::Matrix<double, kPlaces, 3> fitted =
      Eigen::HouseholderQR<Eigen::Matrix<double, kPlaces, 3>>(powers).householderQ() *
      Eigen::Matrix<double, kPlaces, 3>::Identity();
  const Square left = Square::Identity() - fitted * fitted.transpose();
  double off = 0;
  auto square = between.begin();
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < i; ++j) {
      off -= left(i, j) * *square++;
    }
  }
  const double mean = powers.col(1).mean();
  const double spread =
      length * std::sqrt((powers.col(1).array() - mean).square().mean());
  return !(off > kOffCurve * kOffCurve * spread * spread * (kPlaces - 3));
}

}  // namespace remanifold::detail
