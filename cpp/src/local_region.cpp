// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/local_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "detail/convex_hull.hpp"
#include "detail/dispatch.hpp"
#include "detail/parallel.hpp"
#include "detail/tolerance.hpp"

namespace remanifold {
namespace {

using detail::ConvexHull;

constexpr Offset kBlock = 128;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Beyond this multiple of the neighborhood all samples are gone through instead of asking
/// for yet more neighbors.
constexpr Index kMaxGrowth = 16;
/// New halfspaces after which a region is brought up to date while going through all.
constexpr int kScanBatch = 64;

/// Uniform in [0, 1), by the finalizer of MurmurHash3 (Appleby, public domain).
double hash_to_unit(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15ULL;
  key ^= key >> 33;
  key *= 0xff51afd7ed558ccdULL;
  key ^= key >> 33;
  key *= 0xc4ceb9fe1a85ec53ULL;
  key ^= key >> 33;
  return static_cast<double>(key >> 11) * 0x1p-53;
}

/// The local regions of one thread, one sample after the other.
template <int K>
class RegionKernel {
  using Vector = Eigen::Matrix<double, K, 1>;
  using Square = Eigen::Matrix<double, K, K>;

 public:
  RegionKernel(const Samples& samples, const NeighborSearch& search,
               const Neighborhoods& neighborhoods, const TangentSpaces& tangents,
               const std::vector<double>& weights, const Execution& execution)
      : samples_(samples),
        neighborhoods_(neighborhoods),
        tangents_(tangents),
        weights_(weights),
        execution_(execution),
        dim_(K == Eigen::Dynamic ? tangents.dim : K),
        query_(search.query()),
        hull_(detail::make_convex_hull(dim_)),
        first_batch_(4 * dim_) {}

  void compute(Index x) {
    start(x);
    const Offset others = samples_.size() - 1;
    std::size_t done = 0;
    bool complete = false;  // the list holds every sample within the limit
    while (true) {
      add_nearest(done);
      const auto known = static_cast<Offset>(list_.size());
      if (complete || known == others || static_cast<Offset>(done) < known ||
          (done > 0 && squared_distances_[done - 1] > limit_)) {
        break;
      }
      const Offset count = std::min(2 * known, others);
      if (count > kMaxGrowth * std::max<Offset>(neighborhoods_.count, 8)) {
        scan_all();
        break;
      }
      query_->nearest(x, static_cast<Index>(count), limit_, grown_);
      if (static_cast<Offset>(grown_.size()) < known) {
        scan_all();  // only an approximate search forgets neighbors
        break;
      }
      complete = static_cast<Offset>(grown_.size()) < count;
      for (std::size_t i = list_.size(); i < grown_.size(); ++i) {
        list_.push_back(grown_[i].index);
      }
      measure_list(static_cast<std::size_t>(known));
    }
    neighbors_used_ += static_cast<Offset>(done);
  }

  double squared_radius() const { return squared_radius_; }

  void append_edge_set(std::vector<Index>& out) const {
    for (const Index id : hull_->vertices()) {
      out.push_back(halfspaces_[id].sample);
    }
  }

  /// \returns the number of simplices
  Offset append_star(std::vector<Index>& out) const {
    Offset count = 0;
    const std::vector<Index>& facets = hull_->facets();
    for (std::size_t f = 0; f < facets.size(); f += dim_) {
      const auto begin = facets.begin() + static_cast<Offset>(f);
      if (std::find(begin, begin + dim_, ConvexHull::kOrigin) != begin + dim_) {
        continue;
      }
      for (int i = 0; i < dim_; ++i) {
        out.push_back(halfspaces_[begin[i]].sample);
      }
      ++count;
    }
    return count;
  }

  Offset neighbors_used() const { return neighbors_used_; }
  Offset vacuous_constraints() const { return vacuous_constraints_; }
  double inner_product_seconds() const { return inner_product_seconds_; }

 private:
  /// <normal, lambda> <= offset
  struct Halfspace {
    Vector normal;
    double offset;
    Index sample;
  };

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  void start(Index x) {
    x_ = x;
    hull_->clear();
    halfspaces_.clear();
    corners_.clear();
    rays_.clear();
    squared_radius_ = kInfinity;
    limit_ = kInfinity;
    fresh_ = 0;
    can_filter_ = false;
    list_.assign(neighborhoods_.of(x), neighborhoods_.of(x) + neighborhoods_.count);
    measure_list(0);
  }

