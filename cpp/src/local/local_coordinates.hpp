// SPDX-License-Identifier: GPL-3.0-or-later
// The neighborhood of one sample x as m vectors q - x in as few coordinates as hold them:
// the D given ones where D <= m, else (and where only products are known) those of a
// Cholesky decomposition of their m x m Gram matrix. What follows never sees D.
#pragma once

#include "base/tolerance.hpp"
#include "remanifold/samples.hpp"
#include "samples/known_distances.hpp"

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace remanifold::detail {

using RowMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class LocalCoordinates {
 public:
  /// Reads the coordinates or products of the neighbors; the only part that costs D.
  void load(const Samples& samples, Index x, const Index* neighbors, Index count);
  /// The same in many coordinates from distances that are known already; to_ambient() has
  /// nothing to work on then.
  void load(const KnownDistances& distances, Index x, const Index* neighbors,
            Index count);

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

/// Gram-Schmidt, twice, on the rows, by inner(i, j) of two of them.
/// \returns false where a row depends on those before it
template <class Rows, class Inner>
bool gram_schmidt(Rows& rows, const Inner& inner) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double before = inner(i, i);
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index j = 0; j < i; ++j) {
        rows.row(i) -= inner(i, j) * rows.row(j);
      }
    }
    const double after = inner(i, i);
    if (!(after > kDependentSquaredSine * before)) {
      return false;
    }
    rows.row(i) /= std::sqrt(after);
  }
  return true;
}

template <class Rows>
bool orthonormalize(Rows& rows) {
  return gram_schmidt(rows, [&](Eigen::Index i, Eigen::Index j) {
    return rows.row(i).dot(rows.row(j));
  });
}
/// The same for rows that are combinations of vectors with the given Gram matrix.
bool orthonormalize(RowMatrix& rows, const RowMatrix& gram);

}  // namespace remanifold::detail
