// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/samples.hpp"

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "base/tolerance.hpp"
#include "samples/distance.hpp"
#include "samples/known_distances.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace remanifold {
namespace {

constexpr Offset kMaxSamples = std::numeric_limits<Index>::max() - 1;
constexpr Offset kBlock = 1 << 14;

void check_count(Offset rows, const char* what) {
  if (rows < 1) {
    throw std::invalid_argument(std::string(what) + " is empty: no samples");
  }
  if (rows > kMaxSamples) {
    throw std::overflow_error(std::string(what) + " has " + std::to_string(rows) +
                              " samples; at most " + std::to_string(kMaxSamples) +
                              " are supported");
  }
}

/// Rows of a block that is worth a task, of as many coordinates as they may have.
Offset block_of(Offset dim) {
  constexpr Offset elements = 1 << 18;
  return std::clamp<Offset>(elements / dim, 1, kBlock);
}

void check_row(MatrixView matrix, Offset i, const char* what) {
  for (Offset j = 0; j < matrix.cols; ++j) {
    if (!std::isfinite(matrix.row(i)[j])) {
      throw std::invalid_argument(std::string(what) + "[" + std::to_string(i) + ", " +
                                  std::to_string(j) + "] is not finite");
    }
  }
}

void check_finite(MatrixView matrix, const char* what, const Execution& execution) {
  detail::for_each_block(matrix.rows, block_of(matrix.cols), execution,
                         [&](Offset begin, Offset end) {
                           for (Offset i = begin; i < end; ++i) {
                             check_row(matrix, i, what);
                           }
                         });
}

/// The least and the largest value of each column.
struct Extents {
  std::vector<double> low;
  std::vector<double> high;

  void add(const double* values, const double* other_values) {
    double* const lows = low.data();
    double* const highs = high.data();
    const std::size_t size = low.size();
    for (std::size_t j = 0; j < size; ++j) {
      lows[j] = std::min(lows[j], values[j]);
      highs[j] = std::max(highs[j], other_values[j]);
    }
  }
};

Extents check_and_measure(MatrixView points, const Execution& execution) {
  const std::vector<double> first(points.row(0), points.row(0) + points.cols);
  const Extents start{first, first};
  detail::ThreadScratch<Extents> of_thread(start);
  detail::for_each_block(points.rows, block_of(points.cols), execution,
                         [&](Offset begin, Offset end) {
                           of_thread.use([&](Extents& extents) {
                             for (Offset i = begin; i < end; ++i) {
                               check_row(points, i, "points");
                               extents.add(points.row(i), points.row(i));
                             }
                           });
                         });
  Extents all = start;
  of_thread.for_each([&](const Extents& extents) {
    all.add(extents.low.data(), extents.high.data());
  });
  return all;
}

void check_within(const Extents& extents, const GlobalStatistics& whole) {
  const std::size_t dim = extents.low.size();
  if (whole.low.size() != dim || whole.high.size() != dim) {
    throw std::invalid_argument("the whole has " + std::to_string(whole.low.size()) +
                                " coordinates, points have " + std::to_string(dim));
  }
  for (std::size_t j = 0; j < dim; ++j) {
    if (extents.low[j] < whole.low[j] || extents.high[j] > whole.high[j]) {
      throw std::invalid_argument("points[:, " + std::to_string(j) +
                                  "] reach beyond the extent of the whole");
    }
  }
}

/// The power of two p with extent / p in [0.5, 1); 1 for an extent of zero.
double power_of_two_above(double extent) {
  if (extent == 0) {
    return 1.0;
  }
  int exponent = 0;
  std::frexp(extent, &exponent);
  // Both p and 1 / p have to be representable.
  return std::ldexp(1.0, std::clamp(exponent, -1021, 1022));
}

/// Interleaves the low 21 bits of x with two zero bits each.
std::uint64_t spread_by_three(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  x = (x | x << 2) & 0x1249249249249249ULL;
  return x;
}

}  // namespace

