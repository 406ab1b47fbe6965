// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/sampling_quality.hpp"

#include "base/decompositions.hpp"
#include "base/parallel.hpp"
#include "base/parallel_csr.hpp"
#include "base/per_thread.hpp"
#include "base/small_systems.hpp"
#include "complex/simplex_rows.hpp"
#include "local/frame_fit.hpp"
#include "local/local_coordinates.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/input_numbering.hpp"
#include "remanifold/simplex_measures.hpp"
#include "remanifold/tangent_space.hpp"
#include "samples/known_distances.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace remanifold {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = 3.14159265358979323846;
constexpr Offset kBlock = 1024;
constexpr Offset kGroup = 64;
constexpr int kMaxDim = 16;
/// Neighbors nearer than this times h tell of noise rather than of the reach.
constexpr double kNearest = 0.75;
/// Folds count where both sides are at least this times h high: needles fold anywhere.
constexpr double kLeastHeight = 0.3;
/// Cosine at the facet below which that is not looked at: folds of less than 60 degrees.
constexpr double kAlmostFlat = -0.5;
/// A simplex lies in an empty ball, not beside one, where no barycentric coordinate of its
/// circumcenter is below this.
constexpr double kOutside = -0.1;
/// Samples nearer than h are joined by so many edges where the result is fine. On curves h
/// spans ten neighbors.
constexpr int hops(int dim) { return dim == 1 ? 12 : 3; }
/// Distance along a manifold over that in space, up to twice the reach (Boissonnat,
/// Lieutier and Wintraecken, The reach, metric distortion, geodesic convexity and the
/// variation of tangent spaces, 2019).
constexpr double kLongestWay = kPi / 2;
/// Samples that are looked at on ways as short.
constexpr std::size_t kMostOnWay = 256;

using Factors = detail::SymmetricFactors<Eigen::Dynamic, kMaxDim>;
using Small = Factors::Matrix;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDim, 1>;

/// The simplices at each vertex, in order.
detail::Ragged<Offset> stars_of(const SimplexArray& simplices, Index num_vertices,
                                const Execution& execution) {
  return detail::ragged_of<Offset>(num_vertices, execution, [&](const auto& add) {
    for (Offset s = 0; s < simplices.size(); ++s) {
      for (int i = 0; i < simplices.arity; ++i) {
        add(simplices[s][i], s);
      }
    }
  });
}

/// Columns of coordinates, one row a neighbor.
using Columns = Eigen::MatrixXd;

double dot(const double* a, const double* b, Eigen::Index count) {
  constexpr int kLanes = 4;
  double lanes[kLanes] = {};
  Eigen::Index i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += a[i + lane] * b[i + lane];
    }
  }
  double sum = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
  for (; i < count; ++i) {
    sum += a[i] * b[i];
  }
  return sum;
}

/// A quadratic fit of normal vectors over tangent coordinates.
/// \tparam K  or Eigen::Dynamic
template <int K>
class Quadric {
 public:
  explicit Quadric(int dim) : dim_(dim) {}

  /// \param tangents  m x K
  /// \param normals   m x r
  /// \returns the root mean square distance from the fit of the first `count` rows; NaN
  ///          where they are too few or lie badly
  double fit(const Columns& tangents, const Columns& normals, Eigen::Index count) {
    const int unknowns = num_unknowns();
    if (count <= unknowns) {
      return kNaN;
    }
    if (!fill_design(tangents, count)) {
      return kNaN;
    }
    gram_.resize(unknowns, unknowns);
    for (int i = 0; i < unknowns; ++i) {
      for (int j = 0; j <= i; ++j) {
        gram_(i, j) = dot(column(i), column(j), count);
      }
    }
    factors_.compute(gram_);
    double least = kInfinity;
    double largest = -kInfinity;
    for (int i = 0; i < unknowns; ++i) {
      least = std::min(least, factors_.pivot(i));
      largest = std::max(largest, factors_.pivot(i));
    }
    if (!(least > kFlatDesign * largest)) {
      return kNaN;
    }
    solution_.resize(unknowns, normals.cols());
    double rest = 0;
    for (Eigen::Index axis = 0; axis < normals.cols(); ++axis) {
      const double* normal = normals.data() + axis * normals.rows();
      for (int i = 0; i < unknowns; ++i) {
        solution_(i, axis) = dot(column(i), normal, count);
      }
      factors_.solve(solution_.col(axis));
      residual_.assign(normal, normal + count);
      for (int i = 0; i < unknowns; ++i) {
        const double* term = column(i);
        const double factor = solution_(i, axis);
        for (Eigen::Index row = 0; row < count; ++row) {
          residual_[row] -= factor * term[row];
        }
      }
      rest += dot(residual_.data(), residual_.data(), count);
    }
    return std::sqrt(rest / static_cast<double>(count - unknowns));
  }

