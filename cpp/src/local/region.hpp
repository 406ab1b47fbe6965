// SPDX-License-Identifier: GPL-3.0-or-later
// One local region as the halfspaces that bound it, in tangent coordinates: its corners,
// from the hull that is dual to it, and how far away a sample can still cut it.
#pragma once

#include "base/small_systems.hpp"
#include "base/tolerance.hpp"
#include "complex/simplex_rows.hpp"
#include "local/convex_hull.hpp"
#include "local/convex_hull_2.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace remanifold::detail {

/// What regions of all dimensions have. Facets of the hull hold K ids each: positions of
/// halfspaces, or of the simplex at which regions without end are cut off.
template <int K>
class RegionCorners {
 public:
  using Vector = Eigen::Matrix<double, K, 1>;

  /// <normal, lambda> <= offset
  struct Halfspace {
    Vector normal;
    double offset;
    Index sample;
  };

  struct Corner {
    Vector position;
    double length;
    double error;  // of the position, in units of the length
    bool flat;     // no corner, but a direction without end
  };

  /// Those that cut when they were inserted.
  const std::vector<Halfspace>& halfspaces() const { return halfspaces_; }
  /// Halfspaces inserted since the last update().
  int fresh() const { return fresh_; }

  // As of the last update():

  const std::vector<Corner>& corners() const { return corners_; }
  /// The K ids of a corner.
  const Index* facet(std::size_t corner) const {
    return facets_.data() + corner * dim();
  }
  /// Of the farthest corner; infinite where the region has no end.
  double squared_radius() const { return squared_radius_; }
  /// Squared distance beyond which no sample cuts.
  double limit() const { return limit_; }

  /// The samples whose halfspaces bound the region, in no order.
  void append_edge_set(std::vector<Index>& out) const {
    for (const Index id : vertices_) {
      out.push_back(halfspaces_[id].sample);
    }
  }

  /// The simplices dual to the corners, as in LocalRegions.
  /// \returns their number
  Offset append_star(std::vector<Index>& out) {
    rows_.clear();
    for (const std::size_t corner : star_) {
      const auto row = rows_.insert(rows_.end(), dim(), 0);
      for (int i = 0; i < dim(); ++i) {
        row[i] = halfspaces_[facet(corner)[i]].sample;
      }
    }
    sort_rows(rows_, dim(), row_starts_);
    for (const Index* row : row_starts_) {
      out.insert(out.end(), row, row + dim());
    }
    return static_cast<Offset>(star_.size());
  }

 protected:
  static constexpr double kNoEnd = std::numeric_limits<double>::infinity();

  /// \param end  where regions without end are cut off
  RegionCorners(int dim, double end) : end_(end), dim_(dim) {}

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }

  static double security_radius(double squared_length) {
    return 4 * (1 + kSecuritySlack) * squared_length;
  }

  void clear() {
    halfspaces_.clear();
    clear_corners();
    squared_radius_ = limit_ = kNoEnd;
    fresh_ = 0;
  }

  void clear_corners() {
    corners_.clear();
    facets_.clear();
    vertices_.clear();
    star_.clear();
  }

  /// The halfspace of an id.
  double line_of(Index id, Vector& normal) const {
    if (!ConvexHull::is_start(id)) {
      normal = halfspaces_[id].normal;
      return halfspaces_[id].offset;
    }
    for (int axis = 0; axis < dim(); ++axis) {
      normal[axis] =
          ConvexHull::start_coordinate(dim(), ConvexHull::start_vertex(id), axis);
    }
    return end_;
  }

  /// What follows from corners and facets.
  void settle() {
    double radius = 0;
    bool bounded = true;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      if (corners_[c].flat ||
          std::any_of(facet(c), facet(c) + dim(), ConvexHull::is_start)) {
        bounded = false;
      } else {
        radius = std::max(radius, corners_[c].length);
        star_.push_back(c);
      }
    }
    squared_radius_ = bounded ? radius * radius : kNoEnd;
    limit_ = security_radius(squared_radius_);
    fresh_ = 0;
  }

  double end_;
  std::vector<Halfspace> halfspaces_;
  std::vector<Corner> corners_;
  std::vector<Index> facets_;
  std::vector<Index> vertices_;    // ids of the halfspaces that bound the region
  std::vector<std::size_t> star_;  // corners that are dual to a simplex
  double squared_radius_ = kNoEnd;
  double limit_ = kNoEnd;
  int fresh_ = 0;

 private:
  int dim_;
  std::vector<Index> rows_;
  std::vector<const Index*> row_starts_;
};

/// By CGAL's hull, which is brought up to date after several halfspaces.
template <int K>
class Region : public RegionCorners<K> {
  using Base = RegionCorners<K>;
  using Square = Eigen::Matrix<double, K, K>;
  using Base::dim;

 public:
  using typename Base::Corner;
  using typename Base::Vector;
  /// Whether limit() is up to date before update().
  static constexpr bool kLimitFollows = false;

  Region(int tangent_dim, double end, const Execution& execution)
      : Base(tangent_dim, end),
        execution_(execution),
        hull_(make_convex_hull(tangent_dim)),
        joined_(tangent_dim, false) {}

  void restart() {
    Base::clear();
    hull_->restart(dim(), 1 / this->end_);
  }

  void insert(const Vector& normal, double offset, Index sample) {
    if (is_redundant(normal, offset)) {
      return;
    }
    execution_.poll();  // in high dimensions a hull takes seconds
    const Vector dual = normal / offset;
    hull_->insert(dual.data(), static_cast<Index>(this->halfspaces_.size()));
    this->halfspaces_.push_back({normal, offset, sample});
    ++this->fresh_;
  }

