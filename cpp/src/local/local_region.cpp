// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/local_region.hpp"

#include "base/assertions.hpp"
#include "base/dispatch.hpp"
#include "base/mix_bits.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "base/tolerance.hpp"
#include "base/waves.hpp"
#include "local/region.hpp"
#include "local/tangent_frames.hpp"
#include "remanifold/verify.hpp"
#include "samples/distance.hpp"
#include "samples/known_distances.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>

namespace remanifold {
namespace {

/// Samples of one task; fewer where each may take seconds.
constexpr Offset block_size(int dim) { return dim < 4 ? 128 : dim == 4 ? 32 : 1; }
/// Samples whose coordinates are read together.
constexpr Offset kGroup = 32;

/// Beyond this multiple of the neighborhood the region is certified corner by corner
/// instead of asking for yet more neighbors.
constexpr Index kMaxGrowth = 4;
/// Samples asked for around a corner at first, and at most this times the root of N: where
/// more are as far from it as x, all are gone through.
constexpr Offset kCornerCount = 8;
constexpr double kMaxCornerShare = 4;
/// Samples measured at a time while going through all, and new halfspaces after which the
/// region is brought up to date.
constexpr Index kScanBlock = 1024;
constexpr int kScanBatch = 64;

/// From this K on the regions of all samples have no more than so many corners together,
/// each at a cost of K 2^K: those of one sample among many have ten thousand with K = 7,
/// and a hundred thousand with K = 8, where some tens of samples come to an end.
constexpr int kManyCornersDim = 8;
constexpr Offset kMostCornerWork = 200'000'000;
constexpr Offset kFreeCorners = 10'000;

/// Neighbors within the security radius of most samples drawn at random (measured; the
/// means are 5, 15, 44 and 135).
Index typical_count(int dim) {
  constexpr Index counts[] = {0, 10, 20, 50, 150};
  return counts[std::min(dim, 4)];
}

/// Uniform in [0, 1).
double hash_to_unit(std::uint64_t key) {
  return static_cast<double>(detail::mix_bits(key + 0x9e3779b97f4a7c15ULL) >> 11) *
         0x1p-53;
}

std::uint64_t bits_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// A number in [0, 1) for each position, so that the order of the samples decides no tie.
/// Axes on which all agree do not matter, nor where all lie together: a difference is
/// rounded from its exact value, which is the same wherever moving has not rounded.
class PositionHash {
 public:
  explicit PositionHash(const Samples& samples)
      : samples_(samples), axes_(samples.varying_axes()) {}

  double operator()(Index i) const {
    const double* point = samples_.point(i);
    const std::vector<double>& lowest = samples_.lowest();
    std::uint64_t lanes[kLanes] = {1, 2, 3, 4};
    for (std::size_t j = 0; j < axes_.size(); ++j) {
      const std::uint64_t bits = bits_of(point[axes_[j]] - lowest[axes_[j]]);
      std::uint64_t& lane = lanes[j % kLanes];
      lane = (lane ^ bits ^ bits >> 32) * 0x9e3779b97f4a7c15ULL;
    }
    std::uint64_t key = 0;
    for (const std::uint64_t lane : lanes) {
      key = (key ^ lane ^ lane >> 29) * 0xff51afd7ed558ccdULL;
    }
    return hash_to_unit(key);
  }

 private:
  static constexpr std::size_t kLanes = 4;