  /// The largest norm of II(u, .) over unit vectors u, of the last fit.
  double curvature() {
    const auto row_of = [&](int i, int j) {
      const int high = std::max(i, j);
      return 1 + dim() + high * (high + 1) / 2 + std::min(i, j);
    };
    products_.resize(dim(), dim());
    for (int i = 0; i < dim(); ++i) {
      for (int j = 0; j <= i; ++j) {
        double sum = 0;
        for (int k = 0; k < dim(); ++k) {
          const double times = (i == k ? 2.0 : 1.0) * (j == k ? 2.0 : 1.0);
          double product = 0;
          for (Eigen::Index axis = 0; axis < solution_.cols(); ++axis) {
            product += solution_(row_of(i, k), axis) * solution_(row_of(j, k), axis);
          }
          sum += times * product;
        }
        products_(i, j) = sum;
      }
    }
    return std::sqrt(std::max(0.0, largest_eigenvalue())) / (size_ * size_);
  }

 private:
  static constexpr double kFlatDesign = 1e-10;
  static constexpr int kUnknowns =
      K == Eigen::Dynamic ? Eigen::Dynamic : 1 + K + K * (K + 1) / 2;
  using Factors = detail::SymmetricFactors<kUnknowns>;

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }
  int num_unknowns() const { return 1 + dim() + dim() * (dim() + 1) / 2; }
  double* column(int i) { return design_.data() + i * design_.rows(); }

  /// 1, the coordinates in units of the farthest, and their products.
  bool fill_design(const Columns& tangents, Eigen::Index count) {
    double farthest = 0;
    for (Eigen::Index row = 0; row < count; ++row) {
      double squared = 0;
      for (int i = 0; i < dim(); ++i) {
        squared += tangents(row, i) * tangents(row, i);
      }
      farthest = std::max(farthest, squared);
    }
    size_ = std::sqrt(farthest);
    if (!(size_ > 0)) {
      return false;
    }
    design_.resize(count, num_unknowns());
    std::fill_n(column(0), count, 1.0);
    int next = 1 + dim();
    for (int i = 0; i < dim(); ++i) {
      double* own = column(1 + i);
      for (Eigen::Index row = 0; row < count; ++row) {
        own[row] = tangents(row, i) / size_;
      }
      for (int j = 0; j <= i; ++j) {
        const double* other = column(1 + j);
        double* both = column(next++);
        for (Eigen::Index row = 0; row < count; ++row) {
          both[row] = own[row] * other[row];
        }
      }
    }
    return true;
  }

  /// Of the products, of which the lower triangle is filled.
  double largest_eigenvalue() {
    if (dim() == 1) {
      return products_(0, 0);
    }
    if (dim() == 2) {
      const double mean = (products_(0, 0) + products_(1, 1)) / 2;
      const double half = (products_(0, 0) - products_(1, 1)) / 2;
      return mean + std::hypot(half, products_(1, 0));
    }
    eigen_.compute(products_, Eigen::EigenvaluesOnly);
    return eigen_.eigenvalues()[dim() - 1];
  }

  int dim_;
  double size_ = 0;
  Columns design_;
  typename Factors::Matrix gram_;
  Factors factors_;
  Columns solution_;  // unknowns x r
  std::vector<double> residual_;
  Eigen::MatrixXd products_;
  detail::SymmetricEigen eigen_;
};