Samples Samples::from_points(MatrixView points, const Execution& execution) {
  return from_points(points, nullptr, execution);
}

Samples Samples::from_part(MatrixView points, GlobalStatistics whole,
                           const Execution& execution) {
  return from_points(points, std::make_shared<const GlobalStatistics>(std::move(whole)),
                     execution);
}

Samples Samples::from_points(MatrixView points,
                             std::shared_ptr<const GlobalStatistics> whole,
                             const Execution& execution) {
  check_count(points.rows, "points");
  if (points.cols < 1) {
    throw std::invalid_argument("points has no coordinates: its second axis is empty");
  }
  detail::begin_step(execution, Step::kPrepare, 3 * points.rows);
  const Offset n = points.rows;
  const Offset dim = points.cols;
  Extents extents = check_and_measure(points, execution);
  if (whole) {
    check_within(extents, *whole);
    extents = {whole->low, whole->high};
  }
  const std::vector<double>& low = extents.low;
  const std::vector<double>& high = extents.high;
  // Half the extent, since the extent itself may overflow.
  const auto half_extent = [&](Offset j) { return high[j] / 2 - low[j] / 2; };
  double largest = 0;
  for (Offset j = 0; j < dim; ++j) {
    largest = std::max(largest, half_extent(j));
  }

  Samples samples;
  samples.kind_ = Kind::kPoints;
  samples.whole_ = std::move(whole);
  samples.ambient_dim_ = static_cast<int>(dim);
  samples.scale_ = power_of_two_above(largest);
  samples.inverse_scale_ = 1.0 / samples.scale_;

  for (Offset j = 0; j < dim; ++j) {
    if (low[j] != high[j]) {
      samples.varying_axes_.push_back(static_cast<int>(j));
    }
    samples.lowest_.push_back(low[j] == high[j] ? 0.0
                                                : low[j] * samples.inverse_scale_);
  }

  // Morton code of the three longest axes.
  std::array<Offset, 3> axes{};
  const int num_axes = static_cast<int>(std::min<Offset>(3, dim));
  {
    std::vector<Offset> order(dim);
    std::iota(order.begin(), order.end(), Offset{0});
    std::partial_sort(order.begin(), order.begin() + num_axes, order.end(),
                      [&](Offset a, Offset b) {
                        const double ea = half_extent(a);
                        const double eb = half_extent(b);
                        return ea != eb ? ea > eb : a < b;
                      });
    std::copy_n(order.begin(), num_axes, axes.begin());
  }
  struct Key {
    std::uint64_t code;
    Index index;
  };
  std::vector<Key> keys(n);
  detail::for_each_block(n, kBlock, execution, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      std::uint64_t code = 0;
      for (int a = 0; a < num_axes; ++a) {
        const double position =
            largest == 0 ? 0.0
                         : (points.row(i)[axes[a]] / 2 - low[axes[a]] / 2) / largest;
        // Symmetric data have their middle at one half; keep it off the edge of a cell.
        const auto cell = static_cast<std::uint64_t>(position * 0x1ffffe + 0.382);
        code |= spread_by_three(std::min<std::uint64_t>(cell, 0x1fffff)) << a;
      }
      keys[i] = {code, static_cast<Index>(i)};
    }
  });
  // An axis on which all agree adds nothing, and may be too large to be scaled.
  const auto scaled = [&](Index i, Offset j) {
    return low[j] == high[j] ? 0.0 : points.row(i)[j] * samples.inverse_scale_;
  };
  double largest_scaled = 0;
  for (Offset j = 0; j < dim; ++j) {
    if (low[j] != high[j]) {
      largest_scaled =
          std::max({largest_scaled, std::abs(low[j] * samples.inverse_scale_),
                    std::abs(high[j] * samples.inverse_scale_)});
    }
  }
  const double tolerance = detail::kCoincidence * largest_scaled;
  const auto coincide = [&](Index a, Index b) {
    for (Offset j = 0; j < dim; ++j) {
      if (!(std::abs(scaled(a, j) - scaled(b, j)) <= tolerance)) {
        return false;
      }
    }
    return true;
  };
  const auto compare_coordinates = [&](Index a, Index b) {
    for (Offset j = 0; j < dim; ++j) {
      const double ca = scaled(a, j);
      const double cb = scaled(b, j);
      if (ca != cb) {
        return ca < cb ? -1 : 1;
      }
    }
    return 0;
  };
  execution.poll();
  detail::sort_all(keys, execution, [&](const Key& a, const Key& b) {
    if (a.code != b.code) {
      return a.code < b.code;
    }
    const int order = compare_coordinates(a.index, b.index);
    return order != 0 ? order < 0 : a.index < b.index;
  });
  execution.poll();

  // Samples that coincide share a cell of the curve, where they are sorted by their first
  // coordinate.
  std::vector<Index>& representatives = samples.representatives_;
  representatives.assign(n, -1);
  samples.input_index_.reserve(n);
  std::vector<Index> members;
  for (Offset i = 0; i < n; ++i) {
    if (representatives[keys[i].index] >= 0) {
      continue;
    }
    members.assign(1, keys[i].index);
    for (Offset j = i + 1;
         j < n && keys[j].code == keys[i].code &&
         scaled(keys[j].index, 0) - scaled(keys[i].index, 0) <= tolerance;
         ++j) {
      if (representatives[keys[j].index] < 0 &&
          coincide(keys[i].index, keys[j].index)) {
        members.push_back(keys[j].index);
        representatives[keys[j].index] = 0;
      }
    }
    const Index first = *std::min_element(members.begin(), members.end());
    for (const Index member : members) {
      representatives[member] = first;
    }
    samples.input_index_.push_back(first);
  }
  samples.input_index_.shrink_to_fit();
  keys = {};

  std::vector<double> factors(dim);
  for (Offset j = 0; j < dim; ++j) {
    factors[j] = low[j] == high[j] ? 0.0 : samples.inverse_scale_;
  }
  auto memory = std::make_shared<detail::AlignedArray<double>>(samples.size() * dim);
  samples.points_ = {memory, memory->data()};
  detail::for_each_block(
      samples.size(), block_of(dim), execution, [&](Offset begin, Offset end) {
        const double* const factor = factors.data();
        for (Offset i = begin; i < end; ++i) {
          const double* const in = points.row(samples.input_index_[i]);
          double* const out = samples.points_.get() + i * dim;
          for (Offset j = 0; j < dim; ++j) {
            out[j] = in[j] * factor[j];
          }
        }
      });
  return samples;
}

