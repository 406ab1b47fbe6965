// SPDX-License-Identifier: GPL-3.0-or-later
// Where a complex bridges what may be an opening of the manifold, and how many samples
// would be missing there if the manifold went through. Simplices whose empty balls are
// larger than nearly all among independent samples are put into connected clusters (as
// supra-threshold clusters are in the statistics of random fields: Friston et al.,
// Assessing the significance of focal activations using their spatial extent, 1994), and
// the excess of volume of a cluster is weighed against that of the simplices around it.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/neighborhoods.hpp"
#include "remanifold/samples.hpp"
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
  std::vector<Index> samples;  ///< of its simplices, ascending
  Offset num_simplices = 0;
  double volume = 0;   ///< of its simplices
  double spacing = 0;  ///< K-th root of the volume per sample around
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

struct OpeningOptions {
  /// Openings no likelier than this to be among the data by chance are opened; 0: none.
  double significance = 0;
  /// Openings of which more than so many are to be expected are not listed.
  double most_expected = 1;
};

/// The largest K that there is a test for: for others nothing is found.
constexpr int kMaxOpeningDim = 3;

struct FoundOpenings {
  std::vector<Opening> openings;  ///< the least expected first
  /// Rows of the simplices to take out, ascending: those of the open ones, and large ones
  /// next to them.
  std::vector<Offset> bridges;
};

/// Cost linear in the number of simplices.
/// \param simplices  columns ascending
/// \param scales     as from local_scales()
FoundOpenings find_openings(const Samples& samples, const Neighborhoods& neighborhoods,
                            const std::vector<double>& scales,
                            const SimplexArray& simplices,
                            const OpeningOptions& options,
                            const Execution& execution = {});

}  // namespace remanifold