/// The complex with what is looked up in it.
struct Result {
  SimplexArray simplices;
  std::vector<FacetNumber> neighbors;
  detail::Ragged<Offset> stars;
  Csr adjacent;
  std::vector<std::uint8_t> rim;
};

/// The other vertices of the simplices at each vertex, ascending.
Csr adjacency_of(const SimplexArray& simplices, const detail::Ragged<Offset>& stars,
                 const Execution& execution) {
  Csr result;
  result.offsets.assign(stars.offsets.size(), 0);
  // Once for the numbers, once for the vertices.
  const auto go_through = [&](const auto& take) {
    detail::for_each_block_uncounted(
        stars.rows(), kBlock, execution, [&](Offset begin, Offset end) {
          std::vector<Index> others;
          for (Offset v = begin; v < end; ++v) {
            others.clear();
            for (const Offset* s = stars.begin(v); s != stars.end(v); ++s) {
              for (int i = 0; i < simplices.arity; ++i) {
                if (simplices[*s][i] != v) {
                  others.push_back(simplices[*s][i]);
                }
              }
            }
            detail::sort_few(others.begin(), others.end(), std::less<>());
            others.erase(std::unique(others.begin(), others.end()), others.end());
            take(v, others);
          }
        });
  };
  go_through([&](Offset v, const std::vector<Index>& others) {
    result.offsets[v + 1] = static_cast<Offset>(others.size());
  });
  std::partial_sum(result.offsets.begin(), result.offsets.end(),
                   result.offsets.begin());
  result.indices.resize(result.offsets.back());
  go_through([&](Offset v, const std::vector<Index>& others) {
    std::copy(others.begin(), others.end(), result.indices.begin() + result.offsets[v]);
  });
  return result;
}

std::vector<std::uint8_t> rim_of(const SimplexArray& simplices,
                                 const std::vector<FacetNumber>& neighbors,
                                 const detail::Ragged<Offset>& stars,
                                 const Execution& execution) {
  const int arity = simplices.arity;
  const auto mark = [&](auto& rim, std::uint8_t value, const auto& is_rim) {
    detail::for_each_block_uncounted(
        stars.rows(), kBlock, execution, [&](Offset begin, Offset end) {
          for (Offset v = begin; v < end; ++v) {
            for (const Offset* s = stars.begin(v); s != stars.end(v); ++s) {
              for (int i = 0; i < arity; ++i) {
                if (rim[v] == 0 && simplices[*s][i] != v && is_rim(*s, i)) {
                  rim[v] = value;
                }
              }
            }
          }
        });
  };
  std::vector<std::uint8_t> on_open(stars.rows(), 0);
  mark(on_open, 2, [&](Offset s, int i) { return neighbors[s * arity + i] == kOpen; });
  std::vector<std::uint8_t> rim = on_open;
  mark(rim, 1, [&](Offset s, int i) { return on_open[simplices[s][i]] == 2; });
  return rim;
}

/// Everything about one sample that needs its neighborhood. One for each thread.
template <int K, int D>
class QualityKernel {
 public:
  QualityKernel(const Samples& samples, const Neighborhoods& neighborhoods,
                const std::vector<double>& scales, const Result& result, int dim,
                Index narrow, Index wide, const double* tangents)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        scales_(scales),
        result_(result),
        dim_(dim),
        narrow_(narrow),
        wide_(wide),
        tangents_given_(tangents),
        distances_(samples, neighborhoods),
        frame_fit_(dim),
        quadric_(dim),
        seen_(samples.size(), -1) {}

