// SPDX-License-Identifier: GPL-3.0-or-later
// Exact distances of many pairs. The order of the sums is that of
// detail::squared_distance(), each of whose four sums is an element of a vector here; wider
// registers then change nothing but the time.
#include "base/parallel.hpp"
#include "base/per_thread.hpp"
#include "neighbors/shortlists.hpp"
#include "samples/distance.hpp"

#include <algorithm>

namespace remanifold::detail {
namespace {

#define REMANIFOLD_INLINE inline __attribute__((always_inline))

/// Samples whose pairs are measured together, and coordinates that are gathered at a time:
/// rows of large D are powers of two apart more often than caches like.
constexpr Offset kRows = 128;
constexpr Offset kDepth = 256;
/// From here on a distance costs more than to find out that it is known.
constexpr int kShareFrom = 256;

using Sums = double __attribute__((vector_size(32)));
// Not by using: Clang would not heed the alignment there.
typedef double Loose __attribute__((vector_size(32), aligned(8), may_alias));

template <int kPairs>
REMANIFOLD_INLINE void add_some(const double* x, const double* rows,
                                const Index* others, Offset depth, double* sums) {
  Sums local[kPairs];
  const double* q[kPairs];
#pragma GCC unroll 4
  for (int i = 0; i < kPairs; ++i) {
    local[i] = *reinterpret_cast<const Loose*>(sums + 4 * i);
    q[i] = rows + others[i] * kDepth;
  }
  for (Offset k = 0; k < depth; k += 4) {
    const Sums left = *reinterpret_cast<const Loose*>(x + k);
#pragma GCC unroll 4
    for (int i = 0; i < kPairs; ++i) {
      const Sums difference = left - *reinterpret_cast<const Loose*>(q[i] + k);
      local[i] += difference * difference;
    }
  }
#pragma GCC unroll 4
  for (int i = 0; i < kPairs; ++i) {
    *reinterpret_cast<Loose*>(sums + 4 * i) = local[i];
  }
}

/// sums[i] += squared differences of x and the row others[i], for a depth divisible by 4.
REMANIFOLD_INLINE void add_all(const double* x, const double* rows, const Index* others,
                               Offset count, Offset depth, double* sums) {
  Offset i = 0;
  for (; i + 4 <= count; i += 4) {
    add_some<4>(x, rows, others + i, depth, sums + 4 * i);
  }
  for (; i < count; ++i) {
    add_some<1>(x, rows, others + i, depth, sums + 4 * i);
  }
}

using AddSquares = void (*)(const double*, const double*, const Index*, Offset, Offset,
                            double*);

void add_squares_plain(const double* x, const double* rows, const Index* others,
                       Offset count, Offset depth, double* sums) {
  add_all(x, rows, others, count, depth, sums);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void add_squares_avx2(const double* x,
                                                      const double* rows,
                                                      const Index* others, Offset count,
                                                      Offset depth, double* sums) {
  add_all(x, rows, others, count, depth, sums);
}
#endif

AddSquares choose() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return add_squares_avx2;
  }
#endif
  return add_squares_plain;
}

/// Where `sample` is on the list of x; -1 where it is not.
Offset find(const Csr& lists, Index x, Index sample) {
  const Index* found = std::lower_bound(lists.begin(x), lists.end(x), sample);
  return found != lists.end(x) && *found == sample ? found - lists.indices.data() : -1;
}

/// The pairs of a block of samples with those on their lists.
class BlockDistances {
 public:
  BlockDistances(const Samples& samples, const Csr& lists, bool share,
                 std::vector<double>& out)
      : samples_(samples),
        lists_(lists),
        share_(share),
        out_(out),
        row_of_(samples.size(), -1) {}