Samples Samples::from_gram(MatrixView gram, const Execution& execution) {
  return from_matrix(gram, Kind::kGram, execution);
}

Samples Samples::from_distances(MatrixView distances, const Execution& execution) {
  return from_matrix(distances, Kind::kDistances, execution);
}

Samples Samples::from_matrix(MatrixView matrix, Kind kind, const Execution& execution) {
  const bool is_gram = kind == Kind::kGram;
  const char* what = is_gram ? "gram" : "distances";
  check_count(matrix.rows, what);
  if (matrix.rows != matrix.cols) {
    throw std::invalid_argument(std::string(what) +
                                " is not square: " + std::to_string(matrix.rows) +
                                " x " + std::to_string(matrix.cols));
  }
  const Offset n = matrix.rows;
  detail::begin_step(execution, Step::kPrepare, 3 * n);
  check_finite(matrix, what, execution);

  double largest = 0;
  for (Offset i = 0; i < n; ++i) {
    const double* row = matrix.row(i);
    if (is_gram ? row[i] < 0 : row[i] != 0) {
      throw std::invalid_argument(
          std::string(what) + "[" + std::to_string(i) + ", " + std::to_string(i) +
          "] is " + (is_gram ? "negative: not positive semidefinite" : "not zero"));
    }
    largest = is_gram ? std::max(largest, row[i])
                      : std::max(largest, *std::max_element(row, row + n));
  }
  // Rounding of a product of two matrices is relative to the norms, not to the entry; the
  // matrix may have been computed in single precision.
  const double asymmetry = detail::kAsymmetry * largest;
  const double small = detail::kSmallAsymmetry * largest;
  std::atomic<bool> uneven{false};
  detail::for_each_block(n, 64, execution, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      for (Offset j = 0; j < i; ++j) {
        const double ij = matrix.row(i)[j];
        const double difference = std::abs(ij - matrix.row(j)[i]);
        if (difference > small) {
          uneven = true;
        }
        if (difference > asymmetry) {
          throw std::invalid_argument(std::string(what) + " is not symmetric at [" +
                                      std::to_string(i) + ", " + std::to_string(j) +
                                      "]");
        }
        if (!is_gram && ij < 0) {
          throw std::invalid_argument(std::string(what) + "[" + std::to_string(i) +
                                      ", " + std::to_string(j) + "] is negative");
        }
      }
    }
  });

  Samples samples;
  samples.kind_ = kind;
  samples.matrix_ = matrix;
  if (uneven) {
    samples.even_ = std::make_shared<std::vector<double>>(n * n);
    double* even = samples.even_->data();
    for (Offset i = 0; i < n; ++i) {
      execution.poll();
      for (Offset j = 0; j < n; ++j) {
        even[i * n + j] = (matrix.row(i)[j] + matrix.row(j)[i]) / 2;
      }
    }
    samples.matrix_ = {even, n, n};
  }
  // Like the extent of points, up to a factor.
  samples.scale_ = power_of_two_above(is_gram ? std::sqrt(largest) : largest / 2);
  samples.inverse_scale_ = 1.0 / samples.scale_;

  // Every sample joins the first one it coincides with; identity numbers for now.
  samples.input_index_.resize(n);
  std::iota(samples.input_index_.begin(), samples.input_index_.end(), Index{0});
  samples.representatives_.resize(n);
  detail::for_each_block(n, 64, execution, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      Index first = 0;
      while (first < i && samples.squared_distance(first, static_cast<Index>(i)) > 0) {
        ++first;
      }
      samples.representatives_[i] = first;
    }
  });
  std::vector<Index> distinct;
  for (Index i = 0; i < n; ++i) {
    // Coincidence within rounding need not be transitive; chains join their head.
    Index& head = samples.representatives_[i];
    head = head == i ? i : samples.representatives_[head];
    if (head == i) {
      distinct.push_back(i);
    }
  }
  samples.input_index_ = std::move(distinct);
  return samples;
}

