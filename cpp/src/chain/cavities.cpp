// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/cavities.hpp"

#include "base/csr.hpp"
#include "base/disjoint_sets.hpp"
#include "complex/simplex_rows.hpp"

#include <algorithm>
#include <numeric>

namespace remanifold {
namespace {

/// Cosine of the angle at a facet above which a candidate lies back on the fixed simplex
/// there: less than 20 degrees. Without this, small patches are closed by a second sheet.
constexpr double kFoldedBack = 0.94;
/// Sums of energies and prices are equal up to this.
constexpr double kRounding = 1e-9;

/// Rows of small integers, each row ascending, from pairs (row, entry).
Csr to_csr(Index rows, const std::vector<Index>& row_of) {
  return detail::csr_of(rows, [&](const auto& add) {
    for (std::size_t entry = 0; entry < row_of.size(); ++entry) {
      add(row_of[entry], static_cast<Index>(entry));
    }
  });
}

/// The facets inside, of fixed simplices and candidates together.
struct FacetTable {
  FacetGroups groups;
  std::vector<Index> fixed_cofaces;   // of each group
  std::vector<std::uint8_t> counted;  // all its vertices are inside
};

FacetTable make_table(const SimplexArray& all, Offset num_fixed,
                      const std::vector<std::uint8_t>& inside,
                      const Execution& execution) {
  FacetTable table;
  table.groups = group_facets(all, static_cast<Index>(inside.size()), execution);
  table.fixed_cofaces.assign(table.groups.size(), 0);
  table.counted.assign(table.groups.size(), 1);
  std::vector<Index> vertices(all.arity - 1);
  for (Offset g = 0; g < table.groups.size(); ++g) {
    copy_facet(all, table.groups.facets[table.groups.offsets[g]], vertices.data());
    table.counted[g] = std::all_of(vertices.begin(), vertices.end(),
                                   [&](Index v) { return inside[v] != 0; });
    for (Offset i = table.groups.offsets[g]; i < table.groups.offsets[g + 1]; ++i) {
      table.fixed_cofaces[g] += table.groups.facets[i] / all.arity < num_fixed ? 1 : 0;
    }
  }
  return table;
}

/// What each group of facets costs where it is left open; of those inside.
std::vector<double> prices_of(const SimplexArray& all, const FacetTable& table,
                              const FacetPrice& price) {
  std::vector<double> prices(table.groups.size(), 0.0);
  std::vector<Index> vertices(all.arity - 1);
  for (Offset g = 0; g < table.groups.size(); ++g) {
    if (table.counted[g] != 0) {
      copy_facet(all, table.groups.facets[table.groups.offsets[g]], vertices.data());
      prices[g] = price(vertices.data());
    }
  }
  return prices;
}

/// A candidate of more energy than leaving all its facets open costs is in no chain of
/// least energy: without it the chain costs less, whatever else is on these facets.
void block_hopeless(const FacetTable& table, Offset num_fixed, int arity,
                    const std::vector<double>& prices,
                    const std::vector<double>& energies,
                    std::vector<std::uint8_t>& blocked) {
  std::vector<double> worth(energies.size(), 0.0);
  for (Offset g = 0; g < table.groups.size(); ++g) {
    for (Offset i = table.groups.offsets[g]; i < table.groups.offsets[g + 1]; ++i) {
      const Offset candidate = table.groups.facets[i] / arity - num_fixed;
      if (candidate >= 0) {
        worth[candidate] += prices[g];
      }
    }
  }
  for (std::size_t c = 0; c < blocked.size(); ++c) {
    if (energies[c] > (1 + kRounding) * worth[c]) {
      blocked[c] = 1;
    }
  }
}

}  // namespace

Cavities find_cavities(const SimplexArray& fixed,
                       const std::vector<std::uint8_t>& inside,
                       const SimplexArray& candidates, SimplexRuler& ruler,
                       const FacetPrice& price, bool fold_back,
                       const Execution& execution) {
  const int arity = fixed.arity;
  Cavities result;
  result.candidates = detail::sorted_unique(candidates);
  result.facets.arity = arity - 1;

  SimplexArray all = fixed;
  all.vertices.insert(all.vertices.end(), result.candidates.vertices.begin(),
                      result.candidates.vertices.end());
  const Offset num_fixed = fixed.size();
  const FacetTable table = make_table(all, num_fixed, inside, execution);

  // Candidates behind a facet that already has both its cofaces go, and those folded back.
  std::vector<std::uint8_t> blocked(result.candidates.size(), 0);
  std::vector<Index> vertices(arity - 1);
  for (Offset g = 0; g < table.groups.size(); ++g) {
    const bool closed = table.fixed_cofaces[g] >= 2 || table.counted[g] == 0;
    if (!closed && (table.fixed_cofaces[g] == 0 || arity == 2 || fold_back)) {
      continue;
    }
    const FacetNumber rim = table.groups.facets[table.groups.offsets[g]];
    copy_facet(all, rim, vertices.data());
    for (Offset i = table.groups.offsets[g]; i < table.groups.offsets[g + 1]; ++i) {
      const FacetNumber f = table.groups.facets[i];
      const Offset simplex = f / arity;
      if (simplex >= num_fixed &&
          (closed ||
           ruler.fold(vertices.data(), arity - 1, all[rim / arity][rim % arity],
                      all[simplex][f % arity]) > kFoldedBack)) {
        blocked[simplex - num_fixed] = 1;
      }
    }
  }
  const std::vector<double> prices = prices_of(all, table, price);
  std::vector<double> energies(blocked.size());
  for (std::size_t c = 0; c < energies.size(); ++c) {
    energies[c] = ruler.energy(result.candidates[static_cast<Offset>(c)], arity);
  }
  if (arity > 2) {
    block_hopeless(table, num_fixed, arity, prices, energies, blocked);
  }
  detail::erase_rows(result.candidates, blocked);
  const auto num_candidates = static_cast<Index>(result.candidates.size());
  std::vector<Index> number_of(blocked.size());  // of the candidates that are left
  for (std::size_t c = 1; c < blocked.size(); ++c) {
    number_of[c] = number_of[c - 1] + (blocked[c - 1] == 0 ? 1 : 0);
  }

  result.facets_of.assign(static_cast<std::size_t>(num_candidates) * arity, -1);
  std::vector<FacetNumber> facets;
  for (Offset g = 0; g < table.groups.size(); ++g) {
    if (table.counted[g] == 0) {
      continue;
    }
    facets.clear();
    for (Offset i = table.groups.offsets[g]; i < table.groups.offsets[g + 1]; ++i) {
      const Offset simplex = table.groups.facets[i] / arity;
      if (simplex < num_fixed || blocked[simplex - num_fixed] == 0) {
        facets.push_back(table.groups.facets[i]);
      }
    }
    if (facets.empty()) {
      continue;
    }
    // Numbers ascend: the fixed ones come first.
    const FacetNumber rim = facets.front() / arity < num_fixed ? facets.front() : kOpen;
    if (facets.back() / arity < num_fixed) {
      if (facets.size() == 1) {
        result.dead_ends.push_back(rim);
      }
      continue;
    }
    const auto number = static_cast<Index>(result.prices.size());
    copy_facet(all, facets.front(), vertices.data());
    detail::append_row(result.facets, vertices.data());
    result.prices.push_back(prices[g]);
    result.rims.push_back(rim);
    if (ruler.fills_space(arity)) {
      result.rim_orientations.push_back(static_cast<std::int8_t>(
          rim == kOpen ? 0 : ruler.orientation(all[rim / arity], arity)));
    }
    for (const FacetNumber f : facets) {
      if (f / arity >= num_fixed) {
        const Index candidate = number_of[f / arity - num_fixed];
        result.facets_of[static_cast<std::size_t>(candidate) * arity + f % arity] =
            number;
      }
    }
  }

  for (std::size_t c = 0; c < blocked.size(); ++c) {
    if (blocked[c] == 0) {
      result.energies.push_back(energies[c]);
    }
  }
  for (Index c = 0; c < num_candidates; ++c) {
    if (ruler.fills_space(arity)) {
      result.orientations.push_back(
          static_cast<std::int8_t>(ruler.orientation(result.candidates[c], arity)));
    }
  }

  const auto num_facets = static_cast<Index>(result.prices.size());
  result.candidates_on = to_csr(num_facets, result.facets_of);
  for (Index& entry : result.candidates_on.indices) {
    entry /= arity;
  }
  detail::DisjointSets sets(num_candidates);
  for (Index f = 0; f < num_facets; ++f) {
    const Index* row = result.candidates_on.begin(f);
    for (Offset i = 1; i < result.candidates_on.size(f); ++i) {
      sets.join(row[0], row[i]);
    }
  }
  std::vector<Index> cavity(num_candidates);
  Index count = 0;
  for (Index c = 0; c < num_candidates; ++c) {
    const auto root = static_cast<Index>(sets.find(c));
    cavity[c] = root == c ? count++ : cavity[root];
  }
  std::vector<Index> cavity_of_facet(num_facets);
  for (Index f = 0; f < num_facets; ++f) {
    cavity_of_facet[f] = cavity[*result.candidates_on.begin(f)];
  }
  result.candidates_in = to_csr(count, cavity);
  result.facets_in = to_csr(count, cavity_of_facet);
  return result;
}

}  // namespace remanifold
