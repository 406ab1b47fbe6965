// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a sample lies on a curve with its nearest neighbors, from distances alone.
#pragma once

#include "remanifold/local_spreads.hpp"
#include "remanifold/types.hpp"

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>

namespace remanifold::detail {

/// From end to end of a sample and its nearest neighbors.
struct Chord {
  Index from = 0;
  Index to = 0;
  double length = 0;
  /// The longest way along it without a sample, over its length.
  double largest_step = 0;
};

/// \param places   a sample and its neighbors, nearest first
/// \param squared  squared distance of two of the places
/// \returns whether they lie along a parabola; then with its chord
template <class SquaredDistance>
bool lie_on_parabola(const std::array<Index, kCurveNeighbors + 1>& places,
                     const SquaredDistance& squared, Chord& chord) {
  // They do if they lie off one by this share of their spread along it: nine of
  // independent samples do with a chance of some 1e-6 on a surface, less in more
  // dimensions. No farther off their chord, over its length: most need no fit for that.
  constexpr double kOffCurve = 0.1;
  constexpr double kOffChord = 0.3;
  constexpr int kPlaces = kCurveNeighbors + 1;

  chord.from = places.back();
  std::array<double, kPlaces> to_from;
  double longest = 0;
  for (int i = 0; i < kPlaces; ++i) {
    to_from[i] = squared(chord.from, places[i]);
    if (to_from[i] > longest) {
      longest = to_from[i];
      chord.to = places[i];
    }
  }
  if (!(longest > 0)) {
    return false;
  }
  chord.length = std::sqrt(longest);
  Eigen::Matrix<double, kPlaces, 3> powers;
  std::array<double, kPlaces> steps;
  for (int i = 0; i < kPlaces; ++i) {
    const double to_other = squared(chord.to, places[i]);
    const double along = (to_from[i] + longest - to_other) / (2 * chord.length);
    if (to_from[i] - along * along > kOffChord * kOffChord * longest) {
      return false;
    }
    const double place = along / chord.length - 0.5;
    powers.row(i) << 1, place, place * place;
    steps[i] = place;
  }
  // The sum of squares off the fit, from the distances alone: with P the projection that
  // it leaves, which takes constants away, -1/2 trace(P D).
  using Square = Eigen::Matrix<double, kPlaces, kPlaces>;
  const Eigen::Matrix<double, kPlaces, 3> fitted =
      Eigen::HouseholderQR<Eigen::Matrix<double, kPlaces, 3>>(powers).householderQ() *
      Eigen::Matrix<double, kPlaces, 3>::Identity();
  const Square left = Square::Identity() - fitted * fitted.transpose();
  double off = 0;
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < i; ++j) {
      off -= left(i, j) * squared(places[i], places[j]);
    }
  }
  const double mean = powers.col(1).mean();
  const double spread =
      chord.length * std::sqrt((powers.col(1).array() - mean).square().mean());
  if (off > kOffCurve * kOffCurve * spread * spread * (kPlaces - 3)) {
    return false;
  }
  std::sort(steps.begin(), steps.end());
  chord.largest_step = 0;
  for (int i = 1; i < kPlaces; ++i) {
    chord.largest_step = std::max(chord.largest_step, steps[i] - steps[i - 1]);
  }
  return true;
}

}  // namespace remanifold::detail
