// SPDX-License-Identifier: GPL-3.0-or-later
// Exact nearest neighbors by looking at every sample. Those of all points are found
// together: products of all with all tell which samples are in question, the exact
// distances of these decide.
#include "base/parallel.hpp"
#include "neighbors/neighbor_search.hpp"
#include "neighbors/shortlists.hpp"

#include <algorithm>

namespace remanifold::detail {
namespace {

class BruteForce final : public NeighborSearch::Implementation {
 public:
  explicit BruteForce(const Samples& samples) : samples_(samples) {}

  std::unique_ptr<NeighborSearch::Query> query(
      const Execution& execution) const override {
    return std::make_unique<BruteForceQuery>(samples_, execution);
  }

  Index block_size() const override { return 16; }

  bool find_all(Index count, const Execution& execution,
                Neighborhoods& result) const override {
    if (!samples_.has_points() || count < 1) {
      return false;
    }
    const Csr lists = make_shortlists(samples_, count, execution);
    const std::vector<double> distances =
        measure_shortlists(samples_, lists, execution);
    const Offset n = samples_.size();
    result.count = count;
    result.indices.resize(static_cast<std::size_t>(n) * count);
    result.squared_distances.resize(result.indices.size());
    const NeighborOrder order;
    for_each_block_uncounted(n, kBlock, execution, [&](Offset begin, Offset end) {
      std::vector<Neighbor> list;
      for (Offset i = begin; i < end; ++i) {
        list.clear();
        for (Offset slot = lists.offsets[i]; slot < lists.offsets[i + 1]; ++slot) {
          list.push_back({distances[slot], lists.indices[slot]});
        }
        keep_nearest(list, count, order);
        for (Index k = 0; k < count; ++k) {
          result.indices[i * count + k] = list[k].index;
          result.squared_distances[i * count + k] = list[k].squared_distance;
        }
      }
    });
    return true;
  }

 private:
  static constexpr Offset kBlock = 256;

  class BruteForceQuery final : public NeighborSearch::Query {
   public:
    BruteForceQuery(const Samples& samples, const Execution& execution)
        : samples_(samples), execution_(execution) {}

    bool looks_at_all() const override { return true; }

    void nearest(Index x, Index count, double squared_radius,
                 std::vector<Neighbor>& out) override {
      count = std::min(count, samples_.size() - 1);
      out.clear();
      if (count < 1) {
        return;
      }
      execution_.poll();
      for (Index q = 0; q < samples_.size(); ++q) {
        const double squared_distance = samples_.squared_distance(x, q);
        if (q != x && squared_distance <= squared_radius) {
          out.push_back({squared_distance, q});
        }
      }
      keep_nearest(out, count, order_);
    }

   private:
    const Samples& samples_;
    Execution execution_;
    NeighborOrder order_;
  };

  const Samples& samples_;
};

}  // namespace

std::unique_ptr<NeighborSearch::Implementation> make_brute_force(
    const Samples& samples) {
  return std::make_unique<BruteForce>(samples);
}

}  // namespace remanifold::detail
