// SPDX-License-Identifier: GPL-3.0-or-later
#include "first_steps.hpp"

#include "base/parallel.hpp"
#include "remanifold/constants.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

namespace remanifold::detail {
namespace {

int thread_count(const Execution& execution) {
  return execution.num_threads > 0
             ? execution.num_threads
             : tbb::task_arena(tbb::task_arena::automatic).max_concurrency();
}

}  // namespace

FirstSteps take_first_steps(CleanSamples& clean, const TangentOptions& tangent,
                            const Execution& execution) {
  const double threads = thread_count(execution);
  FirstSteps result;
  clean.run(
      std::max(tangent.num_neighbors, certifying_count(tangent.dim, clean.search())));
  const Samples& samples = clean.samples();
  const NeighborSearch& search = clean.search();
  const Neighborhoods& neighborhoods = clean.neighborhoods();
  result.seconds.neighborhoods = clean.neighborhood_seconds();
  result.seconds.cleaning = clean.cleaning_seconds();
  if (search.method() == SearchMethod::kApproximate) {
    result.recall =
        measure_recall(samples, search, neighborhoods.count, kRecallQueries, execution);
  }
  Stopwatch watch;
  result.tangents = compute_tangent_spaces(samples, neighborhoods, tangent, execution);
  refit_along_curves(samples, search, neighborhoods, tangent, result.tangents,
                     execution);
  result.seconds.tangent_spaces = watch.lap();
  result.regions =
      compute_local_regions(samples, search, neighborhoods, result.tangents, execution);
  result.seconds.local_regions = watch.lap();

  // Thread time over threads stands for wall time.
  StepSeconds& seconds = result.seconds;
  const double in_tangents = result.tangents.coordinate_seconds / threads;
  const double in_regions = result.regions.coordinate_seconds / threads;
  seconds.coordinates = in_tangents + in_regions;
  seconds.neighborhoods += seconds.coordinates;
  seconds.tangent_spaces -= std::min(seconds.tangent_spaces, in_tangents);
  seconds.local_regions -= std::min(seconds.local_regions, in_regions);
  return result;
}

void write_tangents(const Samples& samples, TangentSpaces mapped,
                    std::vector<double>& bases, TangentFrames& frames) {
  bases = std::move(mapped.bases);
  frames = {mapped.num_coefficients, std::move(mapped.coefficients),
            std::move(mapped.neighbors), samples.scale()};
}

}  // namespace remanifold::detail
