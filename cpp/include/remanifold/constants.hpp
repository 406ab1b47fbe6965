// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of the method that more than one place has to know, each once: the steps, the
// bindings, the help of the command line and the pages take them from here.
#pragma once

#include "remanifold/types.hpp"

namespace remanifold {

/// Neighbors for a jet: three times the unknowns of the quadratic fit.
constexpr Index jet_neighbors(int dim) { return 3 * (dim + dim * (dim + 1) / 2); }
constexpr const char* kJetNeighborsFormula = "3 K (K + 3) / 2";

/// Neighbors for the paper's enclosing simplices: its r K with r = 10.
constexpr Index paper_neighbors(int dim) { return 10 * dim; }
constexpr const char* kPaperNeighborsFormula = "10 K";

/// Neighbors that the local scale h spans: the unit of hole_radius and of the spacing. On
/// curves more than elsewhere: a few say little about the density there.
constexpr Index scale_neighbors(int dim) { return dim == 1 ? 10 : 2 * dim + 2; }
constexpr const char* kScaleWords =
    "the distance to the (2K+2)-th neighbor, on curves to the tenth";

/// Neighbors that the unit of outlier distances spans: an outlier may be one of few in its
/// neighborhood, on curves too.
constexpr Index outlier_scale_neighbors(int dim) { return 2 * dim + 2; }
/// Distance from which on a sample is an outlier, in these units.
constexpr double kOutlierDistance = 2;

/// Radius of the smallest round hole that stays open, in h: among samples that lie at
/// random (of which gaps reach 2 h), and among even ones; on curves, where h spans more
/// neighbors, this share of it.
constexpr double kRandomHoleRadius = 3;
constexpr double kEvenHoleRadius = 1.4;
constexpr double hole_radius_share(int dim) { return dim == 1 ? 0.6 : 1; }

/// The chance of one false opening in the whole data that is taken.
constexpr double kSignificance = 1e-3;

/// Leaves that the approximate search visits.
constexpr int kChecks = 256;
/// Samples at which its recall is measured.
constexpr Index kRecallQueries = 200;

}  // namespace remanifold
