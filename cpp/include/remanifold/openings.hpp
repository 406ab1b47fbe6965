// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of a place where a complex bridges what may be an opening of the manifold,
// and of how many samples would be missing there if the manifold went through.
#pragma once

#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

/// What a place is that was decided on.
enum class OpeningKind {
  kGap,    ///< K = 1: samples are missing along a curve
  kHole,   ///< K > 1: samples are missing in the middle, or along a strip
  kJoint,  ///< two ends or rims that do not continue each other
  kPart,   ///< few samples far from all others
};

/// A place where the complex may go through an opening, or did until it was opened.
struct Opening {
  OpeningKind kind = OpeningKind::kHole;
  bool open = false;           ///< no simplices bridge it; of a part: it was left out
  bool given = false;          ///< decided by an OpeningDecision
  std::vector<Index> samples;  ///< of its simplices, ascending
  SimplexArray simplices;      ///< that went through it before any were taken out
  double volume = 0;           ///< of its simplices
  double spacing = 0;          ///< K-th root of the volume per sample around
  /// Samples that its volume would hold beyond those that it has.
  double missing = 0;
  /// Of the volumes around, over that among independent samples: below 1 where the samples
  /// lie evenly, above where unevenly.
  double dispersion = 1;
  /// Openings with no less evidence to be expected in the whole data if there were none.
  double expected = 0;

  /// The chance of one or more.
  double significance() const;
};

/// What was decided on a place by hand: one whose samples are more than half of these, and
/// these more than half of its.
struct OpeningDecision {
  std::vector<Index> samples;  ///< ascending
  bool open = false;
};

/// The largest K that there is a test for: for others nothing is found.
constexpr int kMaxOpeningDim = 3;

/// How much each missing sample lowers the logarithm of Opening::expected, up to
/// kMaxOpeningDim.
double opening_decay(int dim);

}  // namespace remanifold
