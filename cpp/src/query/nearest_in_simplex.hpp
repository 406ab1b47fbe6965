// SPDX-License-Identifier: GPL-3.0-or-later
// The point of one simplex nearest to another point, degenerate simplices included:
// Wolfe's active sets (Finding the nearest point in a polytope, Mathematical Programming
// 11, 1976) in an orthonormal frame of the simplex.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace remanifold::detail {

/// In four sums, which the compiler may not make of one.
inline double dot(const double* a, const double* b, int size) {
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
  int i = 0;
  for (; i + 4 <= size; i += 4) {
    s0 += a[i] * b[i];
    s1 += a[i + 1] * b[i + 1];
    s2 += a[i + 2] * b[i + 2];
    s3 += a[i + 3] * b[i + 3];
  }
  for (; i < size; ++i) {
    s0 += a[i] * b[i];
  }
  return (s0 + s1) + (s2 + s3);
}

/// \tparam K  dimension of the simplices; negative where it is known at run time only
template <int K>
class NearestInSimplex {
 public:
  NearestInSimplex(int dim, int ambient_dim)
      : dim_(dim),
        ambient_dim_(ambient_dim),
        edges_(static_cast<std::size_t>(dim + 1) * ambient_dim),
        squared_lengths_(dim + 1),
        corners_(static_cast<std::size_t>(dim + 1) * (dim + 1)),
        target_(dim + 1),
        point_(dim + 1),
        weights_(dim + 1),
        affine_(dim + 1),
        columns_(static_cast<std::size_t>(dim + 1) * (dim + 1)),
        triangle_(static_cast<std::size_t>(dim + 1) * (dim + 1)),
        active_(dim + 1),
        order_(dim + 1) {}

  /// \param vertices  K+1 pointers to D coordinates
  /// \returns the squared distance; the barycentric coordinates are in weights() then
  double solve(const double* query, const double* const* vertices) {
    const double off_span = reduce(query, vertices);
    return off_span + minimize();
  }

  /// Not negative, of sum 1.
  const std::vector<double>& weights() const { return weights_; }

 private:
  /// What is left of a vector after a projection is rounding below this share of it.
  static constexpr double kRounding = 0x1p-49;

  int dim() const { return K >= 0 ? K : dim_; }
  double& corner(int vertex, int axis) { return corners_[vertex * dim() + axis]; }
  double* edge(int i) {
    return edges_.data() + static_cast<std::size_t>(i) * ambient_dim_;
  }

  /// Coordinates of corners and query in an orthonormal frame of the simplex at its first
  /// vertex: modified Gram-Schmidt, the longest edge first, the query as one more column,
  /// which makes its coordinates as good as theirs (Bjorck, 1967).
  /// \returns the squared distance of the query from the span
  double reduce(const double* query, const double* const* vertices) {
    const int k = dim();
    double* const rest = edge(k);
    double longest = 0;
    for (int i = 0; i < k; ++i) {
      double* const own = edge(i);
      for (int a = 0; a < ambient_dim_; ++a) {
        own[a] = vertices[i + 1][a] - vertices[0][a];
      }
      squared_lengths_[i] = squared_norm(own, ambient_dim_);
      longest = std::max(longest, squared_lengths_[i]);
    }
    for (int a = 0; a < ambient_dim_; ++a) {
      rest[a] = query[a] - vertices[0][a];
    }
    std::iota(order_.begin(), order_.end(), 0);
    std::fill(corners_.begin(), corners_.end(), 0.0);
    size_ = std::sqrt(longest);
    for (rank_ = 0; rank_ < k; ++rank_) {
      int pivot = rank_;
      for (int i = rank_ + 1; i < k; ++i) {
        if (squared_lengths_[order_[i]] > squared_lengths_[order_[pivot]]) {
          pivot = i;
        }
      }
      std::swap(order_[rank_], order_[pivot]);
      const int next = order_[rank_];
      if (!(squared_lengths_[next] > kRounding * kRounding * longest)) {
        break;
      }
      const double length = std::sqrt(squared_lengths_[next]);
      double* const axis = edge(next);
      for (int a = 0; a < ambient_dim_; ++a) {
        axis[a] /= length;
      }
      corner(next + 1, rank_) = length;
      for (int i = rank_ + 1; i < k; ++i) {
        double* const other = edge(order_[i]);
        corner(order_[i] + 1, rank_) = remove(axis, other, ambient_dim_);
        squared_lengths_[order_[i]] = squared_norm(other, ambient_dim_);
      }
      target_[rank_] = remove(axis, rest, ambient_dim_);
    }
    return squared_norm(rest, ambient_dim_);
  }

  /// The squared distance within the frame. Each round lowers it; the limit on their number
  /// guards against rounding only, and the point is on the simplex at any time.
  double minimize() {
    start_at_nearest_corner();
    for (int round = 0; round < 20 * dim(); ++round) {
      const int entering = find_entering();
      if (entering < 0) {
        break;
      }
      active_[num_active_++] = entering;
      while (solve_affine()) {
        if (step()) {
          break;
        }
      }
    }
    update_point();
    double sum = 0;
    for (int a = 0; a < rank_; ++a) {
      const double away = target_[a] - point_[a];
      sum += away * away;
    }
    return sum;
  }

