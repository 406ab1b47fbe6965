// SPDX-License-Identifier: GPL-3.0-or-later
// The tangent basis tuple of a sample x (Freedman 2002, section 3.1): the first K + 1
// neighbors, in colexicographic order of ranks, whose simplex holds the projection of x
// onto its plane and the projection of no other neighbor.
//
// With the farthest member c as origin the plane is spanned by v_a = a - c, and the
// projection of x solves Psi lambda = psi. The search fixes members from the farthest to
// the nearest and eliminates each from the Gram matrix of all nearer candidates as it is
// fixed, so that the innermost loop, which runs over the last member, costs one division.
#pragma once

#include "base/tolerance.hpp"
#include "local/local_coordinates.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace remanifold::detail {

template <int K>
class EnclosingSimplex {
 public:
  explicit EnclosingSimplex(int dim) : dim_(K == Eigen::Dynamic ? dim : K) {
    levels_.resize(dim_ + 1);
    members_.resize(dim_ + 1);
    lambda_.resize(dim_ + 1);
  }

  /// Ranks of the tuple, ascending; nullptr where no tuple qualifies.
  /// `gram` holds the products <a - x, b - x> of the neighbors, nearest first.
  const Index* find(const RowMatrix& gram, const Execution& execution) {
    gram_ = &gram;
    count_ = static_cast<Index>(gram.rows());
    for (Index farthest = dim(); farthest < count_; ++farthest) {
      execution.poll();
      members_[dim()] = farthest;
      Level& level = levels_[dim()];
      level.resize(farthest);
      for (Index a = 0; a < farthest; ++a) {
        for (Index b = 0; b <= a; ++b) {
          level.product(a, b) = gram(a, b) - gram(a, farthest) - gram(b, farthest) +
                                gram(farthest, farthest);
        }
        level.target[a] = gram(farthest, farthest) - gram(a, farthest);
        level.length[a] = level.product(a, a);
      }
      if (fix_next(dim(), execution)) {
        return members_.data();
      }
    }
    return nullptr;
  }

 private:
  /// Products and right-hand sides of the candidates, the fixed members eliminated.
  struct Level {
    Index size = 0;
    std::vector<double> products;  // lower triangle
    std::vector<double> target;
    std::vector<double> length;  // squared, before any elimination

    void resize(Index new_size) {
      size = new_size;
      const auto n = static_cast<std::size_t>(new_size);
      if (target.size() < n) {
        products.resize(n * (n + 1) / 2);
        target.resize(n);
        length.resize(n);
      }
    }
    double& product(Index a, Index b) {
      return products[static_cast<std::size_t>(a) * (a + 1) / 2 + b];
    }
  };

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  static bool inside(double theta) {
    return theta >= -kEnclosureTolerance && theta <= 1 + kEnclosureTolerance;
  }

  /// Members at positions >= open are fixed, those below are to be found among the
  /// candidates of levels_[open].
  bool fix_next(int open, const Execution& execution) {
    Level& level = levels_[open];
    if (open == 1) {
      for (Index a = 0; a < level.size; ++a) {
        const double pivot = level.product(a, a);
        if (!(pivot > kDependentSquaredSine * level.length[a])) {
          continue;
        }
        lambda_[0] = level.target[a] / pivot;
        if (inside(lambda_[0])) {
          members_[0] = a;
          if (encloses_sample() && encloses_no_other()) {
            return true;
          }
        }
      }
      return false;
    }
    for (Index b = open - 1; b < level.size; ++b) {
      const double pivot = level.product(b, b);
      if (!(pivot > kDependentSquaredSine * level.length[b])) {
        continue;
      }
      if (dim() > 3) {
        execution.poll();
      }
      members_[open - 1] = b;
      Level& next = levels_[open - 1];
      next.resize(b);
      for (Index a = 0; a < b; ++a) {
        const double factor = level.product(b, a) / pivot;
        next.target[a] = level.target[a] - factor * level.target[b];
        next.length[a] = level.length[a];
        if (open == 2) {  // only the diagonal is looked at
          next.product(a, a) = level.product(a, a) - factor * level.product(b, a);
        } else {
          for (Index c = 0; c <= a; ++c) {
            next.product(a, c) = level.product(a, c) - factor * level.product(b, c);
          }
        }
      }
      if (fix_next(open - 1, execution)) {
        return true;
      }
    }
    return false;
  }

  /// Condition 1, the last coordinate being known: back substitution.
  bool encloses_sample() {
    for (int j = 1; j < dim(); ++j) {
      Level& level = levels_[j + 1];
      const Index b = members_[j];
      double rest = level.target[b];
      for (int k = 0; k < j; ++k) {
        rest -= level.product(b, members_[k]) * lambda_[k];
      }
      lambda_[j] = rest / level.product(b, b);
      if (!inside(lambda_[j])) {
        return false;
      }
    }
    return inside(origin_coordinate());
  }

  /// Barycentric coordinate of the farthest member.
  double origin_coordinate() const {
    double theta = 1;
    for (int j = 0; j < dim(); ++j) {
      theta -= lambda_[j];
    }
    return theta;
  }

  /// Condition 2, nearest neighbor first.
  bool encloses_no_other() {
    int next_member = 0;
    for (Index y = 0; y < count_; ++y) {
      if (next_member <= dim() && members_[next_member] == y) {
        ++next_member;
        continue;
      }
      if (encloses(y)) {
        return false;
      }
    }
    return true;
  }

  bool encloses(Index y) {
    const RowMatrix& gram = *gram_;
    const Index origin = members_[dim()];
    // Forward elimination in the order in which members were fixed...
    for (int j = dim() - 1; j >= 0; --j) {
      const Index a = members_[j];
      double value =
          gram(a, y) - gram(a, origin) - gram(y, origin) + gram(origin, origin);
      for (int k = dim() - 1; k > j; --k) {
        Level& level = levels_[k + 1];
        value -= level.product(members_[k], a) /
                 level.product(members_[k], members_[k]) * lambda_[k];
      }
      lambda_[j] = value;
    }
    // ...and back.
    for (int j = 0; j < dim(); ++j) {
      Level& level = levels_[j + 1];
      const Index b = members_[j];
      double value = lambda_[j];
      for (int k = 0; k < j; ++k) {
        value -= level.product(b, members_[k]) * lambda_[k];
      }
      lambda_[j] = value / level.product(b, b);
      if (!inside(lambda_[j])) {
        return false;
      }
    }
    return inside(origin_coordinate());
  }

  int dim_;
  Index count_ = 0;
  const RowMatrix* gram_ = nullptr;
  std::vector<Level> levels_;   // [j]: candidates once members j, .., K are fixed
  std::vector<Index> members_;  // ranks, ascending
  std::vector<double> lambda_;  // barycentric coordinates of members 0 .. K-1
};

}  // namespace remanifold::detail