  /// Tangent coordinates and distances of list_[first ..].
  void measure_list(std::size_t first) {
    detail::Stopwatch watch;
    const auto size = static_cast<Eigen::Index>(list_.size());
    tangent_coordinates_.conservativeResize(dim(), size);
    squared_distances_.resize(list_.size());
    for (auto i = static_cast<Eigen::Index>(first); i < size; ++i) {
      squared_distances_[i] = measure(list_[i], tangent_coordinates_.col(i));
    }
    inner_product_seconds_ += watch.lap();
  }

  /// Cuts by the listed neighbors from `done` on, in growing batches, as far as the
  /// security radius reaches.
  void add_nearest(std::size_t& done) {
    std::size_t batch = first_batch_;
    while (done < list_.size() && squared_distances_[done] <= limit_) {
      const std::size_t end = std::min(list_.size(), done + batch);
      for (; done < end && squared_distances_[done] <= limit_; ++done) {
        add_halfspace(list_[done], squared_distances_[done],
                      tangent_coordinates_.col(static_cast<Eigen::Index>(done)));
      }
      update();
      batch += batch / 2;
    }
  }

  /// \returns the squared distance
  template <class Column>
  double measure(Index q, Column&& coordinates) {
    const auto row = static_cast<std::size_t>(x_);
    if (!samples_.has_points()) {
      const Index count = tangents_.num_coefficients;
      const Index* neighbors = neighborhoods_.of(x_);
      const double* coefficients = tangents_.coefficients.data() + row * dim() * count;
      coordinates.setZero();
      for (Index a = 0; a < count; ++a) {
        double product = 0;
        bool known = false;
        for (int k = 0; k < dim(); ++k) {
          const double coefficient = coefficients[k * count + a];
          if (coefficient != 0) {
            if (!known) {
              product = samples_.inner_product(x_, neighbors[a], q);
              known = true;
            }
            coordinates[k] += coefficient * product;
          }
        }
      }
      return samples_.squared_distance(x_, q);
    }
    const int ambient_dim = samples_.ambient_dim();
    const double* px = samples_.point(x_);
    const double* pq = samples_.point(q);
    const double* basis = tangents_.bases.data() + row * dim() * ambient_dim;
    if (ambient_dim <= kPlainLoopDim) {
      coordinates.setZero();
      for (int j = 0; j < ambient_dim; ++j) {
        const double difference = pq[j] - px[j];
        for (int k = 0; k < dim(); ++k) {
          coordinates[k] += basis[k * ambient_dim + j] * difference;
        }
      }
    } else {
      using Map = Eigen::Map<const Eigen::VectorXd>;
      difference_ = Map(pq, ambient_dim) - Map(px, ambient_dim);
      for (int k = 0; k < dim(); ++k) {
        coordinates[k] = Map(basis + k * ambient_dim, ambient_dim).dot(difference_);
      }
    }
    return samples_.squared_distance(x_, q);
  }

  void add_halfspace(Index q, double squared_distance, const Vector& normal) {
    if (normal.squaredNorm() <= detail::kVacuousSquaredSine * squared_distance) {
      ++vacuous_constraints_;
      return;
    }
    const double offset = (squared_distance + weights_[x_] - weights_[q]) / 2;
    if (can_filter_ && is_redundant(normal, offset)) {
      return;
    }
    const Vector dual = normal / offset;
    hull_->insert(dual.data(), static_cast<Index>(halfspaces_.size()));
    halfspaces_.push_back({normal, offset, q});
    ++fresh_;
  }

  /// Certainly cuts nothing off the region as of the last update.
  bool is_redundant(const Vector& normal, double offset) const {
    const double length = normal.norm();
    const double slack = detail::kRedundantSlack * (length * corner_radius_ + offset);
    for (const Vector& corner : corners_) {
      if (normal.dot(corner) > offset - slack) {
        return false;
      }
    }
    for (const Vector& ray : rays_) {
      if (normal.dot(ray) > -detail::kRedundantSlack * length) {
        return false;
      }
    }
    return true;
  }

