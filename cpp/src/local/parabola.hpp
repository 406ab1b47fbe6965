// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a sample lies on a curve with its nearest neighbors, from distances alone.
#pragma once

#include "remanifold/local_spreads.hpp"
#include "remanifold/types.hpp"

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

/// \param places   of a sample and its neighbors along their chord, in units of its length
/// \param between  squared distances: of the second from the first, of the third from the
///                 first and the second, and so on
/// \returns whether some parabola over the chord is no farther off them than a tenth of
///          their spread along it
bool fits_parabola(
    const std::array<double, kCurveNeighbors + 1>& places,
    const std::array<double, kCurveNeighbors*(kCurveNeighbors + 1) / 2>& between,
    double length);

/// \param places   a sample and its neighbors, nearest first
/// \param squared  squared distance of two of the places
/// \returns whether they lie along a parabola; then with its chord
template <class SquaredDistance>
bool lie_on_parabola(const std::array<Index, kCurveNeighbors + 1>& places,
                     const SquaredDistance& squared, Chord& chord) {
  // They are no farther off their chord, over its length: most need no fit for that.
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
  std::array<double, kPlaces> steps;
  for (int i = 0; i < kPlaces; ++i) {
    const double to_other = squared(chord.to, places[i]);
    const double along = (to_from[i] + longest - to_other) / (2 * chord.length);
    if (to_from[i] - along * along > kOffChord * kOffChord * longest) {
      return false;
    }
    steps[i] = along / chord.length - 0.5;
  }
  std::array<double, kPlaces*(kPlaces - 1) / 2> between;
  auto next = between.begin();
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < i; ++j) {
      *next++ = squared(places[i], places[j]);
    }
  }
  if (!fits_parabola(steps, between, chord.length)) {
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
