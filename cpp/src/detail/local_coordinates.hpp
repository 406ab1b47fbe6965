// SPDX-License-Identifier: GPL-3.0-or-later
// The neighborhood of one sample x as m vectors q - x in as few coordinates as hold them:
// the D given ones where D <= m, else (and where only products are known) those of a
// Cholesky decomposition of their m x m Gram matrix. What follows never sees D.
#pragma once

#include "remanifold/samples.hpp"

#include <Eigen/Core>

#include <vector>

namespace remanifold::detail {

using RowMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class LocalCoordinates {
 public:
  /// Reads the coordinates or products of the neighbors; the only part that costs D.
  void load(const Samples& samples, Index x, const Index* neighbors, Index count);

  Index count() const { return count_; }
  /// m x m products <a - x, b - x>
  const RowMatrix& gram();
  /// m x r coordinates, isometric
  const RowMatrix& vectors();
  /// Rows of combinations of the coordinate axes (K x r) -> combinations of the neighbor
  /// vectors (K x m).
  RowMatrix to_coefficients(const RowMatrix& rows);
  /// Combinations of the neighbor vectors -> vectors of R^D. Points only.
  void to_ambient(const RowMatrix& coefficients, RowMatrix& out) const;
  /// Whether vectors() are the D coordinates themselves.
  bool direct() const { return direct_; }

 private:
  void decompose_gram();

  Index count_ = 0;
  bool direct_ = false;
  bool has_gram_ = false;
  bool has_vectors_ = false;
  RowMatrix differences_;  // m x D, points only
  RowMatrix gram_;
  RowMatrix vectors_;
  std::vector<Index> pivots_;
};

/// Gram-Schmidt, twice, on the rows.
/// \returns false where a row depends on those before it
bool orthonormalize(RowMatrix& rows);
/// The same for rows that are combinations of vectors with the given Gram matrix.
bool orthonormalize(RowMatrix& rows, const RowMatrix& gram);

}  // namespace remanifold::detail