  const Samples& samples_;
  std::vector<int> axes_;
};

/// The same where there are no positions: by the distances to all others, whatever their
/// order. Only among what a symmetry of the samples exchanges do input numbers decide.
double hash_of_distances(const Samples& samples, Index i) {
  constexpr double share_of_numbers = 0x1p-13;
  std::uint64_t sum = 0;
  for (Index j = 0; j < samples.size(); ++j) {
    sum += detail::mix_bits(bits_of(samples.squared_distance(i, j)));
  }
  const auto number = static_cast<std::uint64_t>(samples.input_index(i));
  return hash_to_unit(sum) + share_of_numbers * hash_to_unit(number);
}

void refuse_many_corners(int dim, Offset corners, Index num_samples) {
  if (dim < kManyCornersDim) {
    return;
  }
  const Offset most =
      std::max((kMostCornerWork >> std::min(dim, 32)) / dim, kFreeCorners);
  if (corners > most) {
    throw std::length_error(
        "dim is " + std::to_string(dim) + ", and the local regions of " +
        std::to_string(num_samples) + " samples have more than " +
        std::to_string(most) + " corners: give fewer samples, or a smaller dim");
  }
}

/// The local regions of one thread, one sample after the other.
template <int K>
class RegionKernel {
  using Region = detail::Region<K>;
  using Vector = typename Region::Vector;
  using Corner = typename Region::Corner;

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
        distances_(samples, neighborhoods),
        query_(search.query(execution)),
        is_exact_(search.method() != SearchMethod::kApproximate),
        first_batch_(4 * dim_),
        ahead_(is_cheap() ? 0 : std::min(neighborhoods.count, typical_count(dim_))),
        largest_weight_(*std::max_element(weights.begin(), weights.end())),
        max_corner_count_(static_cast<Offset>(
            kMaxCornerShare * std::sqrt(static_cast<double>(samples.whole_size())))),
        region_(dim_,
                samples.whole_size() > detail::kManySamples
                    ? detail::kEndOfRegionAmongMany
                    : detail::kEndOfRegion,
                execution) {}

  /// Reads the coordinates of the nearest neighbors of a few samples ahead of compute(),
  /// so that large D does not slow down what comes between.
  void read_ahead(Index begin, Index end) {
    if (ahead_ == 0) {
      return;
    }
    const detail::Timed timed(coordinate_seconds_);
    ahead_begin_ = begin;
    ahead_coordinates_.resize(dim(), static_cast<Eigen::Index>(end - begin) * ahead_);
    ahead_distances_.resize(static_cast<std::size_t>(end - begin) * ahead_);
    for (Index x = begin; x < end; ++x) {
      if (tangents_.boundary[x] != 0) {
        continue;
      }
      x_ = x;
      for (Index k = 0; k < ahead_; ++k) {
        const Index slot = (x - begin) * ahead_ + k;
        ahead_distances_[slot] =
            measure(neighborhoods_.of(x)[k], ahead_coordinates_.col(slot));
      }
    }
  }

  void compute(Index x) {
    start(x);
    const Offset others = samples_.size() - 1;
    std::size_t done = 0;
    bool complete = false;  // the list holds every sample within the limit
    while (!add_nearest(done) && !complete) {
      const auto known = static_cast<Offset>(list_.size());
      if (known == others) {
        break;
      }
      const Offset count = std::min(2 * known, others);
      if (query_->looks_at_all() ||
          count > kMaxGrowth * std::max<Offset>(neighborhoods_.count, 8)) {
        if (!certify_corners()) {
          scan_all();
        }
        break;
      }
      nearest(static_cast<Index>(count));
      if (static_cast<Offset>(grown_.size()) < known) {
        scan_all();  // only an approximate search forgets neighbors
        break;
      }
      complete = static_cast<Offset>(grown_.size()) < count;
      for (std::size_t i = list_.size(); i < grown_.size(); ++i) {
        list_.push_back(grown_[i].index);
      }
    }
    neighbors_used_ += static_cast<Offset>(done);
  }

  Region& region() { return region_; }
  Offset neighbors_used() const { return neighbors_used_; }
  Offset vacuous_constraints() const { return vacuous_constraints_; }
  double coordinate_seconds() const { return coordinate_seconds_; }

 private:
  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  /// Whether coordinates cost so little that they are neither read ahead nor timed.
  bool is_cheap() const {
    return samples_.has_points() && samples_.ambient_dim() <= kPlainLoopDim;
  }

