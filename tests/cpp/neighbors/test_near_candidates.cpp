// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/rank_few.hpp"
#include "neighbors/near_candidates.hpp"
#include "samples/distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace remanifold {
namespace {

TEST(RankFew, CountsThoseThatAreLess) {
  std::mt19937 random(1);
  for (std::size_t count = 1; count < 100; ++count) {
    const std::size_t padded = (count + detail::kRankedTogether - 1) /
                               detail::kRankedTogether * detail::kRankedTogether;
    std::vector<float> keys(padded, std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
      keys[i] = static_cast<float>(random() % 50);  // some are equal
    }
    std::vector<std::int32_t> ranks(padded);
    detail::rank_few(keys.data(), static_cast<Index>(padded), ranks.data());
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(ranks[i], std::count_if(keys.begin(), keys.end(),
                                        [&](float key) { return key < keys[i]; }));
    }
  }
}

TEST(NearCandidates, PicksInOrderWhatIsNoLargerThanTheLimit) {
  std::mt19937 random(2);
  for (Index count = 0; count < 40; ++count) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& value : values) {
      value = static_cast<double>(random() % 9);
    }
    for (const double limit : {-1.0, 0.0, 4.0, 9.0}) {
      std::vector<Index> places(static_cast<std::size_t>(count + detail::kPickSlack));
      places.resize(static_cast<std::size_t>(
          detail::pick_near(values.data(), count, limit, places.data())));
      std::vector<Index> expected;
      for (Index i = 0; i < count; ++i) {
        if (values[static_cast<std::size_t>(i)] <= limit) {
          expected.push_back(i);
        }
      }
      EXPECT_EQ(places, expected) << count << " below " << limit;
    }
  }
}

TEST(NearCandidates, DistancesAreThoseOfTheCoreToTheLastBit) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int dim = 1; dim < 8; ++dim) {
    for (Index count = 1; count < 20; ++count) {
      const Index stride = (count + 3) / 4 * 4;
      std::vector<double> axes(static_cast<std::size_t>(dim * stride));
      std::vector<double> point(static_cast<std::size_t>(dim));
      std::generate(axes.begin(), axes.end(), [&] { return normal(random); });
      std::generate(point.begin(), point.end(), [&] { return normal(random); });
      std::vector<double> sums(static_cast<std::size_t>(stride));
      detail::squared_distances(point.data(), axes.data(), stride, dim, count,
                                sums.data());
      for (Index i = 0; i < count; ++i) {
        std::vector<double> other;
        for (int a = 0; a < dim; ++a) {
          other.push_back(axes[static_cast<std::size_t>(a * stride + i)]);
        }
        EXPECT_EQ(sums[static_cast<std::size_t>(i)],
                  detail::squared_distance(point.data(), other.data(),
                                           static_cast<std::size_t>(dim)));
      }
    }
  }
}

}  // namespace
}  // namespace remanifold