  void measure(Index x, SamplingQuality& out) {
    find_strange(x, out);
    list_.assign(neighborhoods_.of(x), neighborhoods_.of(x) + wide_);
    const auto wide = static_cast<Eigen::Index>(wide_);
    places_.clear();
    for (Offset i = result_.adjacent.offsets[x]; i < result_.adjacent.offsets[x + 1];
         ++i) {
      const Index v = result_.adjacent.indices[i];
      const auto found = std::find(list_.begin(), list_.begin() + wide, v);
      if (found == list_.begin() + wide) {
        places_.push_back(static_cast<Offset>(list_.size()));
        list_.push_back(v);
      } else {
        places_.push_back(found - list_.begin());
      }
    }
    out.scatter[x] = out.wide_scatter[x] = out.curvature[x] = out.reach[x] = kNaN;
    out.tangent_share[x] = 0;
    if (narrow_ == 0 || !find_frame(x)) {
      return;
    }
    split_vectors();
    out.scatter[x] = quadric_.fit(tangents_, normals_, narrow_);
    out.wide_scatter[x] = quadric_.fit(tangents_, normals_, wide);
    if (!std::isnan(out.wide_scatter[x])) {
      out.curvature[x] = quadric_.curvature();
    }
    double inverse = 0;
    for (Eigen::Index i = 0; i < wide; ++i) {
      const double squared = squared_length(vectors_, i);
      if (squared >= kNearest * kNearest * scales_[x] * scales_[x]) {
        inverse =
            std::max(inverse, 2 * std::sqrt(squared_length(normals_, i)) / squared);
      }
    }
    // Rounding is not curvature.
    out.reach[x] = inverse * scales_[x] > kFlat ? 1 / inverse : kInfinity;
    out.tangent_share[x] = share_of_star(x);
  }

 private:
  static constexpr double kFlat = 1e-7;
  using Frame = typename detail::FrameFit<K, D>::Frame;
  using Square = Eigen::Matrix<double, K, K, 0, K == Eigen::Dynamic ? kMaxDim : K,
                               K == Eigen::Dynamic ? kMaxDim : K>;

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  static double squared_length(const Columns& rows, Eigen::Index i) {
    double sum = 0;
    for (Eigen::Index axis = 0; axis < rows.cols(); ++axis) {
      sum += rows(i, axis) * rows(i, axis);
    }
    return sum;
  }

  /// What of the vectors is tangent, in the frame, and what is normal.
  void split_vectors() {
    const Frame& frame = frame_;
    const Eigen::Index rows = vectors_.rows();
    tangents_.setZero(rows, dim());
    normals_ = vectors_;
    for (int k = 0; k < dim(); ++k) {
      double* tangent = tangents_.data() + k * rows;
      for (Eigen::Index axis = 0; axis < vectors_.cols(); ++axis) {
        const double* own = vectors_.data() + axis * rows;
        const double factor = frame(k, axis);
        for (Eigen::Index i = 0; i < rows; ++i) {
          tangent[i] += own[i] * factor;
        }
      }
    }
    for (int k = 0; k < dim(); ++k) {
      const double* tangent = tangents_.data() + k * rows;
      for (Eigen::Index axis = 0; axis < vectors_.cols(); ++axis) {
        double* normal = normals_.data() + axis * rows;
        const double factor = frame(k, axis);
        for (Eigen::Index i = 0; i < rows; ++i) {
          normal[i] -= tangent[i] * factor;
        }
      }
    }
  }

  bool find_frame(Index x) {
    const auto count = static_cast<Index>(list_.size());
    if constexpr (D == Eigen::Dynamic) {
      if (distances_.pay() && samples_.ambient_dim() > count) {
        coordinates_.load(distances_, x, list_.data(), count);
      } else {
        coordinates_.load(samples_, x, list_.data(), count);
      }
      vectors_ = coordinates_.vectors();
    } else {
      vectors_.resize(count, D);
      const double* px = samples_.point(x);
      for (Index i = 0; i < count; ++i) {
        const double* pq = samples_.point(list_[i]);
        for (int axis = 0; axis < D; ++axis) {
          vectors_(i, axis) = pq[axis] - px[axis];
        }
      }
    }
    if (tangents_given_ != nullptr) {
      frame_ = Eigen::Map<const Frame>(
          tangents_given_ + static_cast<std::size_t>(samples_.input_index(x)) * dim_ *
                                vectors_.cols(),
          dim_, vectors_.cols());
      return !std::isnan(frame_(0, 0));
    }
    frame_fit_.resize(narrow_, vectors_.cols());
    for (Index i = 0; i < narrow_; ++i) {
      for (Eigen::Index axis = 0; axis < vectors_.cols(); ++axis) {
        frame_fit_.coordinate(i, axis) = vectors_(i, axis);
      }
    }
    if (!frame_fit_.fit(true)) {
      return false;
    }
    frame_ = frame_fit_.frame();
    return true;
  }

