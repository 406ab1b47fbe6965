// SPDX-License-Identifier: GPL-3.0-or-later
#include "neighbors/shortlists.hpp"

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "neighbors/neighbor_search.hpp"
#include "samples/products.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

namespace remanifold::detail {
namespace {

/// Rows and columns of a tile of products: what it reads at a time stays in cache.
constexpr Offset kTile = 240;
/// All products are kept, so that each is computed once, where they take no more memory
/// than the samples or than so many bytes.
constexpr Offset kProductBytes = Offset{1} << 28;
/// Products of a thread otherwise.
constexpr Offset kBlockElements = Offset{1} << 23;
/// Samples whose mean is taken for the center.
constexpr Offset kCenterSamples = 64;
/// Rows looked at to see whether single precision will do.
constexpr Offset kProbeRows = 32;
/// Coordinates packed at a time.
constexpr Offset kPackDepth = 8;

/// A list longer than this is not worth its products.
constexpr std::size_t longest_list(Index count) {
  return 3 * static_cast<std::size_t>(count) + 64;
}

Offset round_up(Offset value, Offset unit) { return (value + unit - 1) / unit * unit; }

std::vector<double> approximate_center(const Samples& samples) {
  const Offset n = samples.size();
  const Offset dim = samples.ambient_dim();
  const Offset count = std::min(n, kCenterSamples);
  std::vector<double> center(dim, 0.0);
  for (Offset i = 0; i < count; ++i) {
    const double* p = samples.point(static_cast<Index>(i * n / count));
    for (Offset j = 0; j < dim; ++j) {
      center[j] += p[j];
    }
  }
  for (double& c : center) {
    c /= static_cast<double>(count);
  }
  return center;
}

template <class T>
class Products {
 public:
  Products(const Samples& samples, const std::vector<double>& center,
           const Execution& execution)
      : samples_(samples),
        execution_(execution),
        n_(samples.size()),
        dim_(samples.ambient_dim()),
        stride_(dim_ * kPanel),
        padded_(round_up(n_, kPanel)),
        panels_(padded_ * dim_),
        norms_(padded_, 0.0) {
    const auto depth = static_cast<double>(dim_);
    constexpr double rounding = std::numeric_limits<T>::epsilon() / 2;
    constexpr double fine = std::numeric_limits<double>::epsilon();
    // Of the products; of the coordinates and of the norms. See add_products().
    product_error_ =
        1.01 * rounding * (kProductDepth + depth / kProductDepth + 8) + fine;
    coordinate_error_ = 1.01 * (2 * rounding + (depth + 8) * fine);
    for_each_block_uncounted(padded_ / kPanel, 1, execution,
                             [&](Offset p, Offset) { pack(p, center); });
  }

  /// \returns nothing where so many lists are long that more digits are needed
  std::optional<Csr> lists(Index count, bool give_up) {
    give_up_ = give_up;
    count_ = count;
    if (give_up && !probe()) {
      return std::nullopt;
    }
    std::vector<std::vector<Index>> blocks;
    std::vector<Index> sizes(n_);
    const auto bytes = static_cast<Offset>(sizeof(T));
    const Offset input_bytes = n_ * dim_ * static_cast<Offset>(sizeof(double));
    if (padded_ * padded_ * bytes <= std::max(input_bytes, kProductBytes)) {
      const AlignedArray<T> all = multiply_all();
      blocks.resize((n_ + kTile - 1) / kTile);
      for_each_block(n_, kTile, execution_, [&](Offset begin, Offset end) {
        list_rows(begin, end, all.data() + begin * padded_, sizes,
                  blocks[begin / kTile]);
      });
    } else {
      const Offset rows =
          std::clamp(kBlockElements / padded_ / kPanel * kPanel, kPanel, kTile);
      blocks.resize((n_ + rows - 1) / rows);
      ThreadScratch<AlignedArray<T>> scratch(
          [&] { return AlignedArray<T>(rows * padded_); });
      for_each_block(n_, rows, execution_, [&](Offset begin, Offset end) {
        scratch.use([&](AlignedArray<T>& products) {
          multiply(begin, round_up(end, kPanel), 0, padded_, products.data(), padded_);
          list_rows(begin, end, products.data(), sizes, blocks[begin / rows]);
        });
      });
    }
    if (give_up_ && too_many_long()) {
      return std::nullopt;
    }
    Csr result;
    result.offsets.resize(n_ + 1);
    for (Offset i = 0; i < n_; ++i) {
      result.offsets[i + 1] = result.offsets[i] + sizes[i];
    }
    result.indices.reserve(result.offsets.back());
    for (std::vector<Index>& block : blocks) {
      result.indices.insert(result.indices.end(), block.begin(), block.end());
      block = {};
    }
    return result;
  }