  /// Corners and rays of the region from the facets of the hull.
  void update() {
    if (fresh_ == 0) {
      return;
    }
    fresh_ = 0;
    hull_->update();
    corners_.clear();
    rays_.clear();
    can_filter_ = hull_->full_dimensional();
    double squared_corner_radius = 0;
    const std::vector<Index>& facets = hull_->facets();
    for (std::size_t f = 0; f < facets.size(); f += dim_) {
      const Index* facet = facets.data() + f;
      if (std::find(facet, facet + dim_, ConvexHull::kOrigin) != facet + dim_) {
        rays_.push_back(ray_of(facet));
        can_filter_ = can_filter_ && rays_.back().allFinite();
      } else {
        corners_.push_back(corner_of(facet));
        can_filter_ = can_filter_ && corners_.back().allFinite();
        squared_corner_radius =
            std::max(squared_corner_radius, corners_.back().squaredNorm());
      }
    }
    corner_radius_ = std::sqrt(squared_corner_radius);
    const bool bounded = can_filter_ && rays_.empty();
    squared_radius_ = bounded ? squared_corner_radius : kInfinity;
    limit_ = 4 * (1 + detail::kSecuritySlack) * squared_radius_;
  }

  Vector corner_of(const Index* facet) const {
    Square normals(dim(), dim());
    Vector offsets(dim());
    for (int i = 0; i < dim(); ++i) {
      normals.row(i) = halfspaces_[facet[i]].normal.transpose();
      offsets[i] = halfspaces_[facet[i]].offset;
    }
    return normals.partialPivLu().solve(offsets);
  }

  /// Unit direction in which the region has no end: orthogonal to the facet's normals,
  /// away from all others.
  Vector ray_of(const Index* facet) const {
    Square normals = Square::Zero(dim(), dim());
    int row = 0;
    for (int i = 0; i < dim(); ++i) {
      if (facet[i] != ConvexHull::kOrigin) {
        normals.row(row++) = halfspaces_[facet[i]].normal.normalized().transpose();
      }
    }
    Vector ray;
    if constexpr (K == 1) {
      ray = Vector::Ones();
    } else if constexpr (K == 2) {
      ray = Vector(-normals(0, 1), normals(0, 0));
    } else if constexpr (K == 3) {
      ray = normals.row(0).cross(normals.row(1)).transpose().normalized();
    } else {
      ray = normals.fullPivLu().kernel().col(0).normalized();
    }
    double side = 0;
    for (const Index id : hull_->vertices()) {
      side += halfspaces_[id].normal.dot(ray) / halfspaces_[id].offset;
    }
    return side > 0 ? Vector(-ray) : ray;
  }

  void scan_all() {
    Vector normal(dim());
    for (Index q = 0; q < samples_.size(); ++q) {
      if (q % 4096 == 0) {
        execution_.poll();
      }
      if (q == x_) {
        continue;
      }
      const double squared_distance = measure(q, normal);
      if (squared_distance <= limit_) {
        add_halfspace(q, squared_distance, normal);
        if (fresh_ == kScanBatch) {
          update();
        }
      }
    }
    update();
    neighbors_used_ += samples_.size() - 1;
  }

  static constexpr int kPlainLoopDim = 16;

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  const TangentSpaces& tangents_;
  const std::vector<double>& weights_;
  const Execution& execution_;
  int dim_;
  std::unique_ptr<NeighborSearch::Query> query_;
  std::unique_ptr<ConvexHull> hull_;
  std::size_t first_batch_;

  Index x_ = 0;
  std::vector<Index> list_;  // neighbors, nearest first
  Eigen::Matrix<double, K, Eigen::Dynamic> tangent_coordinates_;
  std::vector<double> squared_distances_;
  std::vector<Neighbor> grown_;
  Eigen::VectorXd difference_;

  std::vector<Halfspace> halfspaces_;
  std::vector<Vector> corners_;
  std::vector<Vector> rays_;
  double corner_radius_ = 0;
  double squared_radius_ = kInfinity;
  double limit_ = kInfinity;  // squared distance beyond which no sample cuts
  int fresh_ = 0;             // halfspaces inserted since the last update
  bool can_filter_ = false;

