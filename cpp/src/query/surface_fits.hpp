// SPDX-License-Identifier: GPL-3.0-or-later
// What the neighborhoods of a surface in space tell of it, of four samples at once: each
// has a lane, in which every sum is taken in the order in which it is for one sample alone.
#pragma once

#include "remanifold/types.hpp"

#include <array>
#include <vector>

namespace remanifold::detail {

/// Neighbors nearer than this times h tell of noise rather than of the reach.
constexpr double kNearest = 0.75;
/// One over the reach below which it is rounding, in units of h.
constexpr double kFlat = 1e-7;
/// Of the least pivot of a fit over the largest.
constexpr double kFlatDesign = 1e-10;

/// One for each thread.
class SurfaceFits {
 public:
  static constexpr int kLanes = 4;
  using Values = std::array<double, kLanes>;

  /// \param narrow  neighbors of the narrow fit
  /// \param wide    of the wide one, and of the reach
  SurfaceFits(Index narrow, Index wide);

  /// Before fit(): a sample, its scale h and its frame (two orthonormal vectors).
  void set_sample(int lane, const double* point, double scale, const double* frame);
  /// Its neighbors, nearest first.
  void set_neighbor(int lane, Index i, const double* point) {
    double* place = neighbors_.data() + (3 * i * kLanes + lane);
    place[0] = point[0];
    place[kLanes] = point[1];
    place[2 * kLanes] = point[2];
  }
  /// Of a lane without a sample no value counts.
  void leave_out(int lane);

  void fit();

  /// The root mean square distances from a quadric over the tangent plane; NaN where the
  /// neighbors are too few or lie badly.
  double scatter(int lane) const { return scatter_[lane]; }
  double wide_scatter(int lane) const { return wide_scatter_[lane]; }
  /// The largest norm of II(u, .) over unit vectors u, of the wide fit; NaN like that.
  double curvature(int lane) const { return curvature_[lane]; }
  /// Infinite where the neighborhood is flat.
  double reach(int lane) const { return reach_[lane]; }

 private:
  friend struct SurfaceFitsKernel;

  Index narrow_;
  Index wide_;
  std::array<Values, 3> centers_{};
  std::array<Values, 6> frames_{};
  Values scales_{};
  std::vector<double> neighbors_;  // by neighbor, axis and lane
  std::vector<double> design_;     // coordinates and their products, residuals
  Values scatter_{};
  Values wide_scatter_{};
  Values curvature_{};
  Values reach_{};
};

}  // namespace remanifold::detail
