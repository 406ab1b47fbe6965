// SPDX-License-Identifier: GPL-3.0-or-later
// What both methods begin with: clean samples, their neighborhoods, tangent spaces and
// local regions, with the seconds that each took.
#pragma once

#include "cleaning/clean_samples.hpp"
#include "remanifold/local_region.hpp"
#include "remanifold/reconstruct.hpp"
#include "remanifold/tangent_space.hpp"

#include <vector>

namespace remanifold::detail {

struct FirstSteps {
  TangentSpaces tangents;
  LocalRegions regions;
  double recall = 1;
  StepSeconds seconds;
};

FirstSteps take_first_steps(CleanSamples& clean, const TangentOptions& tangent,
                            const Execution& execution);

/// Tangent spaces in the form they were found in.
void write_tangents(const Samples& samples, TangentSpaces mapped,
                    std::vector<double>& bases, TangentFrames& frames);

}  // namespace remanifold::detail