  void start(Index x) {
    x_ = x;
    region_.restart();
    list_.assign(neighborhoods_.of(x), neighborhoods_.of(x) + neighborhoods_.count);
    make_room();
    if (ahead_ > 0) {
      const Index first = (x - ahead_begin_) * ahead_;
      tangent_coordinates_.leftCols(ahead_) =
          ahead_coordinates_.middleCols(first, ahead_);
      std::copy_n(ahead_distances_.data() + first, ahead_, squared_distances_.data());
    }
    measured_ = static_cast<std::size_t>(ahead_);
  }

  void make_room() {
    const auto size = static_cast<Eigen::Index>(list_.size());
    if (tangent_coordinates_.cols() < size) {
      tangent_coordinates_.conservativeResize(dim(), size);
      squared_distances_.resize(list_.size());
    }
  }

  /// Tangent coordinates and distances of the list up to `last`.
  void measure_list(std::size_t last) {
    if (measured_ >= last) {
      return;
    }
    make_room();
    const auto measure_all = [&] {
      for (; measured_ < last; ++measured_) {
        squared_distances_[measured_] =
            measure(list_[measured_],
                    tangent_coordinates_.col(static_cast<Eigen::Index>(measured_)));
      }
    };
    if (is_cheap()) {
      measure_all();
    } else {
      const detail::Timed timed(coordinate_seconds_);
      measure_all();
    }
  }