std::vector<Index> Samples::canonical_indices() const {
  std::vector<Index> canonical(representatives_.size(), -1);
  for (Index i = 0; i < size(); ++i) {
    canonical[input_index_[i]] = i;
  }
  for (std::size_t i = 0; i < canonical.size(); ++i) {
    canonical[i] = canonical[representatives_[i]];
  }
  return canonical;
}

Samples Samples::without(const std::vector<Index>& left_out) const {
  std::vector<std::uint8_t> kept(size(), 1);
  for (const Index i : left_out) {
    kept[i] = 0;
  }
  Samples result = *this;
  result.neighborhoods_ = nullptr;
  result.input_index_.clear();
  for (Index i = 0; i < size(); ++i) {
    if (kept[i] != 0) {
      result.input_index_.push_back(input_index_[i]);
    }
  }
  if (kind_ == Kind::kPoints) {
    const auto dim = static_cast<std::size_t>(ambient_dim_);
    auto memory = std::make_shared<detail::AlignedArray<double>>(result.size() * dim);
    double* out = memory->data();
    for (Index i = 0; i < size(); ++i) {
      if (kept[i] != 0) {
        out = std::copy_n(point(i), dim, out);
      }
    }
    result.points_ = {memory, memory->data()};
    result.varying_axes_.clear();
    for (const int axis : varying_axes_) {
      for (Index i = 1; i < result.size(); ++i) {
        if (result.point(i)[axis] != result.point(0)[axis]) {
          result.varying_axes_.push_back(axis);
          break;
        }
      }
    }
  }
  return result;
}

