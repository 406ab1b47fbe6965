// SPDX-License-Identifier: GPL-3.0-or-later
#include "local/tangent_frames.hpp"

#include "base/parallel.hpp"
#include "remanifold/tangent_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace remanifold {

std::vector<double> tangent_bases(MatrixView points, int dim,
                                  const double* coefficients, const Index* neighbors,
                                  Index count, double scale,
                                  const Execution& execution) {
  const Offset ambient_dim = points.cols;
  const Offset size = dim * ambient_dim;
  std::vector<double> bases(points.rows * size);
  const double factor = 1 / scale;
  const auto point = [&](Index i) { return points.row(i); };
  detail::begin_step(execution, Step::kTangentSpaces, points.rows);
  detail::for_each_block(points.rows, 8, execution, [&](Offset begin, Offset end) {
    detail::RowMatrix basis(dim, ambient_dim);
    for (Offset i = begin; i < end; ++i) {
      const double* own = coefficients + i * dim * count;
      if (std::isnan(own[0])) {
        basis.fill(std::numeric_limits<double>::quiet_NaN());
      } else {
        detail::write_frame(point, factor, static_cast<Index>(i), neighbors + i * count,
                            count, own, basis);
      }
      std::copy_n(basis.data(), size, bases.data() + i * size);
    }
  });
  return bases;
}

}  // namespace remanifold
