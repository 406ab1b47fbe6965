// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold after each step, written once. Each function costs about as much as the
// step and throws std::logic_error where something does not hold. The steps call them
// where assertions are on (no NDEBUG: Debug, the sanitizers); anybody may at any time.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/manifold_complex.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/projection.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/tangent_space.hpp"
#include "remanifold/types.hpp"

namespace remanifold {

/// Rows of others only, nearest first, each once.
void verify_neighborhoods(const Samples& samples, const Neighborhoods& neighborhoods);

/// Bases are orthonormal or, at boundary samples, absent.
void verify_tangent_spaces(const Samples& samples, const TangentSpaces& tangents);

/// Edge sets ascend without the sample itself; stars are sorted and use the edge set only;
/// each facet at x of a bounded region has two simplices.
void verify_local_regions(const LocalRegions& regions);

/// Columns ascend, rows ascend and differ, vertices are in range.
void verify_simplices(const SimplexArray& simplices, Index num_vertices);

/// What the report says of the complex: open and branching facets, singular vertices,
/// samples in no simplex; and patches with an orientation that agrees across facets.
void verify_manifold_complex(const ManifoldComplex& complex, Index num_samples,
                             const Execution& execution = {});

/// Barycentric coordinates are not negative and sum to one; points are as far away as the
/// distances say.
void verify_projections(const Projections& projections, MatrixView queries);

}  // namespace remanifold
