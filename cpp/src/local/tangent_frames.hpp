// SPDX-License-Identifier: GPL-3.0-or-later
// Orthonormal bases in R^D from their coefficients.
#pragma once

#include "local/local_coordinates.hpp"
#include "remanifold/types.hpp"

#include <algorithm>

namespace remanifold::detail {

/// The rows sum_a coefficients[k, a] (q_a - x), made orthonormal once more: `coefficients`
/// knew the products only up to rounding.
/// \param point  number of a sample -> its coordinates
/// \param factor  coordinates are multiplied by it
template <class Point>
void write_frame(const Point& point, double factor, Index x, const Index* neighbors,
                 Index count, const double* coefficients, RowMatrix& basis) {
  constexpr Eigen::Index chunk = 512;
  const Eigen::Index dim = basis.cols();
  const double* px = point(x);
  double difference[chunk];
  basis.setZero();
  for (Eigen::Index first = 0; first < dim; first += chunk) {
    const Eigen::Index size = std::min(chunk, dim - first);
    for (Index a = 0; a < count; ++a) {
      const double* pq = point(neighbors[a]);
      for (Eigen::Index j = 0; j < size; ++j) {
        const double from = px[first + j];
        const double to = pq[first + j];
        // Where all agree, they may be too large to be scaled.
        difference[j] = to == from ? 0.0 : to * factor - from * factor;
      }
      for (Eigen::Index k = 0; k < basis.rows(); ++k) {
        const double coefficient = coefficients[k * count + a];
        if (coefficient != 0) {
          double* out = basis.row(k).data() + first;
          for (Eigen::Index j = 0; j < size; ++j) {
            out[j] += coefficient * difference[j];
          }
        }
      }
    }
  }
  orthonormalize(basis);
}

}  // namespace remanifold::detail
