// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/second_forms.hpp"

#include "base/csr.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace remanifold {
namespace {

constexpr Offset kBlock = 64;
constexpr int kEnough = 2;  // others of a fit, in coefficients
constexpr int kMostRings = 4;
constexpr int kTurns = 3;  // of fits, between which the tangent space is turned
/// Least pivot over largest diagonal entry of the normal equations of a fit.
constexpr double kDetermined = 1e-12;

/// Products of the coordinates of degree 1 to 3: by a factor and what comes before.
struct Monomial {
  int before;  // -1: none
  int axis;
};

std::vector<Monomial> monomials_of(int dim) {
  std::vector<Monomial> result;
  std::size_t begin = 0;
  for (int degree = 1; degree <= 3; ++degree) {
    const std::size_t end = result.size();
    if (degree == 1) {
      for (int axis = 0; axis < dim; ++axis) {
        result.push_back({-1, axis});
      }
      continue;
    }
    for (std::size_t before = begin; before < end; ++before) {
      for (int axis = result[before].axis; axis < dim; ++axis) {
        result.push_back({static_cast<int>(before), axis});
      }
    }
    begin = end;
  }
  return result;
}

class FitKernel {
 public:
  FitKernel(const MatrixView& points, const Csr& beside, int dim,
            const std::vector<Monomial>& monomials)
      : points_(points),
        beside_(beside),
        dim_(dim),
        monomials_(monomials),
        seen_(beside.rows(), -1) {}

  void fit(Index vertex, double* tangents, double* forms) {
    const auto ambient = static_cast<Eigen::Index>(points_.cols);
    const auto size = static_cast<Eigen::Index>(monomials_.size());
    std::fill(tangents, tangents + dim_ * ambient,
              std::numeric_limits<double>::quiet_NaN());
    std::fill(forms, forms + dim_ * dim_ * ambient,
              std::numeric_limits<double>::quiet_NaN());
    gather(vertex);
    const auto count = static_cast<Eigen::Index>(near_.size());
    if (count < kEnough * size || dim_ > ambient) {
      return;
    }
    const double radius = load(vertex);
    find_principal();
    bool known = false;
    for (int turn = 0; turn < kTurns; ++turn) {
      along_.noalias() = steps_ * frame_;
      across_.noalias() = steps_ - along_ * frame_.transpose();
      for (Eigen::Index i = 0; i < count; ++i) {
        const double shadow = along_.row(i).norm();
        if (shadow > 0) {
          along_.row(i) *= chords_[i] / shadow;
        }
      }
      terms_.resize(count, size);
      for (Eigen::Index place = 0; place < size; ++place) {
        const Monomial& own = monomials_[place];
        if (own.before < 0) {
          terms_.col(place) = along_.col(own.axis);
        } else {
          terms_.col(place) = terms_.col(own.before).cwiseProduct(along_.col(own.axis));
        }
      }
      known = solve();
      if (!known) {
        break;
      }
      if (turn < kTurns - 1) {
        frame_ += coefficients_.topRows(dim_).transpose();
        orthonormalize();
      }
    }
    if (!known) {
      return;
    }
    for (int i = 0; i < dim_; ++i) {
      for (Eigen::Index d = 0; d < ambient; ++d) {
        tangents[i * ambient + d] = frame_(d, i);
      }
    }
    for (Eigen::Index place = dim_; place < size; ++place) {
      const int before = monomials_[place].before;
      if (before >= dim_) {
        break;  // of degree 3
      }
      const int i = monomials_[before].axis;
      const int j = monomials_[place].axis;
      const double factor = (i == j ? 2.0 : 1.0) / radius;
      for (Eigen::Index d = 0; d < ambient; ++d) {
        forms[(i * dim_ + j) * ambient + d] = forms[(j * dim_ + i) * ambient + d] =
            coefficients_(place, d) * factor;
      }
    }
  }

 private:
  /// Others within so many rings as have enough.
  void gather(Index vertex) {
    near_.clear();
    seen_[vertex] = vertex;
    const auto wanted = static_cast<std::size_t>(kEnough) * monomials_.size();
    std::size_t begin = 0;
    for (int ring = 0; ring < kMostRings && near_.size() < wanted; ++ring) {
      const std::size_t end = near_.size();
      const auto add_beside = [&](Index v) {
        for (const Index* other = beside_.begin(v); other != beside_.end(v); ++other) {
          if (seen_[*other] != vertex) {
            seen_[*other] = vertex;
            near_.push_back(*other);
          }
        }
      };
      if (ring == 0) {
        add_beside(vertex);
      }
      for (std::size_t i = begin; ring > 0 && i < end; ++i) {
        add_beside(near_[i]);
      }
      begin = ring > 0 ? end : 0;
    }
    // The order of rounding does not depend on that of the simplices.
    std::sort(near_.begin(), near_.end());
  }

