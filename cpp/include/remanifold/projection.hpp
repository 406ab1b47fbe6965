// SPDX-License-Identifier: GPL-3.0-or-later
// The nearest point of a simplicial complex, exactly, for any K and D.
//
// A binary tree over the simplices is searched by branch and bound. Its nodes bound from
// below by boxes, in all coordinates where these are few, else in eight of an orthonormal
// frame together with the length of what these leave out, and by balls then. The nearest
// point of a simplex is the minimum of a quadratic over its barycentric coordinates, by
// Wolfe's active sets (Finding the nearest point in a polytope, Mathematical Programming
// 11, 1976) in an orthonormal frame of the simplex.
//
// Simplices nearer than rounding to the nearest are equally near, and the lowest number
// wins: a query has one answer, whatever is asked beside it and by however many threads.
//
// Cost O(M D log M) to build; a query visits O(log M) nodes where it is near the complex.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <memory>
#include <vector>

namespace remanifold {

/// Nearest points, one a query.
struct Projections {
  std::vector<Offset> simplices;    ///< position of the simplex
  std::vector<double> barycentric;  ///< Q x (K+1), not negative, of sum 1
  std::vector<double> points;       ///< Q x D
  std::vector<double> distances;
};

class SimplexSearch {
 public:
  /// Copies the coordinates.
  /// \param vertices   N x D
  /// \param simplices  any K >= 0; degenerate ones count as the smaller ones they are
  /// \throws std::invalid_argument  no simplices, a vertex out of range, coordinates that
  ///                                are not finite
  SimplexSearch(MatrixView vertices, const SimplexArray& simplices,
                const Execution& execution = {});
  ~SimplexSearch();
  SimplexSearch(const SimplexSearch&) = delete;
  SimplexSearch& operator=(const SimplexSearch&) = delete;

  /// \param queries  Q x D
  /// \throws std::invalid_argument  other number of coordinates, or not finite
  Projections nearest(MatrixView queries, const Execution& execution = {}) const;

 private:
  class Search;
  std::unique_ptr<const Search> search_;
};

}  // namespace remanifold
