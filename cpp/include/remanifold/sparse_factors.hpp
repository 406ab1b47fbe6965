// SPDX-License-Identifier: GPL-3.0-or-later
// Sparse symmetric systems: one factorization for any number of right-hand sides.
#pragma once

#include "remanifold/types.hpp"

#include <memory>
#include <vector>

namespace remanifold {

/// L D L^T of a symmetric matrix, positive definite, in an order of minimum degree.
class SparseFactors {
 public:
  /// \param offsets  of the columns, of which each has its rows and their values
  /// \throws std::invalid_argument  a pivot that is zero
  SparseFactors(const std::vector<Index>& offsets, const std::vector<Index>& rows,
                const std::vector<double>& values);
  SparseFactors(SparseFactors&&) noexcept;
  SparseFactors& operator=(SparseFactors&&) noexcept;
  ~SparseFactors();

  Index size() const;
  /// Entries of the factor.
  Offset entries() const;
  /// \param right  as many as the matrix has rows
  std::vector<double> solve(const std::vector<double>& right) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace remanifold
