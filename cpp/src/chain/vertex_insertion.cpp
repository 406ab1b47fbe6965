// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/vertex_insertion.hpp"

#include "base/sort_unique.hpp"
#include "base/tolerance.hpp"
#include "complex/editable_complex.hpp"

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace remanifold {
namespace {

/// Used neighbors around which a place is looked for.
constexpr Index kNeighbors = 8;
/// Simplices as near as the nearest, up to this factor, are compared by energy.
constexpr double kAsNear = 1.25;

/// Squared distance of samples to simplices, from inner products.
class SimplexDistance {
 public:
  explicit SimplexDistance(const Samples& samples) : samples_(samples) {}

  double squared(Index x, const Index* vertices, int count) {
    if (count == 1) {
      return samples_.squared_distance(x, vertices[0]);
    }
    const int dim = count - 1;
    Eigen::MatrixXd gram(dim, dim);
    Eigen::VectorXd right(dim);
    for (int i = 0; i < dim; ++i) {
      right[i] = samples_.inner_product(vertices[0], x, vertices[i + 1]);
      for (int j = 0; j <= i; ++j) {
        gram(i, j) = gram(j, i) =
            samples_.inner_product(vertices[0], vertices[i + 1], vertices[j + 1]);
      }
    }
    const Eigen::VectorXd weights = gram.colPivHouseholderQr().solve(right);
    const double first = 1 - weights.sum();
    if (first >= 0 && weights.minCoeff() >= 0) {
      return std::max(0.0, samples_.squared_distance(x, vertices[0]) -
                               2 * weights.dot(right) + weights.dot(gram * weights));
    }
    double best = std::numeric_limits<double>::infinity();
    std::vector<Index> face(dim);
    for (int leave = 0; leave < count; ++leave) {
      if (leave == 0 ? first < 0 : weights[leave - 1] < 0) {
        std::copy_n(vertices, leave, face.begin());
        std::copy(vertices + leave + 1, vertices + count, face.begin() + leave);
        best = std::min(best, squared(x, face.data(), dim));
      }
    }
    return best;
  }

 private:
  const Samples& samples_;
};

class Inserter {
 public:
  Inserter(const Samples& samples, const Neighborhoods& neighborhoods,
           const std::vector<double>& scales, SimplexArray simplices)
      : neighborhoods_(neighborhoods),
        scales_(scales),
        complex_(std::move(simplices), samples.size()),
        ruler_(samples, scales),
        distance_(samples),
        fills_space_(ruler_.fills_space(complex_.arity())) {}

  /// \returns false where all simplices around the neighbors are too far, or fill their
  ///          space and would not any more
  bool insert(Index x, double max_distance) {
    near_.clear();
    Index used = 0;
    for (Index k = 0; k < neighborhoods_.count && used < kNeighbors; ++k) {
      const std::vector<Offset>& star = complex_.star(neighborhoods_.of(x)[k]);
      near_.insert(near_.end(), star.begin(), star.end());
      used += star.empty() ? 0 : 1;
    }
    detail::sort_unique(near_);
    double nearest = std::numeric_limits<double>::infinity();
    double scale = 0;
    std::vector<double> distances;
    for (const Offset s : near_) {
      distances.push_back(distance_.squared(x, complex_[s], complex_.arity()));
      if (distances.back() < nearest) {
        nearest = distances.back();
        scale = ruler_.scale(complex_[s], complex_.arity());
      }
    }
    const double reach = max_distance * std::min(scale, scales_[x]);
    if (!(nearest <= reach * reach)) {
      return false;
    }
    best_energy_ = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < near_.size(); ++i) {
      if (distances[i] <= kAsNear * kAsNear * nearest) {
        compare_faces(x, near_[i]);
      }
    }
    if (!std::isfinite(best_energy_)) {
      return false;
    }
    subdivide(x);
    return true;
  }

  SimplexArray finish() { return complex_.finish(); }

 private:
  void compare_faces(Index x, Offset simplex) {
    const int arity = complex_.arity();
    std::vector<Index> face;
    for (unsigned subset = 1; subset < 1U << arity; ++subset) {
      face.clear();
      for (int i = 0; i < arity; ++i) {
        if ((subset >> i & 1U) != 0) {
          face.push_back(complex_[simplex][i]);
        }
      }
      if (face.size() < 2) {
        continue;
      }
      double energy = 0;
      for (const Offset s : complex_.simplices_on(face)) {
        if (fills_space_ && !keeps_side(s, face, x)) {
          energy = std::numeric_limits<double>::infinity();
          break;
        }
        energy -= ruler_.energy(complex_[s], arity);
        for (const Index out : face) {
          replace(s, out, x);
          energy += ruler_.energy(row_.data(), arity);
        }
      }
      if (energy < best_energy_) {
        best_energy_ = energy;
        best_face_ = face;
      }
    }
  }

  /// Whether the simplices that a sample on a face makes of one lie on its side.
  bool keeps_side(Offset s, const std::vector<Index>& face, Index x) {
    const int arity = complex_.arity();
    const double side = ruler_.orientation(complex_[s], arity);
    return std::all_of(face.begin(), face.end(), [&](Index out) {
      row_.assign(complex_[s], complex_[s] + arity);
      *std::find(row_.begin(), row_.end(), out) = x;
      return side * ruler_.relative_volume(row_.data(), arity) > detail::kFlatSimplex;
    });
  }

  /// The simplex with one vertex for another, sorted.
  void replace(Offset s, Index out, Index in) {
    row_.assign(complex_[s], complex_[s] + complex_.arity());
    *std::find(row_.begin(), row_.end(), out) = in;
    std::sort(row_.begin(), row_.end());
  }

  void subdivide(Index x) {
    for (const Offset s : complex_.simplices_on(best_face_)) {
      for (const Index out : best_face_) {
        replace(s, out, x);
        complex_.add(row_.data());
      }
      complex_.remove(s);
    }
  }

  const Neighborhoods& neighborhoods_;
  const std::vector<double>& scales_;
  detail::EditableComplex complex_;
  SimplexRuler ruler_;
  SimplexDistance distance_;
  bool fills_space_;
  std::vector<Offset> near_;
  std::vector<Index> row_;
  std::vector<Index> best_face_;
  double best_energy_ = 0;
};

}  // namespace

