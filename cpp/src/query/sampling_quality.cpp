// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/sampling_quality.hpp"

#include "base/decompositions.hpp"
#include "base/parallel.hpp"
#include "base/parallel_csr.hpp"
#include "base/per_thread.hpp"
#include "base/prefetch.hpp"
#include "base/select_few.hpp"
#include "base/small_systems.hpp"
#include "complex/simplex_rows.hpp"
#include "local/frame_fit.hpp"
#include "local/local_coordinates.hpp"
#include "query/surface_fits.hpp"
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

/// Quadratic fits of normal vectors over tangent coordinates, to the nearest neighbors of a
/// sample and to twice as many: sums over the former are part of those over the latter.
/// \tparam K  or Eigen::Dynamic
template <int K>
class Quadrics {
 public:
  explicit Quadrics(int dim) : dim_(dim) {}

  /// \param tangents  m x K
  /// \param normals   m x r
  /// \param narrow    rows of the narrow fit; the wide one has all
  void fit(const Columns& tangents, const Columns& normals, Eigen::Index narrow) {
    const int unknowns = num_unknowns();
    const Eigen::Index wide = tangents.rows();
    scatter_ = wide_scatter_ = kNaN;
    const double narrow_size = farthest(tangents, narrow);
    size_ = std::max(narrow_size, farthest(tangents, wide));
    if (wide <= unknowns || !(size_ > 0)) {
      return;
    }
    fill_design(tangents);
    gram_.setZero(unknowns, unknowns);
    right_.setZero(unknowns, normals.cols());
    add_products(normals, 0, narrow);
    if (narrow > unknowns && narrow_size > 0) {
      scatter_ = solve(normals, narrow, size_ / narrow_size);
    }
    add_products(normals, narrow, wide);
    wide_scatter_ = solve(normals, wide, 1);
  }

  /// The root mean square distances from the fits; NaN where the rows are too few or lie
  /// badly.
  double scatter() const { return scatter_; }
  double wide_scatter() const { return wide_scatter_; }