  /// Steps to the others, in units of the longest.
  double load(Index vertex) {
    const auto count = static_cast<Eigen::Index>(near_.size());
    const auto ambient = static_cast<Eigen::Index>(points_.cols);
    steps_.resize(count, ambient);
    const double* own = points_.row(vertex);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double* other = points_.row(near_[i]);
      for (Eigen::Index d = 0; d < ambient; ++d) {
        steps_(i, d) = other[d] - own[d];
      }
    }
    chords_ = steps_.rowwise().norm();
    const double radius = chords_.maxCoeff() > 0 ? chords_.maxCoeff() : 1.0;
    steps_ /= radius;
    chords_ /= radius;
    return radius;
  }

  /// The widest directions, by whichever square matrix is smaller.
  void find_principal() {
    if (steps_.cols() <= steps_.rows()) {
      square_.noalias() = steps_.transpose() * steps_;
      solver_.compute(square_);
      frame_ = solver_.eigenvectors().rightCols(dim_).rowwise().reverse();
    } else {
      square_.noalias() = steps_ * steps_.transpose();
      solver_.compute(square_);
      frame_.noalias() =
          steps_.transpose() *
          solver_.eigenvectors().rightCols(dim_).rowwise().reverse().eval();
    }
    orthonormalize();
  }

  /// Gram and Schmidt, twice: columns may be nearly parallel.
  void orthonormalize() {
    for (int i = 0; i < dim_; ++i) {
      for (int round = 0; round < 2; ++round) {
        for (int j = 0; j < i; ++j) {
          frame_.col(i) -= frame_.col(j).dot(frame_.col(i)) * frame_.col(j);
        }
      }
      const double size = frame_.col(i).norm();
      if (size > 0) {
        frame_.col(i) /= size;
      }
    }
  }

  /// Least squares by the normal equations; false where not all is determined.
  bool solve() {
    const Eigen::Index size = terms_.cols();
    normal_.noalias() = terms_.transpose() * terms_;
    coefficients_.noalias() = terms_.transpose() * across_;
    const double least = kDetermined * normal_.diagonal().maxCoeff();
    for (Eigen::Index j = 0; j < size; ++j) {
      const double pivot = normal_(j, j) - normal_.row(j).head(j).squaredNorm();
      if (!(pivot > least)) {
        return false;
      }
      const double root = std::sqrt(pivot);
      normal_(j, j) = root;
      for (Eigen::Index i = j + 1; i < size; ++i) {
        normal_(i, j) =
            (normal_(i, j) - normal_.row(i).head(j).dot(normal_.row(j).head(j))) / root;
      }
    }
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j < i; ++j) {
        coefficients_.row(i) -= normal_(i, j) * coefficients_.row(j);
      }
      coefficients_.row(i) /= normal_(i, i);
    }
    for (Eigen::Index i = size - 1; i >= 0; --i) {
      for (Eigen::Index j = i + 1; j < size; ++j) {
        coefficients_.row(i) -= normal_(j, i) * coefficients_.row(j);
      }
      coefficients_.row(i) /= normal_(i, i);
    }
    return true;
  }

  const MatrixView& points_;
  const Csr& beside_;
  int dim_;
  const std::vector<Monomial>& monomials_;
  std::vector<Index> seen_;
  std::vector<Index> near_;
  Eigen::MatrixXd steps_;   // others x D, in units of the longest
  Eigen::VectorXd chords_;  // their lengths
  Eigen::MatrixXd frame_;   // D x K, orthonormal
  Eigen::MatrixXd along_;
  Eigen::MatrixXd across_;
  Eigen::MatrixXd terms_;
  Eigen::MatrixXd normal_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> coefficients_;
  Eigen::MatrixXd square_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver_;
};

}  // namespace

SecondForms second_forms(const MatrixView& points, const SimplexArray& edges, int dim,
                         const std::vector<Index>& vertices,
                         const Execution& execution) {
  const auto check = [&](const std::vector<Index>& given) {
    for (const Index vertex : given) {
      if (vertex < 0 || vertex >= points.rows) {
        throw std::invalid_argument("vertex " + std::to_string(vertex) + " of " +
                                    std::to_string(points.rows) + " points");
      }
    }
  };
  check(edges.vertices);
  check(vertices);
  const Csr beside = detail::csr_of(points.rows, [&](const auto& add) {
    for (Offset e = 0; e < edges.size(); ++e) {
      add(edges[e][0], edges[e][1]);
      add(edges[e][1], edges[e][0]);
    }
  });
  const std::vector<Monomial> monomials = monomials_of(dim);
  const auto count = static_cast<Offset>(vertices.size());
  const Offset tangent = dim * points.cols;
  SecondForms result;
  result.tangents.resize(count * tangent);
  result.forms.resize(count * tangent * dim);
  detail::ThreadScratch<FitKernel> kernels(
      [&] { return FitKernel(points, beside, dim, monomials); });
  detail::for_each_block(count, kBlock, execution, [&](Offset begin, Offset end) {
    kernels.use([&](FitKernel& kernel) {
      for (Offset i = begin; i < end; ++i) {
        kernel.fit(vertices[i], result.tangents.data() + i * tangent,
                   result.forms.data() + i * tangent * dim);
      }
    });
  });
  return result;
}

}  // namespace remanifold