  /// The nearest of the neighbors within h that is far along the result.
  void find_strange(Index x, SamplingQuality& out) {
    out.nearest_strange[x] = kInfinity;
    const Csr& adjacent = result_.adjacent;
    if (adjacent.size(x) == 0) {
      return;
    }
    unreached_.clear();
    for (Index k = 0; k < wide_; ++k) {
      const Index q = neighborhoods_.of(x)[k];
      const double squared = samples_.squared_distance(x, q);
      if (squared >= scales_[x] * scales_[x]) {
        break;
      }
      if (adjacent.size(q) > 0 && !within_two(x, q)) {
        unreached_.push_back({squared, q});
      }
    }
    if (unreached_.empty()) {
      return;
    }
    front_.assign(1, x);
    seen_[x] = x;
    for (int hop = 0; hop < hops(dim_) && !front_.empty(); ++hop) {
      next_.clear();
      for (const Index v : front_) {
        for (Offset i = adjacent.offsets[v]; i < adjacent.offsets[v + 1]; ++i) {
          const Index w = adjacent.indices[i];
          if (seen_[w] != x) {
            seen_[w] = x;
            next_.push_back(w);
          }
        }
      }
      front_.swap(next_);
    }
    for (const Neighbor& neighbor : unreached_) {
      if (seen_[neighbor.index] != x && !has_short_way(x, neighbor)) {
        out.nearest_strange[x] = std::sqrt(neighbor.squared_distance);
        return;
      }
    }
  }

  /// Whether edges lead from x to a neighbor on a way no longer than on a manifold with
  /// more reach than half their distance: many short ones where samples lie in rows.
  bool has_short_way(Index x, const Neighbor& neighbor) {
    const Csr& adjacent = result_.adjacent;
    const double most = kLongestWay * std::sqrt(neighbor.squared_distance);
    ways_.assign(1, {0, x});
    settled_.clear();
    while (!ways_.empty() && settled_.size() < kMostOnWay) {
      std::pop_heap(ways_.begin(), ways_.end(), std::greater<>());
      const auto [length, v] = ways_.back();
      ways_.pop_back();
      if (v == neighbor.index) {
        return true;
      }
      if (std::find(settled_.begin(), settled_.end(), v) != settled_.end()) {
        continue;
      }
      settled_.push_back(v);
      for (const Index* w = adjacent.begin(v); w != adjacent.end(v); ++w) {
        const double way = length + std::sqrt(samples_.squared_distance(v, *w));
        if (way + std::sqrt(samples_.squared_distance(*w, neighbor.index)) <= most) {
          ways_.emplace_back(way, *w);
          std::push_heap(ways_.begin(), ways_.end(), std::greater<>());
        }
      }
    }
    return false;
  }

  /// Whether two samples are joined by an edge or have a neighbor in common.
  bool within_two(Index x, Index q) const {
    const Csr& adjacent = result_.adjacent;
    const Index* a = adjacent.begin(x);
    const Index* b = adjacent.begin(q);
    while (a != adjacent.end(x) && b != adjacent.end(q)) {
      if (*a == *b || *a == q) {
        return true;
      }
      (*a < *b ? a : b) += 1;
    }
    return std::find(a, adjacent.end(x), q) != adjacent.end(x);
  }

