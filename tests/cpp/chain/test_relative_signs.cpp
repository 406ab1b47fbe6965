// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/cavity_search.hpp"
#include "chain/relative_signs.hpp"
#include "complexes.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

namespace remanifold {
namespace {

using testing::SquareHole;

/// The signs of the four triangles around the hole, each a group of its own, as given by
/// the bits.
detail::RimOrientation::Signs apart(unsigned bits) {
  detail::RimOrientation::Signs rims;
  for (int i = 0; i < 4; ++i) {
    rims.sign.push_back((bits >> i & 1) != 0 ? std::int8_t{-1} : std::int8_t{1});
    rims.group.push_back(i);
  }
  rims.num_groups = 4;
  return rims;
}

TEST(RelativeSigns, TheRimBecomesACycle) {
  SquareHole hole;
  const Cavities cavities = hole.find(7);
  ASSERT_EQ(cavities.count(), 1);
  for (unsigned bits = 0; bits < 16; ++bits) {
    const auto signs =
        detail::relative_signs(detail::whole_cavity(cavities, 0), apart(bits));
    ASSERT_EQ(signs.size(), 6U);
    std::vector<int> boundary(4, 0);
    int rims = 0;
    for (std::size_t f = 0; f < signs.size(); ++f) {
      const Index facet = cavities.facets_in.begin(0)[f];
      const FacetNumber rim = cavities.rims[facet];
      if (rim == kOpen) {
        EXPECT_EQ(signs[f], 0);
        continue;
      }
      ++rims;
      const int side = signs[f] * ((rim % 3) % 2 == 0 ? 1 : -1);
      boundary[cavities.facets[facet][0]] -= side;
      boundary[cavities.facets[facet][1]] += side;
    }
    EXPECT_EQ(rims, 4);
    EXPECT_EQ(boundary, std::vector<int>(4, 0)) << "signs " << bits;
  }
}

TEST(RelativeSigns, OneGroupStaysAsItIs) {
  SquareHole hole;
  const Cavities cavities = hole.find(7);
  detail::RimOrientation::Signs rims = apart(0);
  rims.group.assign(4, 0);
  rims.num_groups = 1;
  const auto signs = detail::relative_signs(detail::whole_cavity(cavities, 0), rims);
  EXPECT_EQ(std::accumulate(signs.begin(), signs.end(), 0), 4);
}

TEST(RelativeSigns, AFillingHasAnOrientationWhereTheRimIsACycle) {
  SquareHole hole;
  const Cavities cavities = hole.find(7);
  const detail::CavityPart part = detail::whole_cavity(cavities, 0);
  const Execution execution;
  detail::CavitySearch search(cavities, execution);
  ASSERT_TRUE(search.run(0, 100));
  ASSERT_EQ(search.chosen().size(), 2U);
  const std::vector<std::int8_t> cycle = detail::relative_signs(part, apart(0));
  EXPECT_TRUE(detail::has_orientation(part, cycle, search.chosen()));
  for (std::size_t f = 0; f < cycle.size(); ++f) {
    std::vector<std::int8_t> turned = cycle;
    turned[f] = static_cast<std::int8_t>(-turned[f]);
    EXPECT_EQ(detail::has_orientation(part, turned, search.chosen()), cycle[f] == 0);
  }
}

}  // namespace
}  // namespace remanifold
