// SPDX-License-Identifier: GPL-3.0-or-later
// Simplices as linear elements: volumes, frames and gradients, from the lengths of edges.
#pragma once

#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

/// Of M simplices of dimension K, one after the other.
struct LinearElements {
  std::vector<double> volumes;  ///< K-volumes, M; zero where flat
  /// Edges from the first vertex, as rows, in an orthonormal frame of the simplex,
  /// M x K x K; lower triangular, zero where flat.
  std::vector<double> frames;
  /// Inner products of the gradients of the barycentric coordinates, M x (K+1) x (K+1);
  /// zero where flat.
  std::vector<double> products;
  std::vector<std::uint8_t> flat;  ///< no gradients, M
};

/// A simplex is flat where the least eigenvalue of the inner products of its edges is no
/// more than this share of their mean. Squares of lengths are rounded to 2^-52: a third of
/// the digits are left.
constexpr double kFlatElement = 1.0 / (1ULL << 40U);

/// Squared lengths of the edges are taken from the coordinates. Time O(M (D + K) K^2).
/// \throws std::invalid_argument  a vertex that is none of the points
LinearElements linear_elements(const MatrixView& points, const SimplexArray& simplices);

/// \param dim      K, at least 1
/// \param squares  squared lengths of the edges of each simplex, of its pairs of vertices in
///                 lexicographic order: M x K (K+1) / 2
/// \throws std::invalid_argument  another number of lengths
LinearElements linear_elements(int dim, const std::vector<double>& squares);

/// The rotation nearest to each of M linear maps of K dimensions, in the least squares of
/// their entries; of a map that turns space over too.
/// \param maps  M x K x K, row by row
/// \throws std::invalid_argument  another number of entries
std::vector<double> nearest_rotations(int dim, const std::vector<double>& maps);

}  // namespace remanifold