  /// Volume of the star on the tangent space over its own volume.
  double share_of_star(Index x) {
    double flat = 0;
    double whole = 0;
    const int arity = dim() + 1;
    edges_.resize(dim(), dim());
    gram_.resize(dim(), dim());
    numbers_.resize(dim());
    const Index* adjacent = result_.adjacent.begin(x);
    for (const Offset* s = result_.stars.begin(x); s != result_.stars.end(x); ++s) {
      const Index* simplex = result_.simplices[*s];
      int row = 0;
      for (int i = 0; i < arity; ++i) {
        if (simplex[i] == x) {
          continue;
        }
        const Index* found = std::find(adjacent, result_.adjacent.end(x), simplex[i]);
        numbers_[row] = places_[found - adjacent];
        for (int k = 0; k < dim(); ++k) {
          edges_(row, k) = tangents_(numbers_[row], k);
        }
        for (int other = 0; other <= row; ++other) {
          double product = 0;
          for (Eigen::Index axis = 0; axis < vectors_.cols(); ++axis) {
            product += vectors_(numbers_[row], axis) * vectors_(numbers_[other], axis);
          }
          gram_(row, other) = gram_(other, row) = product;
        }
        ++row;
      }
      flat += std::abs(detail::determinant_of(edges_));
      whole += std::sqrt(std::max(0.0, detail::determinant_of(gram_)));
    }
    return whole > 0 ? std::min(1.0, flat / whole) : 0.0;
  }

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  const std::vector<double>& scales_;
  const Result& result_;
  int dim_;
  Index narrow_;
  Index wide_;
  const double* tangents_given_;
  detail::KnownDistances distances_;
  detail::LocalCoordinates coordinates_;
  detail::FrameFit<K, D> frame_fit_;
  Frame frame_;
  Quadric<K> quadric_;
  std::vector<Index> list_;     // neighbors, then adjacent samples that are none
  std::vector<Offset> places_;  // of the adjacent ones in it
  Columns vectors_;
  Columns tangents_;
  Columns normals_;
  Square edges_;
  Square gram_;
  std::vector<Offset> numbers_;
  std::vector<Neighbor> unreached_;
  std::vector<Index> seen_;                     // by whom last
  std::vector<std::pair<double, Index>> ways_;  // their length and end, as a heap
  std::vector<Index> settled_;
  std::vector<Index> front_;
  std::vector<Index> next_;
};

/// Radius of the empty ball that a simplex lies in; 0 where it lies beside it.
double empty_radius(const Samples& samples, const Index* simplex, int arity) {
  const int dim = arity - 1;
  if (dim == 2) {
    const double a = samples.squared_distance(simplex[0], simplex[1]);
    const double b = samples.squared_distance(simplex[0], simplex[2]);
    const double c = samples.squared_distance(simplex[1], simplex[2]);
    const double product = (a + b - c) / 2;
    const double determinant = a * b - product * product;
    // Barycentric coordinates times this.
    const double whole = 2 * determinant;
    const double least = std::min({c * (a + b - c), b * (a + c - b), a * (b + c - a)});
    return determinant > 0 && least > kOutside * whole
               ? std::sqrt(a * b * c / determinant) / 2
               : 0;
  }
  Small gram(dim, dim);
  SmallVector half(dim);
  for (int i = 0; i < dim; ++i) {
    for (int j = 0; j <= i; ++j) {
      gram(i, j) = gram(j, i) =
          samples.inner_product(simplex[0], simplex[i + 1], simplex[j + 1]);
    }
    half[i] = gram(i, i) / 2;
  }
  SmallVector weights = half;
  Factors factors;
  factors.compute(gram);
  factors.solve(weights);
  const double least = std::min(weights.minCoeff(), 1 - weights.sum());
  const double squared = weights.dot(half);
  return least > kOutside && squared > 0 ? std::sqrt(squared) : 0;
}

/// The median of h over the wide neighborhood: at the rim of a hole h itself is too large,
/// half of the neighbors are missing.
std::vector<double> undisturbed_scales(const std::vector<double>& scales,
                                       const Neighborhoods& neighborhoods, Index wide,
                                       const Execution& execution) {
  std::vector<double> result(scales.size());
  detail::for_each_block_uncounted(
      static_cast<Offset>(scales.size()), kBlock, execution,
      [&](Offset begin, Offset end) {
        std::vector<double> near(wide + 1);
        for (Offset i = begin; i < end; ++i) {
          const auto x = static_cast<Index>(i);
          near[0] = scales[x];
          for (Index k = 0; k < wide; ++k) {
            near[k + 1] = scales[neighborhoods.of(x)[k]];
          }
          const auto middle = near.begin() + static_cast<Offset>(near.size() / 2);
          std::nth_element(near.begin(), middle, near.end());
          result[x] = *middle;
        }
      });
  return result;
}