  void start_at_nearest_corner() {
    double least = 0;
    for (int i = 0; i <= dim(); ++i) {
      double squared = 0;
      for (int a = 0; a < rank_; ++a) {
        const double away = corner(i, a) - target_[a];
        squared += away * away;
      }
      if (i == 0 || squared < least) {
        least = squared;
        active_[0] = i;
      }
      weights_[i] = 0;
    }
    num_active_ = 1;
    weights_[active_[0]] = 1;
  }

  void update_point() {
    for (int a = 0; a < rank_; ++a) {
      point_[a] = 0;
      for (int i = 0; i < num_active_; ++i) {
        point_[a] += weights_[active_[i]] * corner(active_[i], a);
      }
    }
  }

  /// The corner towards which the distance falls fastest; -1 where it falls towards none by
  /// more than rounding.
  int find_entering() {
    if (num_active_ > rank_) {
      return -1;
    }
    update_point();
    double length = size_;
    for (int a = 0; a < rank_; ++a) {
      length = std::max(length, std::abs(target_[a]));
    }
    double steepest = kRounding * length;
    int entering = -1;
    for (int i = 0; i <= dim(); ++i) {
      const auto end = active_.begin() + num_active_;
      if (std::find(active_.begin(), end, i) != end) {
        continue;
      }
      double product = 0;
      double squared = 0;
      for (int a = 0; a < rank_; ++a) {
        const double step = corner(i, a) - point_[a];
        product += (target_[a] - point_[a]) * step;
        squared += step * step;
      }
      const double slope = squared > 0 ? product / std::sqrt(squared) : 0;
      if (slope > steepest) {
        steepest = slope;
        entering = i;
      }
    }
    return entering;
  }

  /// Weights of the point nearest to the target on the affine hull of the active corners,
  /// by least squares as in reduce().
  /// \returns false where these corners are dependent, which only rounding can bring about
  bool solve_affine() {
    const int count = num_active_ - 1;
    const int stride = dim() + 1;
    const auto column = [&](int i) { return columns_.data() + i * stride; };
    for (int i = 0; i <= count; ++i) {
      for (int a = 0; a < rank_; ++a) {
        const double end = i < count ? corner(active_[i + 1], a) : target_[a];
        column(i)[a] = end - corner(active_[0], a);
      }
    }
    for (int j = 0; j < count; ++j) {
      double removed = 0;
      for (int i = 0; i < j; ++i) {
        removed += triangle_[i * stride + j] * triangle_[i * stride + j];
      }
      const double squared = squared_norm(column(j), rank_);
      if (!(squared > kRounding * kRounding * (removed + squared))) {
        return false;
      }
      const double length = std::sqrt(squared);
      triangle_[j * stride + j] = length;
      for (int a = 0; a < rank_; ++a) {
        column(j)[a] /= length;
      }
      for (int i = j + 1; i <= count; ++i) {
        triangle_[j * stride + i] = remove(column(j), column(i), rank_);
      }
    }
    affine_[0] = 1;
    for (int j = count - 1; j >= 0; --j) {
      double value = triangle_[j * stride + count];
      for (int i = j + 1; i < count; ++i) {
        value -= triangle_[j * stride + i] * affine_[i + 1];
      }
      affine_[j + 1] = value / triangle_[j * stride + j];
      affine_[0] -= affine_[j + 1];
    }
    return true;
  }

  /// Goes from the weights to the affine ones, as far as the simplex reaches.
  /// \returns whether it reached them; else some corner has left
  bool step() {
    double fraction = 1;
    int leaving = -1;
    for (int i = 0; i < num_active_; ++i) {
      const double now = weights_[active_[i]];
      const double share = affine_[i] > 0 ? 1 : now > 0 ? now / (now - affine_[i]) : 0;
      if (affine_[i] <= 0 && (leaving < 0 || share < fraction)) {
        fraction = share;
        leaving = i;
      }
    }
    int kept = 0;
    double sum = 0;
    for (int i = 0; i < num_active_; ++i) {
      double& weight = weights_[active_[i]];
      weight =
          i == leaving ? 0 : std::max(0.0, weight + fraction * (affine_[i] - weight));
      if (weight > 0) {
        sum += weight;
        active_[kept++] = active_[i];
      }
    }
    num_active_ = kept;
    for (int i = 0; i < kept; ++i) {
      weights_[active_[i]] /= sum;
    }
    return leaving < 0;
  }

  static double squared_norm(const double* vector, int size) {
    return dot(vector, vector, size);
  }

  /// Takes the component along a unit vector away, and returns it.
  static double remove(const double* axis, double* vector, int size) {
    const double product = dot(axis, vector, size);
    for (int a = 0; a < size; ++a) {
      vector[a] -= product * axis[a];
    }
    return product;
  }

  int dim_;
  int ambient_dim_;
  std::vector<double> edges_;  // K rows of D, then what is left of the query
  std::vector<double> squared_lengths_;
  std::vector<double> corners_;  // in the frame
  std::vector<double> target_;   // the query in the frame
  std::vector<double> point_;    // the nearest so far in the frame
  std::vector<double> weights_;  // of it
  std::vector<double> affine_;   // of the nearest on the hull of the active corners
  std::vector<double> columns_;
  std::vector<double> triangle_;
  std::vector<int> active_;
  std::vector<int> order_;
  double size_ = 0;
  int rank_ = 0;
  int num_active_ = 0;
};

}  // namespace remanifold::detail
