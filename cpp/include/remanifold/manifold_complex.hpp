// SPDX-License-Identifier: GPL-3.0-or-later
// From the stars of all samples to a manifold: what the stars agree on is fixed, the
// cavities between are filled by the chain of least energy, first from the disputed
// simplices, then, where facets stay open, from more and more candidates; samples left
// out are put back; links are checked.
#pragma once

#include "remanifold/constants.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/facets.hpp"
#include "remanifold/global_statistics.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/minimum_chain.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/openings.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/tangent_space.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace remanifold {

/// Samples around what stays open when all that is near was tried: what is tried last, the
/// Delaunay triangulation of these, depends on all of them.
struct OpenRegion {
  std::vector<Index> here;        ///< ascending
  std::vector<double> elsewhere;  ///< of a part: coordinates of the others of the whole
};

enum class BoundaryRule {
  kAuto,   ///< open where a hole is wider than hole_radius
  kNone,   ///< everything is closed
  kGiven,  ///< facets may be open where all their vertices are boundary samples
};

struct ManifoldOptions {
  BoundaryRule boundary = BoundaryRule::kAuto;
  std::vector<std::uint8_t> boundary_samples;  ///< size() flags for kGiven
  /// Radius of the smallest round hole that is left open, in units of the local scale h;
  /// 0: by how evenly the samples lie, from kRandomHoleRadius to kEvenHoleRadius times
  /// hole_radius_share(K).
  double hole_radius = 0;
  /// With hole_radius 0, openings that bridge more missing samples than this chance allows
  /// are opened as well, up to K = kMaxOpeningDim: the chance of one false opening in the
  /// whole data.
  double significance = kSignificance;
  /// By hand; they hold whatever rule decides on the rest.
  std::vector<OpeningDecision> decisions;
  /// Agreed simplices with a circumradius up to this times h are fixed, and with a boundary
  /// up to hole_share times hole_radius: long holes have a smaller circumradius than round
  /// ones of the same price.
  double fixed_radius = 2.5;
  double hole_share = 0.7;
  /// Simplices with a larger circumradius than this times h are never used.
  double largest_radius = 12;
  /// Patches of fewer fixed simplices are up for choice again (K >= 2).
  Offset smallest_patch = 20;
  /// K = 1: loops of fewer samples are merged with what is next to them.
  Index smallest_loop = 10;
  /// Samples farther than this times h from the simplices around them are outliers.
  double outlier_distance = kOutlierDistance;
  /// Whether there was clutter around the samples: spikes are what is left of it then.
  bool among_clutter = false;
  ChainOptions chain;
  /// Of a part: what is known of the whole.
  std::optional<OpenRegion> open_region;
};

struct ManifoldReport {
  double hole_radius = 0;    ///< as used
  double hole_size = 0;      ///< the same where the local scale is the median of all
  SimplexArray disputed;     ///< star simplices not in the stars of all their vertices
  SimplexArray filled;       ///< simplices of the result that were not fixed
  SimplexArray open_facets;  ///< (K-1)-faces with one coface
  SimplexArray branching_facets;  ///< (K-1)-faces with more than two cofaces
  std::vector<Index> singular;    ///< vertices whose link is neither sphere nor ball
  std::vector<Index> inserted;    ///< left out by the chain, put back by subdivision
  /// Where simplices were taken out, as no move mended their links.
  std::vector<Index> cut_vertices;
  std::vector<Index> outliers;    ///< samples in no simplex
  std::vector<Opening> openings;  ///< weighed by evidence, the least expected first
  Offset agreed = 0;              ///< star simplices that all their vertices have
  Index cavities = 0;
  Index cut = 0;       ///< cavities cut into windows, each a program
  Index programs = 0;  ///< linear ones: of cavities, and of windows
  /// Degrees of curves, and what a linear one left in parts.
  Index integer_programs = 0;
  Index largest_program = 0;  ///< its candidates
  Index unsolved = 0;
};

struct ManifoldComplex {
  SimplexArray simplices;   ///< columns ascending, rows sorted
  OrientedPatches patches;  ///< of the simplices
  ManifoldReport report;
  std::vector<Index> open_region;  ///< as it was found here
  PartReport part;  ///< only where the samples are a part; without the order
};

/// All in canonical numbering. Without a solver only what the search can do is done.
ManifoldComplex build_manifold(const Samples& samples,
                               const Neighborhoods& neighborhoods,
                               const TangentSpaces& tangents, LocalRegions regions,
                               const ManifoldOptions& options,
                               const ProgramSolver& solver,
                               const Execution& execution = {});

/// The price of an open facet that leaves round holes of this radius open: what filling a
/// ball of radius r costs in energy, over the size of its boundary.
double open_price(int dim, double hole_radius);

}  // namespace remanifold
