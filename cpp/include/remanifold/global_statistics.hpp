// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that the default method decides on by all samples at once. Samples that are a
// part of more take it from the whole; then what is found of them, away from where the part
// was cut off, is what would be found among all.
#pragma once

#include "remanifold/types.hpp"

#include <vector>

namespace remanifold {

struct GlobalStatistics {
  std::vector<double> low;   ///< of each coordinate of all samples, as given
  std::vector<double> high;  ///< the same
  Offset size = 0;           ///< distinct samples, without outliers
  double evenness = 0;       ///< as from evenness()
  int affine_dim = 0;        ///< as from Samples::affine_dim()
  /// False where the simplices that the stars agree on have no orientation as a whole,
  /// though those of the part may have one.
  bool orientable = true;
  /// Rounds in which openings were found by evidence; below 0: as many as there are here.
  int opening_rounds = -1;
};

/// What a part says besides its result, for who puts the whole together. Numbers of samples
/// are the caller's, ascending.
struct PartReport {
  /// Whether the simplices that the stars agree on have an orientation.
  bool agreed_orientable = true;
  /// Samples at agreed simplices that meet in a sharp fold; only where the whole has no
  /// orientation, since its loops decide on these.
  std::vector<Index> sharp_folds;
  /// Samples whose scale was stretched, as their patch as a whole decides.
  std::vector<Index> stretched;
  /// Of each round, the samples at what was opened by evidence.
  std::vector<std::vector<Index>> opened;
  /// Before the first round and after each, the samples that one more round would look at
  /// though nothing was opened.
  std::vector<std::vector<Index>> unmended;
  std::vector<Index> order;  ///< the samples as they are numbered within
};

}  // namespace remanifold