 private:
  static constexpr Offset kPanel = kPanelRows<T>;

  void pack(Offset p, const std::vector<double>& center) {
    T* out = panels_.data() + p * stride_;
    double squares[kPanel] = {};
    const double* rows[kPanel];
    for (Offset r = 0; r < kPanel; ++r) {
      rows[r] = samples_.point(static_cast<Index>(std::min(p * kPanel + r, n_ - 1)));
    }
    const Offset used = std::min(kPanel, n_ - p * kPanel);
    T lines[kPackDepth][kPanel] = {};
    for (Offset first = 0; first < dim_; first += kPackDepth) {
      const Offset depth = std::min(kPackDepth, dim_ - first);
      for (Offset r = 0; r < used; ++r) {
        for (Offset k = 0; k < depth; ++k) {
          lines[k][r] = static_cast<T>(rows[r][first + k] - center[first + k]);
        }
      }
      for (Offset k = 0; k < depth; ++k) {
        for (Offset r = 0; r < kPanel; ++r) {
          const double value = lines[k][r];
          squares[r] += value * value;
          out[(first + k) * kPanel + r] = lines[k][r];
        }
      }
    }
    for (Offset r = 0; r < kPanel; ++r) {
      norms_[p * kPanel + r] = std::sqrt(squares[r]);
    }
  }

  /// Products of rows with columns, all multiples of a panel.
  void multiply(Offset row_begin, Offset row_end, Offset column_begin,
                Offset column_end, T* out, Offset columns) const {
    for (Offset c = column_begin; c < column_end; c += kTile) {
      const Offset width = std::min(kTile, column_end - c);
      T* tile = out + (c - column_begin);
      for (Offset r = 0; r < row_end - row_begin; ++r) {
        std::fill_n(tile + r * columns, width, T{0});
      }
      for (Offset k = 0; k < dim_; k += kProductDepth) {
        execution_.poll();
        add_products(panels_.data() + row_begin / kPanel * stride_ + k * kPanel,
                     (row_end - row_begin) / kPanel,
                     panels_.data() + c / kPanel * stride_ + k * kPanel, width / kPanel,
                     stride_, std::min(kProductDepth, dim_ - k), tile, columns);
      }
    }
  }

  AlignedArray<T> multiply_all() const {
    AlignedArray<T> all(padded_ * padded_);
    const Offset tiles = (padded_ + kTile - 1) / kTile;
    ThreadScratch<AlignedArray<T>> scratch(
        [] { return AlignedArray<T>(kTile * kTile); });
    for_each_block_uncounted(
        tiles * (tiles + 1) / 2, 1, execution_, [&](Offset t, Offset) {
          Offset i = 0;
          for (; t >= tiles - i; ++i) {
            t -= tiles - i;
          }
          const Offset first = i * kTile;
          const Offset second = (i + t) * kTile;
          const Offset rows = std::min(kTile, padded_ - first);
          const Offset columns = std::min(kTile, padded_ - second);
          scratch.use([&](AlignedArray<T>& memory) {
            T* const tile = memory.data();
            multiply(first, first + rows, second, second + columns, tile, kTile);
            for (Offset r = 0; r < rows; ++r) {
              std::copy_n(tile + r * kTile, columns,
                          all.data() + (first + r) * padded_ + second);
            }
            if (first != second) {
              for (Offset c = 0; c < columns; ++c) {
                T* out = all.data() + (second + c) * padded_ + first;
                for (Offset r = 0; r < rows; ++r) {
                  out[r] = tile[r * kTile + c];
                }
              }
            }
          });
        });
    return all;
  }

  /// Whether a few rows, evenly spread, have short lists.
  bool probe() {
    AlignedArray<T> products(kPanel * padded_);
    const Offset probes = std::min(kProbeRows / kPanel, padded_ / kPanel);
    std::vector<Index> list;
    std::vector<Index> sizes(n_);
    for (Offset p = 0; p < probes; ++p) {
      const Offset begin = p * (padded_ / kPanel) / probes * kPanel;
      multiply(begin, begin + kPanel, 0, padded_, products.data(), padded_);
      list_rows(begin, std::min(n_, begin + kPanel), products.data(), sizes, list);
    }
    const bool short_lists = long_lists_ <= probes * kPanel / 8;
    long_lists_ = 0;
    return short_lists;
  }

  bool too_many_long() const { return long_lists_ > 16 + n_ / 16; }

  void list_rows(Offset begin, Offset end, const T* products, std::vector<Index>& sizes,
                 std::vector<Index>& out) {
    Scratch scratch;
    for (Offset x = begin; x < end; ++x) {
      if (give_up_ && too_many_long()) {
        return;
      }
      const std::size_t before = out.size();
      list_row(x, products + (x - begin) * padded_, scratch, out);
      sizes[x] = static_cast<Index>(out.size() - before);
    }
  }