Samples Samples::moved_to(MatrixView points, const Execution& execution) const {
  Samples result = from_points(points, execution);
  for (std::size_t j = 0; j < lowest_.size(); ++j) {
    result.lowest_[j] = lowest_[j] * result.inverse_scale_;
  }
  result.scale_ *= scale_;
  result.inverse_scale_ *= inverse_scale_;
  // From numbers here to input numbers, of which the lowest stands for all that coincide.
  std::vector<Index> lowest(size(), representatives_.empty() ? 0 : input_size());
  for (Index i = 0; i < size(); ++i) {
    Index& first = lowest[result.representatives_[i]];
    first = std::min(first, input_index_[i]);
  }
  for (Index& i : result.input_index_) {
    i = lowest[i];
  }
  std::vector<Index> representatives = representatives_;
  const std::vector<Index> canonical = canonical_indices();
  for (std::size_t i = 0; i < representatives.size(); ++i) {
    if (canonical[i] >= 0) {
      representatives[i] = lowest[result.representatives_[canonical[i]]];
    }
  }
  result.representatives_ = std::move(representatives);
  return result;
}

Samples Samples::knowing(const Neighborhoods& neighborhoods) const {
  Samples result = *this;
  if (detail::KnownDistances(*this, neighborhoods).pay()) {
    result.neighborhoods_ = &neighborhoods;
  }
  return result;
}

double Samples::any_squared_distance(Index a, Index b) const {
  if (neighborhoods_ != nullptr) {
    return detail::KnownDistances(*this, *neighborhoods_)(a, b);
  }
  if (kind_ == Kind::kPoints) {
    return detail::squared_distance(point(a), point(b), ambient_dim_);
  }
  // One triangle only: the other may differ by rounding.
  const Offset i = std::min(input_index_[a], input_index_[b]);
  const Offset j = std::max(input_index_[a], input_index_[b]);
  if (kind_ == Kind::kDistances) {
    const double distance = matrix_.row(i)[j] * inverse_scale_;
    return distance <= detail::kCoincidence ? 0.0 : distance * distance;
  }
  const double norms = (matrix_.row(i)[i] * inverse_scale_) * inverse_scale_ +
                       (matrix_.row(j)[j] * inverse_scale_) * inverse_scale_;
  const double squared =
      norms - 2 * (matrix_.row(i)[j] * inverse_scale_) * inverse_scale_;
  return squared <= detail::kGramCoincidence * norms ? 0.0 : squared;
}

double Samples::any_inner_product(Index x, Index a, Index b) const {
  if (kind_ == Kind::kPoints && neighborhoods_ == nullptr) {
    const double* px = point(x);
    const double* pa = point(a);
    const double* pb = point(b);
    double sum = 0;
    for (int i = 0; i < ambient_dim_; ++i) {
      sum += (pa[i] - px[i]) * (pb[i] - px[i]);
    }
    return sum;
  }
  if (kind_ != Kind::kGram) {
    return (squared_distance(x, a) + squared_distance(x, b) - squared_distance(a, b)) /
           2;
  }
  const auto entry = [&](Index p, Index q) {
    return matrix_.row(std::min(
        input_index_[p], input_index_[q]))[std::max(input_index_[p], input_index_[q])];
  };
  const double product = (entry(a, b) - entry(x, b)) + (entry(x, x) - entry(x, a));
  return (product * inverse_scale_) * inverse_scale_;
}

}  // namespace remanifold