  /// The largest norm of II(u, .) over unit vectors u, of the wide fit.
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
  static constexpr int kUnknowns =
      K == Eigen::Dynamic ? Eigen::Dynamic : 1 + K + K * (K + 1) / 2;
  using Factors = detail::SymmetricFactors<kUnknowns>;

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }
  int num_unknowns() const { return 1 + dim() + dim() * (dim() + 1) / 2; }
  const double* column(int i) const { return design_.data() + i * design_.rows(); }

  double farthest(const Columns& tangents, Eigen::Index count) const {
    double squared = 0;
    for (Eigen::Index row = 0; row < count; ++row) {
      double sum = 0;
      for (int i = 0; i < dim(); ++i) {
        sum += tangents(row, i) * tangents(row, i);
      }
      squared = std::max(squared, sum);
    }
    return std::sqrt(squared);
  }

  /// 1, the coordinates in units of the farthest, and their products.
  void fill_design(const Columns& tangents) {
    const Eigen::Index count = tangents.rows();
    design_.resize(count, num_unknowns());
    double* const first = design_.data();
    std::fill_n(first, count, 1.0);
    double* both = first + (1 + dim()) * count;
    const double unit = 1 / size_;
    for (int i = 0; i < dim(); ++i) {
      double* own = first + (1 + i) * count;
      const double* tangent = tangents.data() + i * count;
      for (Eigen::Index row = 0; row < count; ++row) {
        own[row] = tangent[row] * unit;
      }
      for (int j = 0; j <= i; ++j, both += count) {
        const double* other = first + (1 + j) * count;
        for (Eigen::Index row = 0; row < count; ++row) {
          both[row] = own[row] * other[row];
        }
      }
    }
  }

  /// Of the columns with each other and with the normals, over some rows.
  void add_products(const Columns& normals, Eigen::Index begin, Eigen::Index end) {
    const int unknowns = num_unknowns();
    const Eigen::Index count = end - begin;
    for (int i = 0; i < unknowns; ++i) {
      const double* own = column(i) + begin;
      for (int j = 0; j <= i; ++j) {
        gram_(i, j) += dot(own, column(j) + begin, count);
      }
      for (Eigen::Index axis = 0; axis < normals.cols(); ++axis) {
        const double* normal = normals.data() + axis * normals.rows() + begin;
        right_(i, axis) += dot(own, normal, count);
      }
    }
  }

  /// \param larger  the size that the columns are in units of, over that of these rows
  /// \returns the root mean square distance of the first `count` rows
  double solve(const Columns& normals, Eigen::Index count, double larger) {
    const int unknowns = num_unknowns();
    // In units of their own: whether the rows lie badly does not depend on others.
    scaled_ = gram_;
    solution_ = right_;
    if (larger != 1) {
      for (int i = 1; i < unknowns; ++i) {
        const double factor = i <= dim() ? larger : larger * larger;
        scaled_.row(i).head(i + 1) *= factor;
        scaled_.col(i).tail(unknowns - i) *= factor;
        solution_.row(i) *= factor;
      }
    }
    factors_.compute(scaled_);
    double least = kInfinity;
    double largest = -kInfinity;
    for (int i = 0; i < unknowns; ++i) {
      least = std::min(least, factors_.pivot(i));
      largest = std::max(largest, factors_.pivot(i));
    }
    if (!(least > detail::kFlatDesign * largest)) {
      return kNaN;
    }
    double rest = 0;
    residual_.resize(count);
    for (Eigen::Index axis = 0; axis < normals.cols(); ++axis) {
      factors_.solve(solution_.col(axis));
      for (int i = 1; i < unknowns; ++i) {
        solution_(i, axis) *= i <= dim() ? larger : larger * larger;
      }
      const double* const normal = normals.data() + axis * normals.rows();
      const double* const factors = solution_.data() + axis * unknowns;
      const double* const terms = design_.data();
      double* const residual = residual_.data();
      for (Eigen::Index row = 0; row < count; ++row) {
        double left = normal[row];
        for (int i = 0; i < unknowns; ++i) {
          left -= factors[i] * terms[i * design_.rows() + row];
        }
        residual[row] = left;
      }
      rest += dot(residual, residual, count);
    }
    return std::sqrt(rest / static_cast<double>(count - unknowns));
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
  double size_ = 0;  // of all rows
  double scatter_ = kNaN;
  double wide_scatter_ = kNaN;
  Columns design_;
  typename Factors::Matrix gram_;
  typename Factors::Matrix scaled_;
  Factors factors_;
  Columns right_;     // unknowns x r
  Columns solution_;  // likewise
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
  // Block by block, and then one behind the other.
  const Offset rows = stars.rows();
  std::vector<std::vector<Index>> blocks(
      static_cast<std::size_t>((rows + kBlock - 1) / kBlock));
  detail::for_each_block_uncounted(
      rows, kBlock, execution, [&](Offset begin, Offset end) {
        std::vector<Index>& all = blocks[begin / kBlock];
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
          result.offsets[v + 1] = static_cast<Offset>(others.size());
          all.insert(all.end(), others.begin(), others.end());
        }
      });
  std::partial_sum(result.offsets.begin(), result.offsets.end(),
                   result.offsets.begin());
  result.indices.resize(result.offsets.back());
  detail::for_each_block_uncounted(
      rows, kBlock, execution, [&](Offset begin, Offset /*end*/) {
        std::vector<Index>& all = blocks[begin / kBlock];
        std::copy(all.begin(), all.end(),
                  result.indices.begin() + result.offsets[begin]);
        all = {};
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
  if (std::find(neighbors.begin(), neighbors.end(), kOpen) == neighbors.end()) {
    return on_open;
  }
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
        quadrics_(dim),
        fits_(kFew ? narrow : 0, kFew ? wide : 0),
        seen_(samples.size(), -1) {}

  void measure(Index begin, Index end, SamplingQuality& out) {
    for (Index x = begin; x < end; ++x) {
      find_strange(x, out);
      out.scatter[x] = out.wide_scatter[x] = out.curvature[x] = out.reach[x] = kNaN;
      out.tangent_share[x] = 0;
    }
    if (narrow_ == 0) {
      return;
    }
    if constexpr (kFew) {
      for (; begin < end; begin += detail::SurfaceFits::kLanes) {
        measure_few(begin, std::min<Index>(detail::SurfaceFits::kLanes, end - begin),
                    out);
      }
    } else {
      for (; begin < end; ++begin) {
        measure_any(begin, out);
      }
    }
  }

 private:
  static constexpr Index kAhead = 8;  // samples whose tangent spaces are under way
  /// Surfaces in space: vectors are looked up nowhere, and have one normal coordinate.
  static constexpr bool kFew = K == 2 && D == 3;
  using Frame = typename detail::FrameFit<K, D>::Frame;
  using Square = Eigen::Matrix<double, K, K, 0, K == Eigen::Dynamic ? kMaxDim : K,
                               K == Eigen::Dynamic ? kMaxDim : K>;

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  /// Of surfaces in space, as many samples at once as there are lanes.
  void measure_few(Index first, Index count, SamplingQuality& out) {
    bool found[detail::SurfaceFits::kLanes] = {};
    for (int lane = 0; lane < detail::SurfaceFits::kLanes; ++lane) {
      const Index x = first + lane;
      found[lane] = lane < count && find_frame_in_space(x);
      if (!found[lane]) {
        fits_.leave_out(lane);
        continue;
      }
      out.tangent_share[x] = share_of_triangles(x);
      fits_.set_sample(lane, samples_.point(x), scales_[x], frame_.data());
      const Index* near = neighborhoods_.of(x);
      for (Index i = 0; i < wide_; ++i) {
        fits_.set_neighbor(lane, i, samples_.point(near[i]));
      }
    }
    fits_.fit();
    for (int lane = 0; lane < count; ++lane) {
      if (found[lane]) {
        const Index x = first + lane;
        out.scatter[x] = fits_.scatter(lane);
        out.wide_scatter[x] = fits_.wide_scatter(lane);
        out.curvature[x] = fits_.curvature(lane);
        out.reach[x] = fits_.reach(lane);
      }
    }
  }

  void measure_any(Index x, SamplingQuality& out) {
    expect(x);
    if (!load(x)) {
      return;
    }
    quadrics_.fit(tangents_, normals_, narrow_);
    out.scatter[x] = quadrics_.scatter();
    out.wide_scatter[x] = quadrics_.wide_scatter();
    if (!std::isnan(out.wide_scatter[x])) {
      out.curvature[x] = quadrics_.curvature();
    }
    // The largest of fractions, divided once.
    double rise = 0;
    double square = 1;
    const double least = detail::kNearest * detail::kNearest * scales_[x] * scales_[x];
    for (Eigen::Index i = 0; i < wide_; ++i) {
      const double normal = squared_length(normals_, i);
      if (squares_[i] >= least &&
          normal * (square * square) > rise * (squares_[i] * squares_[i])) {
        rise = normal;
        square = squares_[i];
      }
    }
    const double inverse = 2 * std::sqrt(rise) / square;
    // Rounding is not curvature.
    out.reach[x] = inverse * scales_[x] > detail::kFlat ? 1 / inverse : kInfinity;
    out.tangent_share[x] = share_of_star(x);
  }

  static double squared_length(const Columns& rows, Eigen::Index i) {
    double sum = 0;
    for (Eigen::Index axis = 0; axis < rows.cols(); ++axis) {
      sum += rows(i, axis) * rows(i, axis);
    }
    return sum;
  }

  /// \returns false where there is no frame
  bool find_frame_in_space(Index x) {
    expect(x);
    if (tangents_given_ != nullptr) {
      take_frame(x, 3);
    } else {
      const double* px = samples_.point(x);
      frame_fit_.resize(narrow_, 3);
      for (Index i = 0; i < narrow_; ++i) {
        const double* pq = samples_.point(neighborhoods_.of(x)[i]);
        for (int axis = 0; axis < 3; ++axis) {
          frame_fit_.coordinate(i, axis) = pq[axis] - px[axis];
        }
      }
      if (!frame_fit_.fit(true)) {
        return false;
      }
      frame_ = frame_fit_.frame();
    }
    return !std::isnan(frame_(0, 0));
  }

  /// The neighborhood in the frame, with the vectors to adjacent samples behind it.
  /// \returns false where there is no frame
  bool load(Index x) {
    list_.assign(neighborhoods_.of(x), neighborhoods_.of(x) + wide_);
    places_.clear();
    for (Offset i = result_.adjacent.offsets[x]; i < result_.adjacent.offsets[x + 1];
         ++i) {
      const Index v = result_.adjacent.indices[i];
      const auto found = std::find(list_.begin(), list_.begin() + wide_, v);
      if (found == list_.begin() + wide_) {
        places_.push_back(static_cast<Offset>(list_.size()));
        list_.push_back(v);
      } else {
        places_.push_back(found - list_.begin());
      }
    }
    if (!find_frame(x)) {
      return false;
    }
    split_vectors();
    squares_.resize(wide_);
    for (Index i = 0; i < wide_; ++i) {
      squares_[i] = squared_length(vectors_, i);
    }
    // Those of the neighborhood for the fits, all for the star.
    all_tangents_.swap(tangents_);
    tangents_ = all_tangents_.topRows(wide_);
    normals_.conservativeResize(wide_, Eigen::NoChange);
    return true;
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

  /// Tangent spaces by input number lie all over memory: that of a sample soon to come.
  void expect(Index x) const {
    x += kAhead;
    if (tangents_given_ != nullptr && x < samples_.size()) {
      const double* frame =
          tangents_given_ + static_cast<std::size_t>(samples_.input_index(x)) * dim_ *
                                samples_.ambient_dim();
      detail::prefetch(frame);
      detail::prefetch(frame + dim_ * samples_.ambient_dim() - 1);
    }
  }

  void take_frame(Index x, Eigen::Index ambient_dim) {
    frame_ = Eigen::Map<const Frame>(
        tangents_given_ +
            static_cast<std::size_t>(samples_.input_index(x)) * dim_ * ambient_dim,
        dim_, ambient_dim);
  }

  bool find_frame(Index x) {
    const auto count = static_cast<Index>(list_.size());
    if (distances_.pay() && samples_.ambient_dim() > count) {
      coordinates_.load(distances_, x, list_.data(), count);
    } else {
      coordinates_.load(samples_, x, list_.data(), count);
    }
    vectors_ = coordinates_.vectors();
    if (tangents_given_ != nullptr) {
      take_frame(x, vectors_.cols());
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
    if (std::find(a, adjacent.end(x), q) != adjacent.end(x)) {
      return true;
    }
    const Index* b = adjacent.begin(q);
    while (a != adjacent.end(x) && b != adjacent.end(q)) {
      if (*a == *b) {
        return true;
      }
      (*a < *b ? a : b) += 1;
    }
    return false;
  }

  /// As share_of_star().
  double share_of_triangles(Index x) const {
    double flat = 0;
    double whole = 0;
    const double* px = samples_.point(x);
    for (const Offset* s = result_.stars.begin(x); s != result_.stars.end(x); ++s) {
      const Index* triangle = result_.simplices[*s];
      const Index p = triangle[0] == x ? triangle[1] : triangle[0];
      const Index q = triangle[2] == x ? triangle[1] : triangle[2];
      double gram[3] = {};
      double ends[2][2] = {};
      for (int axis = 0; axis < 3; ++axis) {
        const double to_p = samples_.point(p)[axis] - px[axis];
        const double to_q = samples_.point(q)[axis] - px[axis];
        gram[0] += to_p * to_p;
        gram[1] += to_p * to_q;
        gram[2] += to_q * to_q;
        for (int k = 0; k < 2; ++k) {
          ends[0][k] += to_p * frame_(k, axis);
          ends[1][k] += to_q * frame_(k, axis);
        }
      }
      flat += std::abs(ends[0][0] * ends[1][1] - ends[0][1] * ends[1][0]);
      whole += std::sqrt(std::max(0.0, gram[0] * gram[2] - gram[1] * gram[1]));
    }
    return whole > 0 ? std::min(1.0, flat / whole) : 0.0;
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
          edges_(row, k) = all_tangents_(numbers_[row], k);
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
  Quadrics<K> quadrics_;
  detail::SurfaceFits fits_;
  std::vector<Index> list_;      // neighbors, then adjacent samples that are none
  std::vector<Offset> places_;   // of the adjacent ones in it
  std::vector<double> squares_;  // of the vectors to the neighbors
  Columns vectors_;
  Columns tangents_;      // to the neighbors
  Columns all_tangents_;  // to adjacent samples too
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
  detail::for_each_block_uncounted(static_cast<Offset>(scales.size()), kBlock,
                                   execution, [&](Offset begin, Offset end) {
                                     std::vector<double> near(wide + 1);
                                     detail::FewSelector selector;
                                     for (Offset i = begin; i < end; ++i) {
                                       const auto x = static_cast<Index>(i);
                                       near[0] = scales[x];
                                       for (Index k = 0; k < wide; ++k) {
                                         near[k + 1] = scales[neighborhoods.of(x)[k]];
                                       }
                                       result[x] =
                                           selector.select(near, near.size() / 2);
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

/// \param scratch  whose memory is the next one's
template <class T>
void to_input(const std::vector<Index>& canonical, double factor,
              const Execution& execution, std::vector<T>& values,
              std::vector<T>& scratch) {
  scratch.resize(canonical.size());
  detail::for_each_block_uncounted(
      static_cast<Offset>(canonical.size()), kBlock, execution,
      [&](Offset begin, Offset end) {
        for (Offset i = begin; i < end; ++i) {
          scratch[i] = static_cast<T>(values[canonical[i]] * factor);
        }
      });
  values.swap(scratch);
}

std::vector<Index> numbers_of(const Samples& samples) {
  std::vector<Index> numbers(samples.size());
  for (Index i = 0; i < samples.size(); ++i) {
    numbers[i] = samples.input_index(i);
  }
  return numbers;
}

}  // namespace

ListedNeighbors list_neighbors(const Samples& samples, const NeighborSearch& search,
                               Index count, const Execution& execution) {
  return {find_neighborhoods(samples, search, count, execution), numbers_of(samples)};
}

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
                                         const auto first = static_cast<Index>(begin);
                                         const auto last = static_cast<Index>(end);
                                         kernel.measure(first, last, out);
                                         for (Index x = first; x < last; ++x) {
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
  std::vector<double> scratch;
  for (std::vector<double>* lengths : {&out.spacing, &out.scatter, &out.wide_scatter,
                                       &out.reach, &out.nearest_strange}) {
    to_input(canonical, scale, execution, *lengths, scratch);
  }
  to_input(canonical, 1 / scale, execution, out.curvature, scratch);
  for (std::vector<double>* ratios : {&out.tangent_share, &out.fold, &out.gap}) {
    to_input(canonical, 1.0, execution, *ratios, scratch);
  }
  std::vector<std::uint8_t> flags;
  to_input(canonical, 1.0, execution, out.rim, flags);
  if (options.num_listed > 0) {
    out.listed = {std::move(neighborhoods), numbers_of(samples)};
  }
  return out;
}

}  // namespace remanifold
