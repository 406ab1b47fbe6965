// SPDX-License-Identifier: GPL-3.0-or-later
// The samples that a reconstruction is of: outliers left out, the others smoothed, as far
// as asked for.
#pragma once

#include "remanifold/neighborhoods.hpp"
#include "remanifold/options.hpp"
#include "remanifold/reconstruct.hpp"
#include "remanifold/samples.hpp"

#include <optional>
#include <utility>
#include <vector>

namespace remanifold::detail {

/// The samples must outlive it.
class CleanSamples {
 public:
  CleanSamples(const Samples& given, const ReconstructOptions& options,
               double outlier_distance, const Execution& execution);
  CleanSamples(const CleanSamples&) = delete;
  CleanSamples& operator=(const CleanSamples&) = delete;

  /// Smoothed samples are thinned to the resolution that the noise allows.
  void set_thinning() { thins_ = true; }
  /// \param count  of neighborhoods, 0 where the caller has no use for them
  void run(Index count);

  const Samples& samples() const { return changed_ ? *changed_ : given_; }
  const NeighborSearch& search() const { return *search_; }
  const Neighborhoods& neighborhoods() const { return neighborhoods_; }
  /// Hands over the neighborhoods and ends the search, which holds a copy of the samples.
  Neighborhoods take_neighborhoods() {
    search_.reset();
    return std::move(neighborhoods_);
  }
  Cleaning take_report() { return std::move(report_); }
  double neighborhood_seconds() const { return neighborhood_seconds_; }
  double cleaning_seconds() const { return cleaning_seconds_; }

 private:
  void find(Index count);
  /// The same where all that changed is that outliers are gone.
  void keep(const std::vector<Index>& outliers, Index count);
  void change(Samples samples);
  void move(const std::vector<double>& points);
  void thin(double distance);
  std::vector<Index> to_input(const std::vector<Index>& samples) const;

  const Samples& given_;
  const ReconstructOptions& options_;
  double outlier_distance_;
  bool thins_ = false;
  const Execution& execution_;
  std::optional<Samples> changed_;
  std::optional<NeighborSearch> search_;
  Neighborhoods neighborhoods_;
  Cleaning report_;
  double neighborhood_seconds_ = 0;
  double cleaning_seconds_ = 0;
};

}  // namespace remanifold::detail
