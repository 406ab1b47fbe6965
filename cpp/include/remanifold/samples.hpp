// SPDX-License-Identifier: GPL-3.0-or-later
// The samples in canonical form: coinciding samples merged (those that differ by no more
// than 2^-48 of the largest coordinate, which is rounding), scaled by a power of two to
// unit extent (exact, so that neither 1e-150 nor 1e150 under- or overflows), and, for
// points, sorted along a Morton curve for locality of memory. All steps number samples
// by their position here; input_index() leads back to the caller's numbers.
//
// Samples of a Hilbert space may be known by their inner products or distances only:
// <a-x, b-x> = (|a-x|^2 + |b-x|^2 - |a-b|^2) / 2 is all that the method needs.
#pragma once

#include "remanifold/execution.hpp"
#include "remanifold/global_statistics.hpp"
#include "remanifold/types.hpp"

#include <memory>
#include <vector>

namespace remanifold {

struct Neighborhoods;

class Samples {
 public:
  /// Points of R^D, one a row. Copies them.
  /// \throws std::invalid_argument  empty, or a coordinate that is not finite
  static Samples from_points(MatrixView points, const Execution& execution = {});
  /// The same where the points are a part of more: coordinates, order and coincidence are
  /// those that they have among all.
  /// \param points  in the order of their numbers among all
  /// \throws std::invalid_argument  the same, or a point beyond the extents of all
  static Samples from_part(MatrixView points, GlobalStatistics whole,
                           const Execution& execution = {});
  /// Symmetric positive semidefinite matrix of inner products; not copied, it must
  /// outlive the samples. Definiteness is not tested here, it costs O(N^3).
  static Samples from_gram(MatrixView gram, const Execution& execution = {});
  /// Symmetric matrix of distances with a zero diagonal; not copied.
  static Samples from_distances(MatrixView distances, const Execution& execution = {});

  /// The same samples, the coordinates shared, which look up the distances and products
  /// of those near each other instead of computing them. Points only.
  /// \param neighborhoods  with squared distances; must outlive the result
  Samples knowing(const Neighborhoods& neighborhoods) const;

  /// The same samples but for some, which then have a place among the input only.
  /// \param left_out  numbers of these here
  Samples without(const std::vector<Index>& left_out) const;
  /// The same samples at other points. Those that coincide there are merged.
  /// \param points  size() rows, canonical lengths
  Samples moved_to(MatrixView points, const Execution& execution = {}) const;

  Index size() const { return static_cast<Index>(input_index_.size()); }
  Index input_size() const { return static_cast<Index>(representatives_.size()); }
  /// Of the whole that these are a part of; null where they are all.
  const GlobalStatistics* whole() const { return whole_.get(); }
  /// size(), or that of the whole.
  Offset whole_size() const { return whole_ ? whole_->size : size(); }
  /// True where coordinates are known.
  bool has_points() const { return kind_ == Kind::kPoints; }
  /// D, or 0 where only products are known.
  int ambient_dim() const { return ambient_dim_; }
  /// Coordinates in which points differ, ascending: the others, which are zero, decide
  /// nothing. Empty where only products are known.
  const std::vector<int>& varying_axes() const { return varying_axes_; }
  /// Lowest scaled coordinates of all samples that were given, of the whole where these are
  /// a part: positions from there do not change where all samples are moved without
  /// rounding. Empty where only products are known.
  const std::vector<double>& lowest() const { return lowest_; }
  /// Dimension of the smallest flat from which no sample is farther than a millionth of
  /// the extent: a manifold may lie askew in more coordinates than it needs. Where samples
  /// and coordinates are many, some samples stand for all. Points only.
  int affine_dim() const;
  /// Canonical lengths times scale() are input lengths.
  double scale() const { return scale_; }

  /// The lowest input number of the samples merged into sample i.
  Index input_index(Index i) const { return input_index_[i]; }
  /// For each input sample, the lowest input number of those it coincides with.
  const std::vector<Index>& representatives() const { return representatives_; }
  /// For each input sample, its number here; -1 where it was left out.
  std::vector<Index> canonical_indices() const;

  /// Scaled coordinates, size() x D; null where only products are known.
  const double* point(Index i) const {
    return points_.get() + static_cast<std::size_t>(i) * ambient_dim_;
  }
  double squared_distance(Index a, Index b) const {
    if (!in_space()) {
      return any_squared_distance(a, b);
    }
    const double* pa = point(a);
    const double* pb = point(b);
    const double d[3] = {pa[0] - pb[0], pa[1] - pb[1], pa[2] - pb[2]};
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  }
  /// <a - x, b - x>
  double inner_product(Index x, Index a, Index b) const {
    if (!in_space()) {
      return any_inner_product(x, a, b);
    }
    const double* px = point(x);
    const double* pa = point(a);
    const double* pb = point(b);
    return (pa[0] - px[0]) * (pb[0] - px[0]) + (pa[1] - px[1]) * (pb[1] - px[1]) +
           (pa[2] - px[2]) * (pb[2] - px[2]);
  }

 private:
  enum class Kind { kPoints, kGram, kDistances };
  /// What most samples are and looked at all the time: points with three coordinates.
  bool in_space() const {
    return ambient_dim_ == 3 && kind_ == Kind::kPoints && neighborhoods_ == nullptr;
  }
  double any_squared_distance(Index a, Index b) const;
  double any_inner_product(Index x, Index a, Index b) const;
  static Samples from_points(MatrixView points,
                             std::shared_ptr<const GlobalStatistics> whole,
                             const Execution& execution);
  static Samples from_matrix(MatrixView matrix, Kind kind, const Execution& execution);

  Kind kind_ = Kind::kPoints;
  std::shared_ptr<const GlobalStatistics> whole_;  // or null
  int ambient_dim_ = 0;
  std::vector<int> varying_axes_;
  std::vector<double> lowest_;
  double scale_ = 1.0;
  double inverse_scale_ = 1.0;
  std::shared_ptr<double> points_;
  const Neighborhoods* neighborhoods_ = nullptr;  // known, or null
  MatrixView matrix_;
  std::shared_ptr<std::vector<double>> even_;  // what matrix_ views where it is ours
  std::vector<Index> input_index_;
  std::vector<Index> representatives_;
};

}  // namespace remanifold
