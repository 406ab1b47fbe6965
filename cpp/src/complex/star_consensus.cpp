// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/star_consensus.hpp"

#include "base/dispatch.hpp"
#include "base/parallel.hpp"
#include "base/waves.hpp"
#include "complex/simplex_rows.hpp"

#include <algorithm>

namespace remanifold {
namespace {

constexpr Offset kBlock = 512;
constexpr Offset kFewRows = 12;  // looked at one after the other

/// One sample's share of the simplices: those whose lowest vertex with a vote it is.
template <int K>
class VoteCounter {
 public:
  explicit VoteCounter(const LocalRegions& regions)
      : regions_(regions),
        dim_(regions.dim),
        simplex_(regions.dim + 1),
        others_(regions.dim) {}

  void count(Index x, StarSimplices& out) {
    for (Offset r = regions_.star_offsets[x]; r < regions_.star_offsets[x + 1]; ++r) {
      const Index* row = regions_.stars.data() + r * dim();
      int position = 0;
      for (; position < dim() && row[position] < x; ++position) {
        simplex_[position] = row[position];
      }
      simplex_[position] = x;
      std::copy(row + position, row + dim(), simplex_.begin() + position + 1);
      int votes = 1;
      bool first = true;
      for (int i = 0; i <= dim() && first; ++i) {
        if (i != position && votes_for(i)) {
          ++votes;
          first = i > position;
        }
      }
      if (first) {
        out.simplices.vertices.insert(out.simplices.vertices.end(), simplex_.begin(),
                                      simplex_.end());
        out.votes.push_back(static_cast<std::uint8_t>(votes));
      }
    }
  }

 private:
  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  /// Whether the star of the i-th vertex has the simplex.
  bool votes_for(int i) {
    const Index vertex = simplex_[i];
    std::copy_n(simplex_.begin(), i, others_.begin());
    std::copy_n(simplex_.begin() + i + 1, dim() - i, others_.begin() + i);
    Offset low = regions_.star_offsets[vertex];
    Offset high = regions_.star_offsets[vertex + 1];
    const Index* rows = regions_.stars.data();
    while (high - low > kFewRows) {
      const Offset middle = (low + high) / 2;
      if (detail::row_less(rows + middle * dim(), others_.data(), dim())) {
        low = middle + 1;
      } else {
        high = middle + 1;
      }
    }
    for (; low < high; ++low) {
      if (detail::row_equal(rows + low * dim(), others_.data(), dim())) {
        return true;
      }
    }
    return false;
  }

  const LocalRegions& regions_;
  int dim_;
  std::vector<Index> simplex_;
  std::vector<Index> others_;
};

}  // namespace

StarSimplices count_votes(const LocalRegions& regions, const Execution& execution) {
  const auto n = static_cast<Offset>(regions.star_offsets.size()) - 1;
  std::vector<StarSimplices> blocks(
      std::min((n + kBlock - 1) / kBlock, detail::kBlocksOfWave));
  StarSimplices result;
  result.simplices.arity = regions.dim + 1;
  const Offset wave_length = detail::kBlocksOfWave * kBlock;
  for (Offset wave = 0; wave < n; wave += wave_length) {
    const Offset last = std::min(n, wave + wave_length);
    detail::for_each_block_uncounted(
        last - wave, kBlock, execution, [&](Offset begin, Offset end) {
          detail::dispatch_dim(regions.dim, [&](auto k) {
            VoteCounter<decltype(k)::value> counter(regions);
            for (Offset x = wave + begin; x < wave + end; ++x) {
              counter.count(static_cast<Index>(x), blocks[begin / kBlock]);
            }
          });
        });
    for (StarSimplices& block : blocks) {
      detail::append(result.simplices.vertices, block.simplices.vertices);
      detail::append(result.votes, block.votes);
    }
    if (wave == 0) {
      detail::reserve_for(result.simplices.vertices, last, n);
      detail::reserve_for(result.votes, last, n);
    }
  }
  return result;
}

}  // namespace remanifold
