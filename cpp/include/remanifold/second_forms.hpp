// SPDX-License-Identifier: GPL-3.0-or-later
// Tangent spaces and second fundamental forms at the vertices of a complex, by cubics.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

struct SecondForms {
  std::vector<double> tangents;  ///< orthonormal rows, K x D for each vertex; else NaN
  /// With values in the space, K x K x D for each vertex, in units of 1 / length.
  std::vector<double> forms;
};

/// Polynomials of degree 3 over a tangent space, which their slopes turn twice, through each
/// vertex and near those that are few edges away (Cazals and Pouget, Estimating
/// differential quantities using polynomial fitting of osculating jets, Computer Aided
/// Geometric Design 22, 2005). They are taken as far along the tangent space as they are
/// away: over chords a sphere is a paraboloid.
///
/// So many rings of edges as have two others a coefficient, at most four; NaN where these
/// are too few, or lie so that some coefficients are not determined. Time for each vertex
/// with n others O(n (c + D) c), c coefficients.
/// \param edges     pairs of vertices
/// \param dim       K
/// \param vertices  where
/// \throws std::invalid_argument  a vertex that is none of the points
SecondForms second_forms(const MatrixView& points, const SimplexArray& edges, int dim,
                         const std::vector<Index>& vertices,
                         const Execution& execution = {});

}  // namespace remanifold