  void update() {
    if (this->fresh_ == 0) {
      return;
    }
    hull_->update();
    Base::clear_corners();
    this->facets_ = hull_->facets();
    this->vertices_ = hull_->vertices();
    for (std::size_t first = 0; first < this->facets_.size(); first += dim()) {
      execution_.poll();
      this->corners_.push_back(corner_of(this->facets_.data() + first));
    }
    Base::settle();
  }

 private:
  /// Certainly cuts nothing off the region as of the last update.
  bool is_redundant(const Vector& normal, double offset) const {
    const double length = normal.norm();
    for (const Corner& corner : this->corners_) {
      const double slack =
          std::max(kRedundantSlack, corner.error) * (length * corner.length + offset);
      if (!(normal.dot(corner.position) <= offset - slack)) {
        return false;
      }
    }
    return !this->corners_.empty();
  }

  Corner corner_of(const Index* facet) const {
    Square normals(dim(), dim());
    Vector offsets(dim());
    Vector normal(dim());
    double lengths = 1;
    for (int i = 0; i < dim(); ++i) {
      offsets[i] = Base::line_of(facet[i], normal);
      normals.row(i) = normal.transpose();
    }
    const double tree = shortest_tree(normals);
    for (int i = 0; i < dim(); ++i) {
      const double length = normals.row(i).norm();
      normals.row(i) /= length;
      offsets[i] /= length;
      lengths *= length;
    }
    const double volume = std::abs(solve_square(normals, offsets));
    Corner corner{offsets, 0, kCornerError / volume,
                  volume * lengths < kFlatSimplex * tree};
    corner.length = corner.position.norm();
    return corner;
  }

  /// Product of the edges of the shortest tree on the origin and the rows.
  double shortest_tree(const Square& rows) const {
    if (dim() == 1) {
      return std::abs(rows(0, 0));
    }
    Vector distance = rows.rowwise().squaredNorm();
    double product = 1;
    for (int joined = 0; joined < dim(); ++joined) {
      int next = 0;
      const double nearest = distance.minCoeff(&next);
      product *= nearest;
      for (int i = 0; i < dim(); ++i) {
        distance[i] =
            i == next
                ? Base::kNoEnd
                : std::min(distance[i], (rows.row(i) - rows.row(next)).squaredNorm());
      }
      // Those that have joined stay out.
      joined_[next] = true;
      for (int i = 0; i < dim(); ++i) {
        if (joined_[i]) {
          distance[i] = Base::kNoEnd;
        }
      }
    }
    std::fill(joined_.begin(), joined_.end(), false);
    return std::sqrt(product);
  }

  const Execution& execution_;
  std::unique_ptr<ConvexHull> hull_;
  mutable std::vector<bool> joined_;  // scratch of shortest_tree
};

/// The plane has a hull of its own, and the limit follows every halfspace.
template <>
class Region<2> : public RegionCorners<2> {
 public:
  static constexpr bool kLimitFollows = true;

  Region(int dim, double end, const Execution& /*execution*/)
      : RegionCorners(dim, end) {}

  void restart() {
    clear();
    polygon_.restart(1 / end_, kNoEnd);
  }

  void insert(const Vector& normal, double offset, Index sample) {
    halfspaces_.push_back({normal, offset, sample});
    if (!polygon_.insert({normal[0] / offset, normal[1] / offset},
                         static_cast<Index>(halfspaces_.size()) - 1,
                         [&](Index a, Index b) { return squared_length(a, b); })) {
      halfspaces_.pop_back();
      return;
    }
    limit_ = 0;
    for (const HullPolygon::Vertex& vertex : polygon_.vertices()) {
      limit_ = std::max(limit_, security_radius(vertex.value));
    }
    ++fresh_;
  }

  void update() {
    if (fresh_ == 0) {
      return;
    }
    clear_corners();
    const std::vector<HullPolygon::Vertex>& vertices = polygon_.vertices();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Index id = vertices[i].id;
      const Index next = vertices[i + 1 == vertices.size() ? 0 : i + 1].id;
      corners_.push_back(corner_of(id, next));
      facets_.insert(facets_.end(), {id, next});
      if (!ConvexHull::is_start(id)) {
        vertices_.push_back(id);
      }
    }
    settle();
  }

 private:
  /// Of the corner where two lines of the plane meet; none at the end of the region.
  double squared_length(Index a, Index b) const {
    if (ConvexHull::is_start(a) || ConvexHull::is_start(b)) {
      return kNoEnd;
    }
    const Halfspace& p = halfspaces_[a];
    const Halfspace& q = halfspaces_[b];
    const double determinant = p.normal[0] * q.normal[1] - p.normal[1] * q.normal[0];
    return (p.offset * q.normal - q.offset * p.normal).squaredNorm() /
           (determinant * determinant);
  }

  Corner corner_of(Index a, Index b) const {
    Vector p;
    Vector q;
    const double p_offset = line_of(a, p);
    const double q_offset = line_of(b, q);
    const double determinant = p[0] * q[1] - p[1] * q[0];
    const double pp = p.squaredNorm();
    const double qq = q.squaredNorm();
    const double pq = (p - q).squaredNorm();
    const double tree = std::min({pp * qq, pp * pq, qq * pq});
    Corner corner;
    corner.position =
        Vector(p_offset * q[1] - q_offset * p[1], p[0] * q_offset - q[0] * p_offset) /
        determinant;
    corner.length = corner.position.norm();
    corner.error = kCornerError * std::sqrt(pp * qq) / std::abs(determinant);
    corner.flat = determinant * determinant < kFlatSimplex * kFlatSimplex * tree;
    return corner;
  }

  HullPolygon polygon_;
};

}  // namespace remanifold::detail
