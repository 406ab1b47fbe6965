// SPDX-License-Identifier: GPL-3.0-or-later
// The whole pipeline in one call, in the caller's numbering of the samples.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/manifold_complex.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/options.hpp"
#include "remanifold/samples.hpp"
#include "remanifold/types.hpp"

#include <cstdint>
#include <vector>

namespace remanifold {

/// What was done to the samples before, in the caller's numbering and units.
struct Cleaning {
  std::vector<Index> outliers;        ///< left out, ascending
  bool clutter = false;               ///< whether they are, as in Outliers
  std::vector<double> displacements;  ///< N x D; empty where nothing was moved
  Index smoothing_neighbors = 0;
  int smoothing_rounds = 0;
  double noise = 0;             ///< as in Smoothing; NaN where not estimated
  double prediction_error = 0;  ///< likewise
  double remaining_error = 0;   ///< likewise
  bool drowned = false;         ///< likewise
  bool layers = false;          ///< likewise
  double growth = 1;            ///< likewise
  int fitting_dim = 0;          ///< likewise
  /// Distance below which smoothed samples carry no more shape: of those nearer to each
  /// other one is kept. 0 where all are.
  double resolution = 0;
  std::vector<Index> attached;  ///< the others, ascending
};

/// Wall seconds of each step. All that touches the D coordinates counts as neighborhoods:
/// the searches, the products among neighbors, bases written out in R^D. What is left to
/// the other steps does not depend on D.
struct StepSeconds {
  double prepare = 0;
  double cleaning = 0;  ///< outliers and smoothing
  double neighborhoods = 0;
  double coordinates = 0;  ///< the part of neighborhoods besides the first search
  double tangent_spaces = 0;
  double local_regions = 0;
  double complex = 0;
};

/// Tangent spaces in many coordinates: K x m numbers a sample instead of K x D, for
/// tangent_bases(). In the caller's numbering.
struct TangentFrames {
  Index num_coefficients = 0;        ///< m; 0 where bases were written out
  std::vector<double> coefficients;  ///< N x K x m, NaN where there is none
  std::vector<Index> neighbors;      ///< N x m
  double scale = 1;
};

struct Reconstruction {
  int dim = 0;
  /// K-simplices: each simplex once, rows in the order of their sorted vertices. Columns
  /// ascend, but the last two may have changed places: where a patch of simplices has an
  /// orientation, the order of the columns is alike across facets; with K = D, and with
  /// K = D - 1 where the patch is closed, it gives a positive volume.
  SimplexArray simplices;
  ManifoldReport report;
  std::vector<double> tangents;  ///< N x K x D, NaN where there is none; or frames
  TangentFrames frames;
  std::vector<std::uint8_t> boundary;  ///< N: the sample lies on an open facet
  std::vector<Index> representatives;  ///< N
  SearchMethod search = SearchMethod::kAuto;
  double recall = 1.0;
  Cleaning cleaning;
  StepSeconds seconds;
  std::vector<Index> open_region;  ///< as OpenRegion::here, found here
  PartReport part;                 ///< only where the samples are a part of more
};

/// The chain of least energy through what the stars agree on.
/// \param solver  of its linear programs; without one, large cavities get the best filling
///                that a search finds in limited steps
/// \throws std::invalid_argument, Cancelled, and whatever the solver throws
Reconstruction reconstruct(const Samples& samples, const ReconstructOptions& options,
                           const ProgramSolver& solver = {},
                           const Execution& execution = {});

struct PaperReconstruction {
  int dim = 0;
  SimplexArray simplices;  ///< K-simplices, columns ascending, rows sorted
  SimplexArray edges;
  Csr edge_sets;
  Csr stars;  ///< per sample, K + 1 vertices a simplex: the sample, then the others
  std::vector<double> tangents;  ///< N x K x D, NaN where there is none; or frames
  TangentFrames frames;
  std::vector<Index> tangent_simplices;  ///< N x (K+1)
  std::vector<std::uint8_t> boundary;    ///< N: the paper's BD
  std::vector<std::uint8_t> unbounded;   ///< N: LR(x) is unbounded
  std::vector<Index> representatives;    ///< N
  SearchMethod search = SearchMethod::kAuto;
  double recall =
      1.0;  ///< below 1 only for the approximate search; measured on a sample
  Offset neighbors_used = 0;
  Offset vacuous_constraints = 0;
  Cleaning cleaning;
  StepSeconds seconds;
};

/// The paper's SC(X).
/// \throws std::invalid_argument, Cancelled
PaperReconstruction reconstruct_paper(const Samples& samples,
                                      const ReconstructOptions& options,
                                      const Execution& execution = {});

/// Outliers and smoothed positions alone, as far as the options ask for them.
/// \throws std::invalid_argument, Cancelled
Cleaning clean(const Samples& samples, const ReconstructOptions& options,
               const Execution& execution = {});

/// How the graph's cliques differ from the stars, and what is open.
struct PaperReport {
  SimplexArray callous_faces;        ///< (K-1)-faces with more than two cofaces
  SimplexArray unstarred_simplices;  ///< cliques that are in no star
  SimplexArray open_faces;           ///< (K-1)-faces with one coface
  SimplexArray hole_faces;           ///< those of them that are no boundary
  Index num_holes = 0;
  Index num_boundary_components = 0;
};
/// Edge sets, stars and boundary as in Reconstruction. Open faces count as boundary where
/// one of their vertices is a boundary sample or has one in its edge set: boundary samples
/// have no edge sets, so that mutual edges never reach them.
PaperReport paper_report(const SimplexArray& simplices, const Csr& edge_sets,
                         const Csr& stars, const std::vector<std::uint8_t>& boundary,
                         const Execution& execution = {});

}  // namespace remanifold
