// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/star_consensus.hpp"

#include "detail/parallel.hpp"

#include <algorithm>

namespace remanifold {
namespace {

constexpr Offset kBlock = 512;

/// The stars, K vertices a row, each row and the rows of each star sorted.
std::vector<Index> sorted_stars(const LocalRegions& regions,
                                const Execution& execution) {
  const int dim = regions.dim;
  std::vector<Index> rows(regions.stars.size());
  const auto n = static_cast<Offset>(regions.star_offsets.size()) - 1;
  detail::for_each_block_uncounted(n, kBlock, execution, [&](Offset begin, Offset end) {
    std::vector<Index> star;
    std::vector<Offset> order;
    for (Offset x = begin; x < end; ++x) {
      const Offset first = regions.star_offsets[x];
      const Offset count = regions.star_offsets[x + 1] - first;
      star.assign(regions.stars.begin() + first * dim,
                  regions.stars.begin() + (first + count) * dim);
      order.resize(count);
      for (Offset r = 0; r < count; ++r) {
        std::sort(star.begin() + r * dim, star.begin() + (r + 1) * dim);
        order[r] = r;
      }
      std::sort(order.begin(), order.end(), [&](Offset a, Offset b) {
        return std::lexicographical_compare(
            star.begin() + a * dim, star.begin() + (a + 1) * dim,
            star.begin() + b * dim, star.begin() + (b + 1) * dim);
      });
      for (Offset r = 0; r < count; ++r) {
        std::copy_n(star.begin() + order[r] * dim, dim,
                    rows.begin() + (first + r) * dim);
      }
    }
  });
  return rows;
}

/// One sample's share of the simplices: those whose lowest vertex with a vote it is.
class VoteCounter {
 public:
  VoteCounter(const LocalRegions& regions, const std::vector<Index>& rows)
      : regions_(regions),
        rows_(rows),
        dim_(regions.dim),
        simplex_(dim_ + 1),
        others_(dim_) {}

  void count(Index x, StarSimplices& out) {
    for (Offset r = regions_.star_offsets[x]; r < regions_.star_offsets[x + 1]; ++r) {
      const Index* row = rows_.data() + r * dim_;
      const Index* above = std::lower_bound(row, row + dim_, x);
      auto end = std::copy(row, above, simplex_.begin());
      *end++ = x;
      std::copy(above, row + dim_, end);
      int votes = 1;
      bool first = true;
      for (int i = 0; i <= dim_ && first; ++i) {
        if (simplex_[i] != x && votes_for(simplex_[i])) {
          ++votes;
          first = simplex_[i] > x;
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
  bool votes_for(Index vertex) {
    std::remove_copy(simplex_.begin(), simplex_.end(), others_.begin(), vertex);
    Offset low = regions_.star_offsets[vertex];
    Offset high = regions_.star_offsets[vertex + 1];
    while (low < high) {
      const Offset middle = (low + high) / 2;
      const Index* row = rows_.data() + middle * dim_;
      if (std::lexicographical_compare(row, row + dim_, others_.begin(),
                                       others_.end())) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low < regions_.star_offsets[vertex + 1] &&
           std::equal(others_.begin(), others_.end(), rows_.begin() + low * dim_);
  }

  const LocalRegions& regions_;
  const std::vector<Index>& rows_;
  int dim_;
  std::vector<Index> simplex_;
  std::vector<Index> others_;
};

}  // namespace

StarSimplices count_votes(const LocalRegions& regions, const Execution& execution) {
  const std::vector<Index> rows = sorted_stars(regions, execution);
  const auto n = static_cast<Offset>(regions.star_offsets.size()) - 1;
  std::vector<StarSimplices> blocks((n + kBlock - 1) / kBlock);
  detail::for_each_block_uncounted(n, kBlock, execution, [&](Offset begin, Offset end) {
    VoteCounter counter(regions, rows);
    for (Offset x = begin; x < end; ++x) {
      counter.count(static_cast<Index>(x), blocks[begin / kBlock]);
    }
  });
  StarSimplices result;
  result.simplices.arity = regions.dim + 1;
  std::size_t total = 0;
  for (const StarSimplices& block : blocks) {
    total += block.votes.size();
  }
  result.votes.reserve(total);
  result.simplices.vertices.reserve(total * result.simplices.arity);
  for (StarSimplices& block : blocks) {
    result.votes.insert(result.votes.end(), block.votes.begin(), block.votes.end());
    result.simplices.vertices.insert(result.simplices.vertices.end(),
                                     block.simplices.vertices.begin(),
                                     block.simplices.vertices.end());
    block = {};
  }
  return result;
}

}  // namespace remanifold