  Offset neighbors_used_ = 0;
  Offset vacuous_constraints_ = 0;
  double inner_product_seconds_ = 0;
};

/// What one block of samples found, to be joined in order.
struct Block {
  std::vector<Index> edge_sets;
  std::vector<Index> stars;
};

template <int K>
void compute_all(const Samples& samples, const NeighborSearch& search,
                 const Neighborhoods& neighborhoods, const TangentSpaces& tangents,
                 const Execution& execution, LocalRegions& result) {
  using Kernel = RegionKernel<K>;
  const std::vector<double> weights = tie_weights(samples, neighborhoods);
  detail::PerThread<Kernel> kernels([&] {
    return Kernel(samples, search, neighborhoods, tangents, weights, execution);
  });
  const Offset n = samples.size();
  std::vector<Block> blocks((n + kBlock - 1) / kBlock);
  std::vector<Offset>& edge_counts = result.edge_sets.offsets;
  std::vector<Offset>& star_counts = result.star_offsets;
  edge_counts.assign(n + 1, 0);
  star_counts.assign(n + 1, 0);
  result.squared_radii.assign(n, std::numeric_limits<double>::quiet_NaN());

  detail::for_each_block(n, kBlock, execution, [&](Offset begin, Offset end) {
    Kernel& kernel = kernels.local();
    Block& block = blocks[begin / kBlock];
    for (Offset i = begin; i < end; ++i) {
      if (tangents.boundary[i] != 0) {
        continue;
      }
      kernel.compute(static_cast<Index>(i));
      const std::size_t before = block.edge_sets.size();
      kernel.append_edge_set(block.edge_sets);
      std::sort(block.edge_sets.begin() + static_cast<Offset>(before),
                block.edge_sets.end());
      edge_counts[i + 1] = static_cast<Offset>(block.edge_sets.size() - before);
      star_counts[i + 1] = kernel.append_star(block.stars);
      result.squared_radii[i] = kernel.squared_radius();
    }
  });
  for (const Kernel& kernel : kernels) {
    result.neighbors_used += kernel.neighbors_used();
    result.vacuous_constraints += kernel.vacuous_constraints();
    result.inner_product_seconds += kernel.inner_product_seconds();
  }
  std::partial_sum(edge_counts.begin(), edge_counts.end(), edge_counts.begin());
  std::partial_sum(star_counts.begin(), star_counts.end(), star_counts.begin());
  result.edge_sets.indices.reserve(edge_counts.back());
  result.stars.reserve(star_counts.back() * result.dim);
  for (Block& block : blocks) {
    result.edge_sets.indices.insert(result.edge_sets.indices.end(),
                                    block.edge_sets.begin(), block.edge_sets.end());
    result.stars.insert(result.stars.end(), block.stars.begin(), block.stars.end());
    block = {};
  }
}

}  // namespace

Index certifying_count(int dim) {
  constexpr Index counts[] = {0, 10, 30, 90, 250};
  return counts[std::min(dim, 4)];
}

std::vector<double> tie_weights(const Samples& samples,
                                const Neighborhoods& neighborhoods) {
  std::vector<double> weights(samples.size(), 0.0);
  if (neighborhoods.count == 0) {
    return weights;
  }
  for (Index i = 0; i < samples.size(); ++i) {
    weights[i] = detail::kTieWeight *
                 samples.squared_distance(i, neighborhoods.of(i)[0]) *
                 hash_to_unit(static_cast<std::uint64_t>(samples.input_index(i)));
  }
  return weights;
}

LocalRegions compute_local_regions(const Samples& samples, const NeighborSearch& search,
                                   const Neighborhoods& neighborhoods,
                                   const TangentSpaces& tangents,
                                   const Execution& execution) {
  LocalRegions result;
  result.dim = tangents.dim;
  detail::begin_step(execution, Step::kLocalRegions, samples.size());
  detail::dispatch_dim(tangents.dim, [&](auto k) {
    compute_all<decltype(k)::value>(samples, search, neighborhoods, tangents, execution,
                                    result);
  });
  return result;
}

}  // namespace remanifold