/// Folds and gaps, by simplex first.
class ShapeOfResult {
 public:
  ShapeOfResult(const Samples& samples, const std::vector<double>& scales,
                const std::vector<double>& undisturbed, const Result& result,
                const Execution& execution)
      : result_(result),
        arity_(result.simplices.arity),
        gaps_(result.simplices.size(), 0),
        folds_(result.neighbors.size(), 0) {
    detail::for_each_block_uncounted(
        result.simplices.size(), kBlock, execution, [&](Offset begin, Offset end) {
          const SimplexRuler ruler(samples, scales);
          std::vector<Index> facet(arity_);
          for (Offset s = begin; s < end; ++s) {
            const Index* simplex = result.simplices[s];
            if (rim_at(simplex, arity_)) {
              continue;
            }
            double scale = 0;
            for (int i = 0; i < arity_; ++i) {
              scale = std::max(scale, undisturbed[simplex[i]]);
            }
            gaps_[s] =
                static_cast<float>(empty_radius(samples, simplex, arity_) / scale);
            for (int i = 0; i < arity_; ++i) {
              measure_fold(ruler, s * arity_ + i, facet.data());
            }
          }
        });
  }

  void write(Index x, SamplingQuality& out) const {
    double gap = 0;
    double fold = 0;
    for (const Offset* s = result_.stars.begin(x); s != result_.stars.end(x); ++s) {
      gap = std::max<double>(gap, gaps_[*s]);
      for (int i = 0; i < arity_; ++i) {
        const FacetNumber f = *s * arity_ + i;
        if (result_.simplices[*s][i] != x) {
          fold = std::max<double>(fold, fold_of(f));
        }
      }
    }
    out.gap[x] = gap;
    out.fold[x] = fold;
  }

 private:
  bool rim_at(const Index* vertices, int count) const {
    return std::any_of(vertices, vertices + count,
                       [&](Index v) { return result_.rim[v] == 2; });
  }

  /// Kept with the lower of the two numbers of a facet.
  double fold_of(FacetNumber f) const {
    const FacetNumber other = result_.neighbors[f];
    return other < 0 ? 0 : folds_[std::min(f, other)];
  }

  void measure_fold(const SimplexRuler& ruler, FacetNumber f, Index* facet) {
    const FacetNumber other = result_.neighbors[f];
    if (other <= f) {
      return;
    }
    const Index* simplex = result_.simplices[f / arity_];
    const Index* opposite = result_.simplices[other / arity_];
    const Index apex = simplex[f % arity_];
    const Index other_apex = opposite[other % arity_];
    if (result_.rim[other_apex] == 2) {
      return;
    }
    copy_facet(result_.simplices, f, facet);
    const int dim = arity_ - 1;
    const double cosine = ruler.fold(facet, dim, apex, other_apex);
    if (cosine < kAlmostFlat) {
      folds_[f] = static_cast<float>(std::acos(-cosine) * 180 / kPi);
      return;
    }
    const double height = dim *
                          std::min(ruler.measure(simplex, arity_).volume,
                                   ruler.measure(opposite, arity_).volume) /
                          ruler.measure(facet, dim).volume;
    if (height >= kLeastHeight * ruler.scale(facet, dim)) {
      folds_[f] = static_cast<float>(std::acos(-cosine) * 180 / kPi);
    }
  }

  const Result& result_;
  int arity_;
  std::vector<float> gaps_;   // of simplices
  std::vector<float> folds_;  // of facets
};

template <class T>
void to_input(const std::vector<Index>& canonical, double factor,
              const Execution& execution, std::vector<T>& values) {
  std::vector<T> result(canonical.size());
  detail::for_each_block_uncounted(
      static_cast<Offset>(canonical.size()), kBlock, execution,
      [&](Offset begin, Offset end) {
        for (Offset i = begin; i < end; ++i) {
          result[i] = static_cast<T>(values[canonical[i]] * factor);
        }
      });
  values = std::move(result);
}

}  // namespace

