// SPDX-License-Identifier: GPL-3.0-or-later
#include "first_steps.hpp"

#include "base/free_memory.hpp"
#include "base/parallel.hpp"
#include "remanifold/constants.hpp"

#include <algorithm>
#include <utility>

namespace remanifold::detail {

FirstSteps take_first_steps(CleanSamples& clean, const TangentOptions& tangent,
                            const Execution& execution) {
  const double threads = num_threads(execution);
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
  give_back_memory(neighborhoods.indices.size() * sizeof(Index));
  Stopwatch watch;
  result.tangents = compute_tangent_spaces(samples, neighborhoods, tangent, execution);
  refit_along_curves(samples, search, neighborhoods, tangent, result.tangents,
                     execution);
  result.seconds.tangent_spaces = watch.lap();
  result.regions =
      compute_local_regions(samples, search, neighborhoods, result.tangents, execution);
  give_back_memory(result.regions.stars.size());
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
