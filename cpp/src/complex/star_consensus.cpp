// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/star_consensus.hpp"

#include "base/dispatch.hpp"
#include "base/parallel.hpp"
#include "base/waves.hpp"

#include <algorithm>

namespace remanifold {
namespace {

/// Samples of one task; fewer where each has hundreds of simplices.
constexpr Offset block_size(int dim) { return dim < 4 ? 512 : 64; }

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
    rows_.clear();
    regions_.star(x).append_to(rows_);
    for (const Index* row = rows_.data(); row != rows_.data() + rows_.size();
         row += dim()) {
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
    std::copy_n(simplex_.begin(), i, others_.begin());
    std::copy_n(simplex_.begin() + i + 1, dim() - i, others_.begin() + i);
    return regions_.star(simplex_[i]).has(others_.data());
  }

  const LocalRegions& regions_;
  int dim_;
  std::vector<Index> rows_;
  std::vector<Index> simplex_;
  std::vector<Index> others_;
};

}  // namespace

StarSimplices count_votes(const LocalRegions& regions, const Execution& execution) {
  const auto n = static_cast<Offset>(regions.star_offsets.size()) - 1;
  const Offset block_length = block_size(regions.dim);
  const Offset num_blocks = detail::blocks_of_wave(execution);
  std::vector<StarSimplices> blocks(
      std::min((n + block_length - 1) / block_length, num_blocks));
  StarSimplices result;
  result.simplices.arity = regions.dim + 1;
  const Offset wave_length = num_blocks * block_length;
  for (Offset wave = 0; wave < n; wave += wave_length) {
    const Offset last = std::min(n, wave + wave_length);
    detail::for_each_block_uncounted(
        last - wave, block_length, execution, [&](Offset begin, Offset end) {
          detail::dispatch_dim(regions.dim, [&](auto k) {
            VoteCounter<decltype(k)::value> counter(regions);
            for (Offset x = wave + begin; x < wave + end; ++x) {
              counter.count(static_cast<Index>(x), blocks[begin / block_length]);
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
