// SPDX-License-Identifier: GPL-3.0-or-later
// Every tolerance of the core by name. All are relative; lengths are those of the
// canonical samples, whose extent is 1.
#pragma once

namespace remanifold::detail {

/// Barycentric coordinates count as inside down to minus this: a sample exactly on the
/// face of a simplex is enclosed whichever way its coordinates were rounded.
constexpr double kEnclosureTolerance = 1e-12;

/// Squared sine below which a vector counts as dependent on the others. The Gram matrix
/// resolves squared sines down to about 1e-15.
constexpr double kDependentSquaredSine = 1e-13;

/// Tie-breaking weights in units of the squared nearest-neighbor distance: far above
/// rounding (1e-15), far below any distance that means something. Far above kFlatSimplex
/// too: what lies on a grid up to errors between the two would have flat simplices between
/// its cells, which are left out, and nothing in their place.
constexpr double kTieWeight = 1e-7;

/// A neighbor whose tangent coordinates are shorter than this times its distance lies
/// straight above the sample: its halfspace holds the whole tangent space.
constexpr double kVacuousSquaredSine = 1e-24;

/// A corner is none where its simplex is flat: where the volume spanned by the sample and
/// the K others is below this times the product of the edges of their shortest tree. So
/// are those on the face of a grid, and rounding decides where their bisectors meet.
constexpr double kFlatSimplex = 1e-10;

/// Error of a corner in units of its distance, times the volume spanned by the unit
/// normals that meet in it.
constexpr double kCornerError = 1e-14;

/// A local region is cut off at this distance, in units of the extent of all samples;
/// what reaches so far has no end. Decides ties at infinity, where the bisectors of a
/// straight row of samples are parallel up to rounding.
constexpr double kEndOfRegion = 1e9;

/// The same among many samples. Corners up to here can be certified by the search tree
/// (farther away its squared distances lose the samples in rounding); for those beyond,
/// which only regions without end or next to it have, all samples are gone through.
constexpr double kEndOfRegionAmongMany = 1e4;
constexpr int kManySamples = 1 << 15;

/// Slack of the security radius, for rounding and tie-breaking weights.
constexpr double kSecuritySlack = 1e-6;

/// Entries of a matrix of products or distances and their mirror images differ by at most
/// this times the largest: rounding of single precision, of norms as large as that.
constexpr double kAsymmetry = 1e-6;

/// Beyond this the two are replaced by their mean; below, results do not see it.
constexpr double kSmallAsymmetry = 1e-10;

/// Two samples of a Gram matrix coincide when their squared distance is below this times
/// the sum of their squared norms: it is rounding.
constexpr double kGramCoincidence = 16 * 2.220446049250313e-16;

/// Samples coincide when no coordinate (or, of a distance matrix, their distance) differs
/// by more than this times the largest: the end of a closed curve misses its beginning by
/// as much.
constexpr double kCoincidence = 0x1p-48;

}  // namespace remanifold::detail