SamplingQuality measure_quality(const Samples& samples, const NeighborSearch& search,
                                const SimplexArray& simplices,
                                const QualityOptions& options,
                                const Execution& execution) {
  const Index n = samples.size();
  const int dim = options.dim;
  Index narrow = options.num_neighbors > 0 ? options.num_neighbors : jet_neighbors(dim);
  Neighborhoods neighborhoods = find_neighborhoods(
      samples, search, std::max(2 * narrow, options.num_listed), execution);
  // Where the fits see other coordinates than D, they have frames of their own.
  const double* const tangents = samples.has_points() && samples.ambient_dim() <= narrow
                                     ? options.tangents
                                     : nullptr;
  const Index wide = std::min(2 * narrow, neighborhoods.count);
  narrow = std::min(narrow, neighborhoods.count);
  const std::vector<double> scales =
      local_scales(samples, neighborhoods, dim, execution);

  Result result;
  // In their order what is near in space is near in memory.
  result.simplices =
      detail::sorted_unique(to_canonical(samples, simplices, execution), execution);
  result.neighbors = facet_neighbors(result.simplices, n, execution);
  result.stars = stars_of(result.simplices, n, execution);
  result.adjacent = adjacency_of(result.simplices, result.stars, execution);
  result.rim = rim_of(result.simplices, result.neighbors, result.stars, execution);
  const ShapeOfResult shape(samples, scales,
                            undisturbed_scales(scales, neighborhoods, wide, execution),
                            result, execution);

  SamplingQuality out;
  for (std::vector<double>* values :
       {&out.scatter, &out.wide_scatter, &out.curvature, &out.reach, &out.tangent_share,
        &out.fold, &out.gap, &out.nearest_strange}) {
    values->resize(n);
  }
  out.spacing = scales;
  out.rim = result.rim;
  const auto run = [&](auto k, auto d) {
    using Kernel = QualityKernel<decltype(k)::value, decltype(d)::value>;
    detail::ThreadScratch<Kernel> kernels([&] {
      return Kernel(samples, neighborhoods, scales, result, dim, narrow, wide,
                    tangents);
    });
    detail::for_each_block_uncounted(n, kGroup, execution,
                                     [&](Offset begin, Offset end) {
                                       kernels.use([&](Kernel& kernel) {
                                         for (Offset i = begin; i < end; ++i) {
                                           const auto x = static_cast<Index>(i);
                                           kernel.measure(x, out);
                                           shape.write(x, out);
                                         }
                                       });
                                     });
  };
  // Surfaces in space, which are most of what is judged, have code of their own; for the
  // rest it would take longer to compile than it saves.
  if (dim == 2 && samples.has_points() && samples.ambient_dim() == 3) {
    run(std::integral_constant<int, 2>(), std::integral_constant<int, 3>());
  } else {
    run(std::integral_constant<int, Eigen::Dynamic>(),
        std::integral_constant<int, Eigen::Dynamic>());
  }

  const std::vector<Index> canonical = samples.canonical_indices();
  const double scale = samples.scale();
  for (std::vector<double>* lengths : {&out.spacing, &out.scatter, &out.wide_scatter,
                                       &out.reach, &out.nearest_strange}) {
    to_input(canonical, scale, execution, *lengths);
  }
  to_input(canonical, 1 / scale, execution, out.curvature);
  for (std::vector<double>* ratios : {&out.tangent_share, &out.fold, &out.gap}) {
    to_input(canonical, 1.0, execution, *ratios);
  }
  to_input(canonical, 1.0, execution, out.rim);
  if (options.num_listed > 0) {
    out.listed = std::move(neighborhoods);
    out.listed_numbers.resize(n);
    for (Index i = 0; i < n; ++i) {
      out.listed_numbers[i] = samples.input_index(i);
    }
  }
  return out;
}

}  // namespace remanifold