  /// Cuts by the listed neighbors from `done` on, in growing batches, as far as the
  /// security radius reaches.
  /// \returns false where it reaches beyond the list
  bool add_nearest(std::size_t& done) {
    std::size_t batch = first_batch_;
    while (done < list_.size()) {
      const std::size_t end = std::min(list_.size(), done + batch);
      measure_list(end);
      for (; done < end && squared_distances_[done] <= region_.limit(); ++done) {
        add_halfspace(list_[done], squared_distances_[done],
                      tangent_coordinates_.col(static_cast<Eigen::Index>(done)));
      }
      if (done < end) {
        region_.update();
        if (squared_distances_[done] > region_.limit()) {
          return true;
        }
      }
      batch += batch / 2;
    }
    region_.update();
    return done > 0 && squared_distances_[done - 1] > region_.limit();
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
    if (tangents_.bases.empty()) {
      return measure_by_distances(q, coordinates);
    }
    const int ambient_dim = samples_.ambient_dim();
    const double* px = samples_.point(x_);
    const double* pq = samples_.point(q);
    const double* basis = tangents_.bases.data() + row * dim() * ambient_dim;
    if (K == 2 && ambient_dim == 3) {
      const double d0 = pq[0] - px[0];
      const double d1 = pq[1] - px[1];
      const double d2 = pq[2] - px[2];
      coordinates[0] = basis[0] * d0 + basis[1] * d1 + basis[2] * d2;
      coordinates[1] = basis[3] * d0 + basis[4] * d1 + basis[5] * d2;
      return d0 * d0 + d1 * d1 + d2 * d2;
    }
    if (ambient_dim <= kPlainLoopDim) {
      coordinates.setZero();
      double squares = 0;
      for (int j = 0; j < ambient_dim; ++j) {
        const double difference = pq[j] - px[j];
        squares += difference * difference;
        for (int k = 0; k < dim(); ++k) {
          coordinates[k] += basis[k * ambient_dim + j] * difference;
        }
      }
      if (ambient_dim < detail::kInOneSum) {
        return squares;
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

  template <class Column>
  double measure_by_distances(Index q, Column&& coordinates) {
    const Index count = tangents_.num_coefficients;
    const Index* neighbors = neighborhoods_.of(x_);
    const double* coefficients =
        tangents_.coefficients.data() + static_cast<std::size_t>(x_) * dim() * count;
    if (const double* to_q = distances_.find(x_, q)) {
      coordinates.setZero();
      for (Index a = 0; a < count; ++a) {
        const auto own = [&](int k) { return coefficients[k * count + a]; };
        bool needed = false;
        for (int k = 0; k < dim(); ++k) {
          needed = needed || own(k) != 0;
        }
        if (needed) {
          const double to_a = *distances_.find(x_, neighbors[a]);
          const double product = (to_a + *to_q - distances_(neighbors[a], q)) / 2;
          for (int k = 0; k < dim(); ++k) {
            coordinates[k] += own(k) * product;
          }
        }
      }
      return *to_q;
    }
    // So far away that all samples are looked at: a basis in R^D is cheaper.
    if (frame_of_ != x_) {
      frame_of_ = x_;
      frame_.resize(dim(), samples_.ambient_dim());
      detail::write_frame([&](Index i) { return samples_.point(i); }, 1.0, x_,
                          neighbors, count, coefficients, frame_);
    }
    using Map = Eigen::Map<const Eigen::VectorXd>;
    difference_ = Map(samples_.point(q), samples_.ambient_dim()) -
                  Map(samples_.point(x_), samples_.ambient_dim());
    for (int k = 0; k < dim(); ++k) {
      coordinates[k] = frame_.row(k).dot(difference_);
    }
    return samples_.squared_distance(x_, q);
  }

  void add_halfspace(Index q, double squared_distance, const Vector& normal) {
    if (normal.squaredNorm() <= detail::kVacuousSquaredSine * squared_distance) {
      ++vacuous_constraints_;
      return;
    }
    const double offset = (squared_distance + weights_[x_] - weights_[q]) / 2;
    region_.insert(normal, offset, q);
    if constexpr (K == Eigen::Dynamic) {
      refuse_many_corners(dim_, region_.room_of_corners(), samples_.size());
    }
  }

  /// Cuts by the samples nearest to each corner until no corner is nearer to a sample than
  /// to x, corners where the region is cut off included. Exact like the security radius,
  /// at a cost that does not depend on the size of the region: for the few long ones.
  /// \returns false where it is better to go through all samples: the search knows no
  /// positions, a corner is too far, or too many samples are as far from it as x
  bool certify_corners() {
    region_.update();
    // A ball through x reaches as far as twice its radius: where the list does, nothing in
    // the ball is new.
    const bool is_complete = is_exact_ && measured_ == list_.size() && !list_.empty();
    squared_listed_ =
        is_complete ? squared_distances_[list_.size() - 1] * (1 - 1e-9) : 0;
    seen_.resize(samples_.size(), -1);
    for (const auto& known : region_.halfspaces()) {
      seen_[known.sample] = x_;
    }
    certified_.clear();
    corner_count_ = kCornerCount;
    // Corners of the simplex at which regions are cut off are a few times as far.
    const double farthest = 10 * dim() * detail::kEndOfRegionAmongMany;
    do {
      region_.update();
      added_.clear();
      for (std::size_t c = 0; c < region_.corners().size(); ++c) {
        execution_.poll();
        const Index* facet = region_.facet(c);
        if (is_certified(facet)) {
          continue;
        }
        const Corner& corner = region_.corners()[c];
        if (!(corner.length < farthest) || !cut_corner(corner)) {
          return false;
        }
        if (region_.fresh() == 0) {
          certified_.insert(certified_.end(), facet, facet + dim());
        }
      }
    } while (region_.fresh() > 0);
    return true;
  }

  /// Whether this facet's corner was found to be nearer to no sample before.
  bool is_certified(const Index* facet) const {
    for (std::size_t i = 0; i < certified_.size(); i += dim()) {
      if (std::is_permutation(facet, facet + dim(),
                              certified_.begin() + static_cast<Offset>(i))) {
        return true;
      }
    }
    return false;
  }

  /// Adds samples nearer to the corner than x until one is new or none is left. A corner
  /// that was cut off by what another one added is left to the next look at the region.
  bool cut_corner(const Corner& corner) {
    const int ambient_dim = samples_.ambient_dim();
    if (tangents_.bases.empty()) {
      return false;
    }
    using Frame =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Frame> frame(
        tangents_.bases.data() + static_cast<std::size_t>(x_) * dim() * ambient_dim,
        dim(), ambient_dim);
    position_ = Eigen::Map<const Eigen::VectorXd>(samples_.point(x_), ambient_dim) +
                frame.transpose() * corner.position;
    const double squared_radius =
        (1 + 4 * corner.error) * corner.length * corner.length + largest_weight_;
    if (4 * squared_radius < squared_listed_) {
      return true;
    }
    const int fresh_before = region_.fresh();
    for (; corner_count_ <= max_corner_count_; corner_count_ *= 2) {
      const Offset count = std::min<Offset>(corner_count_, samples_.size());
      if (!nearest_to_position(static_cast<Index>(count), squared_radius)) {
        return false;
      }
      neighbors_used_ += static_cast<Offset>(grown_.size());
      bool cut = false;
      for (const Neighbor& neighbor : grown_) {
        if (neighbor.index == x_) {
          continue;
        }
        if (seen_[neighbor.index] == x_) {
          cut = cut ||
                std::find(added_.begin(), added_.end(), neighbor.index) != added_.end();
        } else {
          seen_[neighbor.index] = x_;
          Vector normal(dim());
          const double squared_distance = measure(neighbor.index, normal);
          const int before = region_.fresh();
          add_halfspace(neighbor.index, squared_distance, normal);
          if (region_.fresh() > before) {
            added_.push_back(neighbor.index);
          }
        }
      }
      if (cut || static_cast<Offset>(grown_.size()) < count ||
          count == samples_.size()) {
        return true;
      }
      if (region_.fresh() > fresh_before) {
        corner_count_ *= 2;  // where many are as far as x, a few at a time lead nowhere
        return true;
      }
    }
    return false;
  }

  void nearest(Index count) {
    const detail::Timed timed(coordinate_seconds_);
    query_->nearest(x_, count, region_.limit(), grown_);
  }

  bool nearest_to_position(Index count, double squared_radius) {
    const detail::Timed timed(coordinate_seconds_);
    return query_->nearest_to(position_.data(), count, squared_radius, grown_);
  }

  void scan_all() {
    const Index n = samples_.size();
    for (Index first = 0; first < n; first += kScanBlock) {
      execution_.poll();
      const Index last = std::min<Index>(n, first + kScanBlock);
      list_.resize(last - first);
      std::iota(list_.begin(), list_.end(), first);
      measured_ = 0;
      measure_list(list_.size());
      for (std::size_t i = 0; i < list_.size(); ++i) {
        if (list_[i] != x_ && squared_distances_[i] <= region_.limit()) {
          add_halfspace(list_[i], squared_distances_[i],
                        tangent_coordinates_.col(static_cast<Eigen::Index>(i)));
          if (region_.fresh() == kScanBatch) {
            region_.update();
          }
        }
      }
    }
    region_.update();
    neighbors_used_ += n - 1;
  }

  static constexpr int kPlainLoopDim = 16;

  const Samples& samples_;
  const Neighborhoods& neighborhoods_;
  const TangentSpaces& tangents_;
  const std::vector<double>& weights_;
  const Execution& execution_;
  int dim_;
  detail::KnownDistances distances_;
  std::unique_ptr<NeighborSearch::Query> query_;
  bool is_exact_;
  std::size_t first_batch_;
  Index ahead_;  // neighbors read ahead of each sample

  Index x_ = 0;
  std::vector<Index> list_;  // neighbors, nearest first
  Eigen::Matrix<double, K, Eigen::Dynamic> tangent_coordinates_;
  std::vector<double> squared_distances_;
  std::size_t measured_ = 0;  // so many of the list have coordinates and distance
  Index ahead_begin_ = 0;
  Eigen::Matrix<double, K, Eigen::Dynamic> ahead_coordinates_;
  std::vector<double> ahead_distances_;
  std::vector<Neighbor> grown_;
  std::vector<Index> seen_;   // by certify_corners: the last x each sample was added to
  std::vector<Index> added_;  // by certify_corners since the region's last update
  std::vector<Index> certified_;  // facets, K ids each
  Offset corner_count_ = 0;       // samples asked for around a corner
  double squared_listed_ = 0;     // up to which certify_corners knows all samples
  double largest_weight_;
  Offset max_corner_count_;
  Eigen::VectorXd difference_;
  Index frame_of_ = -1;
  detail::RowMatrix frame_;  // of that sample, where tangent spaces have coefficients
  Eigen::VectorXd position_;

  Region region_;
  Offset neighbors_used_ = 0;
  Offset vacuous_constraints_ = 0;
  double coordinate_seconds_ = 0;
};

/// What one block of samples found, to be joined in order.
struct Block {
  std::vector<Index> edge_sets;
  std::vector<std::uint8_t> stars;
  std::vector<Index> rows;  // of one star
};

template <int K>
void compute_all(const Samples& samples, const NeighborSearch& search,
                 const Neighborhoods& neighborhoods, const TangentSpaces& tangents,
                 const Execution& execution, LocalRegions& result) {
  using Kernel = RegionKernel<K>;
  std::vector<double> weights;
  {
    const detail::Timed timed(result.coordinate_seconds);
    weights = tie_weights(samples, neighborhoods, execution);
  }
  detail::ThreadScratch<Kernel> kernels([&] {
    return Kernel(samples, search, neighborhoods, tangents, weights, execution);
  });
  const Offset n = samples.size();
  const Offset block_length = block_size(result.dim);
  const Offset num_blocks = detail::blocks_of_wave(execution);
  std::vector<Block> blocks(
      std::min((n + block_length - 1) / block_length, num_blocks));
  std::vector<Offset>& edge_counts = result.edge_sets.offsets;
  std::vector<Offset>& star_counts = result.star_offsets;
  edge_counts.assign(n + 1, 0);
  star_counts.assign(n + 1, 0);
  result.squared_radii.assign(n, std::numeric_limits<double>::quiet_NaN());
  std::atomic<Offset> num_corners{0};

  const auto work = [&](Block& block, Offset begin, Offset end) {
    kernels.use([&](Kernel& kernel) {
      for (Offset i = begin; i < end; ++i) {
        execution.poll();
        if ((i - begin) % kGroup == 0) {
          kernel.read_ahead(static_cast<Index>(i),
                            static_cast<Index>(std::min(end, i + kGroup)));
        }
        if (tangents.boundary[i] != 0) {
          continue;
        }
        kernel.compute(static_cast<Index>(i));
        const std::size_t before = block.edge_sets.size();
        kernel.region().append_edge_set(block.edge_sets);
        std::sort(block.edge_sets.begin() + static_cast<Offset>(before),
                  block.edge_sets.end());
        edge_counts[i + 1] = static_cast<Offset>(block.edge_sets.size() - before);
        block.rows.clear();
        star_counts[i + 1] = kernel.region().append_star(block.rows);
        refuse_many_corners(result.dim, num_corners += star_counts[i + 1],
                            samples.size());
        Star::pack(block.rows, block.edge_sets.data() + before, edge_counts[i + 1],
                   block.stars);
        result.squared_radii[i] = kernel.region().squared_radius();
      }
    });
  };
  const Offset wave_length = num_blocks * block_length;
  for (Offset wave = 0; wave < n; wave += wave_length) {
    const Offset last = std::min(n, wave + wave_length);
    detail::for_each_block(
        last - wave, block_length, execution, [&](Offset begin, Offset end) {
          work(blocks[begin / block_length], wave + begin, wave + end);
        });
    for (Block& block : blocks) {
      detail::append(result.edge_sets.indices, block.edge_sets);
      detail::append(result.stars, block.stars);
    }
    if (wave == 0) {
      detail::reserve_for(result.edge_sets.indices, last, n);
      detail::reserve_for(result.stars, last, n);
    }
  }
  kernels.for_each([&](const Kernel& kernel) {
    result.neighbors_used += kernel.neighbors_used();
    result.vacuous_constraints += kernel.vacuous_constraints();
    result.coordinate_seconds += kernel.coordinate_seconds();
  });
  std::partial_sum(edge_counts.begin(), edge_counts.end(), edge_counts.begin());
  result.star_starts.assign(n + 1, 0);
  for (Offset i = 0; i < n; ++i) {
    result.star_starts[i + 1] =
        result.star_starts[i] +
        star_counts[i + 1] * result.dim * Star::width_of(result.edge_sets.size(i));
  }
  std::partial_sum(star_counts.begin(), star_counts.end(), star_counts.begin());
}

}  // namespace

void Star::pack(const std::vector<Index>& rows, const Index* edge_set, Offset edges,
                std::vector<std::uint8_t>& out) {
  const int width = width_of(edges);
  for (const Index vertex : rows) {
    const Index* const found = std::lower_bound(edge_set, edge_set + edges, vertex);
    if (found == edge_set + edges || *found != vertex) {
      throw std::logic_error("a star simplex leaves the edge set");
    }
    auto place = static_cast<std::uint32_t>(found - edge_set);
    for (int byte = 0; byte < width; ++byte, place >>= 8) {
      out.push_back(static_cast<std::uint8_t>(place & 0xff));
    }
  }
}

Offset Star::place(Offset row, int i) const {
  const std::uint8_t* bytes = places_ + (row * dim_ + i) * width_;
  Offset result = bytes[0];
  for (int byte = 1; byte < width_; ++byte) {
    result |= Offset{bytes[byte]} << (8 * byte);
  }
  return result;
}

bool Star::has(const Index* vertices) const {
  // Rows are in the order of their places: by the first, then one after the other.
  const Index* const end = edge_set_ + edges_;
  const Index* const first = std::lower_bound(edge_set_, end, vertices[0]);
  if (first == end || *first != vertices[0]) {
    return false;
  }
  Offset low = 0;
  Offset high = size_;
  while (low < high) {
    const Offset middle = (low + high) / 2;
    if (place(middle, 0) < first - edge_set_) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  for (; low < size_ && place(low, 0) == first - edge_set_; ++low) {
    int i = 1;
    while (i < dim_ && vertex(low, i) == vertices[i]) {
      ++i;
    }
    if (i == dim_) {
      return true;
    }
  }
  return false;
}

void Star::append_to(std::vector<Index>& rows) const {
  for (Offset row = 0; row < size_; ++row) {
    for (int i = 0; i < dim_; ++i) {
      rows.push_back(vertex(row, i));
    }
  }
}

Index certifying_count(int dim) { return typical_count(dim); }

Index certifying_count(int dim, const NeighborSearch& search) {
  constexpr Index generous = 4;
  return typical_count(dim) * (search.query()->looks_at_all() ? generous : 1);
}

std::vector<double> tie_weights(const Samples& samples,
                                const Neighborhoods& neighborhoods,
                                const Execution& execution) {
  constexpr Offset block = 256;
  std::vector<double> weights(samples.size(), 0.0);
  if (neighborhoods.count == 0) {
    return weights;
  }
  const auto weigh = [&](const auto& hash) {
    detail::for_each_block_uncounted(
        samples.size(), block, execution, [&](Offset begin, Offset end) {
          const detail::KnownDistances known(samples, neighborhoods);
          for (auto i = static_cast<Index>(begin); i < end; ++i) {
            weights[i] = detail::kTieWeight * known.nearest(i) * hash(i);
          }
        });
  };
  if (samples.has_points()) {
    weigh(PositionHash(samples));
  } else {
    weigh([&](Index i) { return hash_of_distances(samples, i); });
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
  detail::assert_that([&] { verify_local_regions(result); });
  return result;
}

}  // namespace remanifold