  void compute(Index begin, Index end, const Execution& execution) {
    static const AddSquares add_squares = choose();
    collect(begin, end);
    const Offset dim = samples_.ambient_dim();
    const Offset fours = dim - dim % 4;
    sums_.assign(4 * others_.size(), 0.0);
    rows_.resize(members_.size() * kDepth);
    for (Offset first = 0; first < fours; first += kDepth) {
      execution.poll();
      const Offset depth = std::min(kDepth, fours - first);
      for (std::size_t i = 0; i < members_.size(); ++i) {
        std::copy_n(samples_.point(members_[i]) + first, depth,
                    rows_.data() + i * kDepth);
      }
      for (Index x = begin; x < end; ++x) {
        const Offset pair = pairs_[x - begin];
        add_squares(rows_.data() + row_of_[x] * kDepth, rows_.data(),
                    others_.data() + pair, pairs_[x - begin + 1] - pair, depth,
                    sums_.data() + 4 * pair);
      }
    }
    for (Index x = begin; x < end; ++x) {
      const double* px = samples_.point(x);
      for (Offset pair = pairs_[x - begin]; pair < pairs_[x - begin + 1]; ++pair) {
        double* sums = sums_.data() + 4 * pair;
        const double* pq = samples_.point(members_[others_[pair]]);
        for (Offset j = fours; j < dim; ++j) {
          sums[0] += (px[j] - pq[j]) * (px[j] - pq[j]);
        }
        out_[slots_[pair]] = (sums[0] + sums[1]) + (sums[2] + sums[3]);
      }
    }
    for (const Index member : members_) {
      row_of_[member] = -1;
    }
  }

 private:
  void collect(Index begin, Index end) {
    members_.clear();
    others_.clear();
    slots_.clear();
    pairs_.assign(1, 0);
    for (Index x = begin; x < end; ++x) {
      row(x);
      for (Offset slot = lists_.offsets[x]; slot < lists_.offsets[x + 1]; ++slot) {
        const Index q = lists_.indices[slot];
        if (q > x || !share_ || find(lists_, q, x) < 0) {
          others_.push_back(row(q));
          slots_.push_back(slot);
        }
      }
      pairs_.push_back(static_cast<Offset>(others_.size()));
    }
  }

  Index row(Index sample) {
    if (row_of_[sample] < 0) {
      row_of_[sample] = static_cast<Index>(members_.size());
      members_.push_back(sample);
    }
    return row_of_[sample];
  }

  const Samples& samples_;
  const Csr& lists_;
  bool share_;
  std::vector<double>& out_;
  std::vector<Index> row_of_;   // of each sample among the rows, or -1
  std::vector<Index> members_;  // the sample of each row
  std::vector<Offset> pairs_;   // where the pairs of each sample of the block begin
  std::vector<Index> others_;   // the other row of each pair
  std::vector<Offset> slots_;   // where the distance belongs
  std::vector<double> rows_;
  std::vector<double> sums_;
};

}  // namespace

std::vector<double> measure_shortlists(const Samples& samples, const Csr& lists,
                                       const Execution& execution) {
  std::vector<double> distances(lists.indices.size());
  const Offset n = samples.size();
  if (samples.ambient_dim() < 8) {
    for_each_block_uncounted(n, kRows, execution, [&](Offset begin, Offset end) {
      for (Offset x = begin; x < end; ++x) {
        for (Offset slot = lists.offsets[x]; slot < lists.offsets[x + 1]; ++slot) {
          distances[slot] =
              samples.squared_distance(static_cast<Index>(x), lists.indices[slot]);
        }
      }
    });
    return distances;
  }
  const bool share = samples.ambient_dim() >= kShareFrom;
  ThreadScratch<BlockDistances> blocks(
      [&] { return BlockDistances(samples, lists, share, distances); });
  for_each_block_uncounted(n, kRows, execution, [&](Offset begin, Offset end) {
    blocks.use([&](BlockDistances& block) {
      block.compute(static_cast<Index>(begin), static_cast<Index>(end), execution);
    });
  });
  if (share) {
    for_each_block_uncounted(n, kRows, execution, [&](Offset begin, Offset end) {
      for (Offset x = begin; x < end; ++x) {
        for (Offset slot = lists.offsets[x]; slot < lists.offsets[x + 1]; ++slot) {
          const Index q = lists.indices[slot];
          const Offset known =
              q < x ? find(lists, q, static_cast<Index>(x)) : Offset{-1};
          if (known >= 0) {
            distances[slot] = distances[known];
          }
        }
      }
    });
  }
  return distances;
}

}  // namespace remanifold::detail