  struct Bounds {
    double lower, upper;
    Index sample;
  };
  struct Scratch {
    std::vector<double> selected;
    std::vector<Bounds> kept;
    std::vector<Neighbor> exact;
  };

  /// Half the squared distance, short of what all share, from below and above.
  Bounds bound(Offset x, Offset q, const T* products) const {
    const double norm = norms_[q];
    const double sum = norms_[x] + norm;
    const double half = 0.5 * norm * norm - static_cast<double>(products[q]);
    const double error =
        product_error_ * norms_[x] * norm + coordinate_error_ * sum * sum + kTiny;
    return {half - error, half + error, static_cast<Index>(q)};
  }

  void list_row(Offset x, const T* products, Scratch& scratch,
                std::vector<Index>& out) {
    // Samples next to x in memory tend to be near: what is farther than `count` of them is
    // passed over at a glance.
    const Offset window = 2 * Offset{count_} + 1;
    const Offset first =
        std::clamp<Offset>(x - window / 2, 0, std::max<Offset>(0, n_ - window));
    scratch.selected.clear();
    for (Offset q = first; q < std::min(n_, first + window); ++q) {
      if (q != x) {
        scratch.selected.push_back(bound(x, q, products).upper);
      }
    }
    double limit = nth(scratch.selected);
    scratch.kept.clear();
    double lower[kGlance];
    for (Offset begin = 0; begin < n_; begin += kGlance) {
      const Offset size = std::min(kGlance, n_ - begin);
      lower_bounds(products + begin, norms_.data() + begin, size, norms_[x],
                   product_error_, coordinate_error_, lower);
      for (Offset i = 0; i < size; ++i) {
        if (lower[i] <= limit + kTiny && begin + i != x) {
          scratch.kept.push_back(bound(x, begin + i, products));
        }
      }
    }
    scratch.selected.clear();
    for (const Bounds& bounds : scratch.kept) {
      scratch.selected.push_back(bounds.upper);
    }
    limit = nth(scratch.selected);
    scratch.kept.erase(
        std::remove_if(scratch.kept.begin(), scratch.kept.end(),
                       [&](const Bounds& bounds) { return bounds.lower > limit; }),
        scratch.kept.end());
    if (scratch.kept.size() > longest_list(count_)) {
      ++long_lists_;
      if (!give_up_) {
        shorten(static_cast<Index>(x), scratch);
      }
    }
    for (const Bounds& bounds : scratch.kept) {
      out.push_back(bounds.sample);
    }
  }

  double nth(std::vector<double>& values) const {
    const auto nth = values.begin() + (count_ - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  }

  /// Where no product resolves the distances: so that lists take no more memory than the
  /// samples.
  void shorten(Index x, Scratch& scratch) const {
    scratch.exact.clear();
    for (const Bounds& bounds : scratch.kept) {
      if (bounds.sample % kGlance == 0) {
        execution_.poll();
      }
      scratch.exact.push_back(
          {samples_.squared_distance(x, bounds.sample), bounds.sample});
    }
    keep_nearest(scratch.exact, count_, NeighborOrder());
    scratch.kept.clear();
    for (const Neighbor& neighbor : scratch.exact) {
      scratch.kept.push_back({0, 0, neighbor.index});
    }
    std::sort(scratch.kept.begin(), scratch.kept.end(),
              [](const Bounds& a, const Bounds& b) { return a.sample < b.sample; });
  }

  static constexpr Offset kGlance = 256;
  static constexpr double kTiny = 1e-30;  // more than all that underflows

  const Samples& samples_;
  const Execution& execution_;
  Offset n_;
  Offset dim_;
  Offset stride_;
  Offset padded_;
  AlignedArray<T> panels_;
  std::vector<double> norms_;
  double product_error_ = 0;
  double coordinate_error_ = 0;
  Index count_ = 0;
  bool give_up_ = false;
  std::atomic<Offset> long_lists_{0};
};

}  // namespace

Csr make_shortlists(const Samples& samples, Index count, const Execution& execution) {
  const std::vector<double> center = approximate_center(samples);
  // Single precision takes half the time. Where it leaves too much in doubt, twice the
  // digits are needed: the lists are longer or shorter, what is on them decides the same.
  if (std::optional<Csr> lists =
          Products<float>(samples, center, execution).lists(count, true)) {
    return std::move(*lists);
  }
  begin_step(execution, Step::kNeighborhoods, samples.size());
  return *Products<double>(samples, center, execution).lists(count, false);
}

}  // namespace remanifold::detail
