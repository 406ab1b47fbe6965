// SPDX-License-Identifier: GPL-3.0-or-later
// The one squared distance of the core: all searches must agree to the last bit, or ties
// would not be ties.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace remanifold::detail {

/// With fewer coordinates their squares are added up one after the other.
constexpr int kInOneSum = 8;

/// \param worst  beyond this the value does not matter, as long as it is larger
inline double squared_distance(const double* a, const double* b, std::size_t dim,
                               double worst = std::numeric_limits<double>::infinity()) {
  if (dim < std::size_t{kInOneSum}) {
    double sum = 0;
    for (std::size_t i = 0; i < dim; ++i) {
      const double d = a[i] - b[i];
      sum += d * d;
    }
    return sum;
  }
  constexpr std::size_t stride = 32;  // coordinates between looks at `worst`
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
  std::size_t i = 0;
  while (i + 4 <= dim) {
    const std::size_t end = std::min(i + stride, dim - dim % 4);
    for (; i < end; i += 4) {
      const double d0 = a[i] - b[i];
      const double d1 = a[i + 1] - b[i + 1];
      const double d2 = a[i + 2] - b[i + 2];
      const double d3 = a[i + 3] - b[i + 3];
      s0 += d0 * d0;
      s1 += d1 * d1;
      s2 += d2 * d2;
      s3 += d3 * d3;
    }
    // Rounded sums of squares never decrease.
    if ((s0 + s1) + (s2 + s3) > worst) {
      return (s0 + s1) + (s2 + s3);
    }
  }
  for (; i < dim; ++i) {
    const double d = a[i] - b[i];
    s0 += d * d;
  }
  return (s0 + s1) + (s2 + s3);
}

}  // namespace remanifold::detail