Insertion insert_vertices(const Samples& samples, const Neighborhoods& neighborhoods,
                          const std::vector<double>& scales, double max_distance,
                          const std::vector<Index>& kept_out, SimplexArray& simplices,
                          const Execution& execution) {
  Insertion result;
  std::vector<std::uint8_t> used(samples.size(), 0);
  for (const Index v : simplices.vertices) {
    used[v] = 1;
  }
  for (const Index v : kept_out) {
    used[v] = 1;
  }
  std::vector<Index> waiting;
  for (Index v = 0; v < samples.size(); ++v) {
    if (used[v] == 0) {
      waiting.push_back(v);
    }
  }
  if (waiting.empty() || simplices.size() == 0) {
    std::merge(waiting.begin(), waiting.end(), kept_out.begin(), kept_out.end(),
               std::back_inserter(result.outliers));
    return result;
  }
  Inserter inserter(samples, neighborhoods, scales, std::move(simplices));
  // What is inserted may bring those behind it within reach.
  for (bool progress = true; progress && !waiting.empty();) {
    progress = false;
    std::vector<Index> left;
    for (const Index v : waiting) {
      execution.poll();
      if (inserter.insert(v, max_distance)) {
        result.inserted.push_back(v);
        progress = true;
      } else {
        left.push_back(v);
      }
    }
    waiting.swap(left);
  }
  result.outliers = waiting;
  result.outliers.insert(result.outliers.end(), kept_out.begin(), kept_out.end());
  std::sort(result.outliers.begin(), result.outliers.end());
  std::sort(result.inserted.begin(), result.inserted.end());
  simplices = inserter.finish();
  return result;
}

}  // namespace remanifold
