// SPDX-License-Identifier: GPL-3.0-or-later
// Small complexes shared by the tests.
#pragma once

#include "remanifold/cavities.hpp"
#include "remanifold/simplex_measures.hpp"
#include "support.hpp"

#include <cstdint>
#include <vector>

namespace remanifold::testing {

inline const SimplexArray kTetrahedron{3, {0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3}};
inline const SimplexArray kProjectivePlane{
    3, {0, 1, 2, 0, 1, 4, 0, 2, 5, 0, 3, 4, 0, 3, 5,
        1, 2, 3, 1, 3, 5, 1, 4, 5, 2, 3, 4, 2, 4, 5}};

/// Boundary of the simplex on 0 .. dim + 1: the smallest sphere. Its first facets leave out
/// the last vertices.
inline SimplexArray simplex_boundary(int dim) {
  SimplexArray result{dim + 1, {}};
  for (Index out = dim + 1; out >= 0; --out) {
    for (Index v = 0; v <= dim + 1; ++v) {
      if (v != out) {
        result.vertices.push_back(v);
      }
    }
  }
  return result;
}

/// Samples that keep their numbers, which points do not.
struct Numbered {
  std::vector<double> distances;
  Samples samples;

  explicit Numbered(const Cloud& cloud)
      : distances(distances_of(cloud)),
        samples(
            Samples::from_distances({distances.data(), cloud.size(), cloud.size()})) {}
};

/// A square, one corner moved inwards, with a fixed triangle on each side.
struct SquareHole {
  Numbered given{{{0, 0, 1, 0, 0.8, 0.8, 0, 1, 0.5, -1, 2, 0.5, 0.5, 2, -1, 0.5}, 2}};
  std::vector<double> scales = std::vector<double>(8, 1.0);
  SimplexRuler ruler{given.samples, scales};
  SimplexArray fixed{3, {0, 1, 4, 1, 2, 5, 2, 3, 6, 0, 3, 7}};
  SimplexArray candidates{3, {1, 2, 3, 0, 1, 2, 0, 1, 3, 0, 2, 3, 0, 1, 2}};
  std::vector<std::uint8_t> inside{1, 1, 1, 1, 0, 0, 0, 0};

  Cavities find(double price) {
    return find_cavities(fixed, inside, candidates, ruler,
                         [=](const Index*) { return price; });
  }
};

}  // namespace remanifold::testing
