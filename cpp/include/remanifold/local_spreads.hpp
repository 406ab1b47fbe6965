// SPDX-License-Identifier: GPL-3.0-or-later
// How far neighborhoods of several sizes spread along their principal directions: the
// standard deviations of local principal component analysis.
//
// Cost O(N m D min(D, m)), memory O(N) for the result.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

/// Of samples with a row of neighbors each.
struct NeighborRows {
  const Index* samples = nullptr;    ///< one a row
  const Index* neighbors = nullptr;  ///< `width` a row, nearest first
  Offset count = 0;
  Index width = 0;
};

/// \param sizes  of the neighborhoods, ascending, at most `rows.width`; the sample counts
///               besides
/// \returns for each row and each size the `num_spreads` largest standard deviations,
///          descending; 0 where there are fewer directions
std::vector<double> local_spreads(const MatrixView& points, const NeighborRows& rows,
                                  const std::vector<Index>& sizes, int num_spreads,
                                  const Execution& execution = {});

/// Neighbors by which lie_on_curve() judges.
inline constexpr Index kCurveNeighbors = 8;

/// \param rows  of kCurveNeighbors and more
/// \returns for each row whether the sample and its kCurveNeighbors nearest lie along a
///          parabola, up to a tenth of their spread
/// \throws std::invalid_argument  shorter rows
std::vector<std::uint8_t> lie_on_curve(const MatrixView& points,
                                       const NeighborRows& rows,
                                       const Execution& execution = {});

}  // namespace remanifold
