// SPDX-License-Identifier: GPL-3.0-or-later
// One local region as the halfspaces that bound it, in tangent coordinates: its corners,
// from the hull that is dual to it, and how far away a sample can still cut it.
#pragma once

#include "base/small_systems.hpp"
#include "base/tolerance.hpp"
#include "complex/simplex_rows.hpp"
#include "local/convex_hull_1.hpp"
#include "local/convex_hull_2.hpp"
#include "local/convex_hull_d.hpp"
#include "remanifold/execution.hpp"
#include "remanifold/types.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
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
  /// Squared distance beyond which no sample cuts. After an insertion by a rounded corner,
  /// after update() by what that finds.
  double limit() const { return limit_; }

  // As of the last update():

  const std::vector<Corner>& corners() const { return corners_; }
  /// The K ids of a corner.
  const Index* facet(std::size_t corner) const {
    return facets_.data() + corner * dim();
  }
  /// Of the farthest corner; infinite where the region has no end.
  double squared_radius() const { return squared_radius_; }

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
    if (!is_start(id)) {
      normal = halfspaces_[id].normal;
      return halfspaces_[id].offset;
    }
    for (int axis = 0; axis < dim(); ++axis) {
      normal[axis] = start_coordinate(dim(), start_vertex(id), axis);
    }
    return end_;
  }

  /// What follows from corners and facets.
  void settle() {
    double radius = 0;
    bool bounded = true;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      if (corners_[c].flat || std::any_of(facet(c), facet(c) + dim(), is_start)) {
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

/// The corner where the halfspaces of a facet meet, by elimination.
template <int K>
class CornerSolver {
  using Vector = typename RegionCorners<K>::Vector;
  using Square = Eigen::Matrix<double, K, K>;

 public:
  explicit CornerSolver(int dim) : normals_(dim, dim), distance_(dim), joined_(dim) {}

  /// To be filled by the caller.
  Square& normals() { return normals_; }

  /// \param corner  whose position holds the offsets
  void solve(typename RegionCorners<K>::Corner& corner) {
    const double tree = shortest_tree();
    double lengths = 1;
    for (Eigen::Index i = 0; i < normals_.rows(); ++i) {
      const double length = normals_.row(i).norm();
      normals_.row(i) /= length;
      corner.position[i] /= length;
      lengths *= length;
    }
    const double volume = std::abs(solve_square(normals_, corner.position));
    corner.error = kCornerError / volume;
    corner.flat = volume * lengths < kFlatSimplex * tree;
    corner.length = corner.position.norm();
  }

 private:
  /// Product of the edges of the shortest tree on the origin and the normals.
  double shortest_tree() {
    constexpr double done = std::numeric_limits<double>::infinity();
    const Eigen::Index size = normals_.rows();
    if (size == 1) {
      return std::abs(normals_(0, 0));
    }
    distance_ = normals_.rowwise().squaredNorm();
    std::fill(joined_.begin(), joined_.end(), false);
    double product = 1;
    for (Eigen::Index joined = 0; joined < size; ++joined) {
      Eigen::Index next = 0;
      product *= distance_.minCoeff(&next);
      joined_[next] = true;
      for (Eigen::Index i = 0; i < size; ++i) {
        distance_[i] =
            joined_[i] ? done
                       : std::min(distance_[i],
                                  (normals_.row(i) - normals_.row(next)).squaredNorm());
      }
    }
    return std::sqrt(product);
  }

  Square normals_;
  Vector distance_;
  std::vector<char> joined_;
};

/// K of 3 and more: the hull that is dual to the region, whose facets are its corners.
template <int K>
class Region : public RegionCorners<K> {
  using Base = RegionCorners<K>;
  using Base::dim;

 public:
  using typename Base::Corner;
  using typename Base::Vector;

  Region(int tangent_dim, double end, const Execution& execution)
      : Base(tangent_dim, end),
        execution_(execution),
        hull_(tangent_dim),
        solver_(tangent_dim) {}

  void restart() {
    Base::clear();
    hull_.restart(1 / this->end_);
  }

  /// At least as many as there are.
  Offset room_of_corners() const { return hull_.room_of_facets(); }

  void insert(const Vector& normal, double offset, Index sample) {
    if (K == Eigen::Dynamic) {
      execution_.poll();  // in high dimensions a hull takes seconds
    }
    const Vector dual = normal / offset;
    if (hull_.insert(dual.data())) {
      this->halfspaces_.push_back({normal, offset, sample});
      this->limit_ = Base::security_radius(hull_.squared_radius());
      ++this->fresh_;
    }
  }

  void update() {
    if (this->fresh_ == 0) {
      return;
    }
    Base::clear_corners();
    bounds_.assign(this->halfspaces_.size(), false);
    hull_.for_each_facet([&](const Index* ids) {
      this->facets_.insert(this->facets_.end(), ids, ids + dim());
      this->corners_.push_back(corner_of(ids));
      for (int i = 0; i < dim(); ++i) {
        if (!is_start(ids[i]) && !bounds_[ids[i]]) {
          bounds_[ids[i]] = true;
          this->vertices_.push_back(ids[i]);
        }
      }
    });
    Base::settle();
  }

 private:
  Corner corner_of(const Index* facet) {
    Corner corner{Vector(dim()), 0, 0, false};
    Vector normal(dim());
    for (int i = 0; i < dim(); ++i) {
      corner.position[i] = Base::line_of(facet[i], normal);
      solver_.normals().row(i) = normal.transpose();
    }
    solver_.solve(corner);
    return corner;
  }

  const Execution& execution_;
  HullPolytope<K> hull_;
  CornerSolver<K> solver_;
  std::vector<char> bounds_;  // halfspaces
};

/// An interval.
template <>
class Region<1> : public RegionCorners<1> {
 public:
  Region(int dim, double end, const Execution& /*execution*/)
      : RegionCorners(dim, end), solver_(dim) {}

  void restart() {
    clear();
    hull_.restart(1 / end_);
  }

  void insert(const Vector& normal, double offset, Index sample) {
    if (hull_.insert(normal[0] / offset, static_cast<Index>(halfspaces_.size()))) {
      halfspaces_.push_back({normal, offset, sample});
      limit_ = is_start(hull_.low().id) || is_start(hull_.high().id)
                   ? kNoEnd
                   : security_radius(1 / std::min(square(hull_.low().position),
                                                  square(hull_.high().position)));
      ++fresh_;
    }
  }

  void update() {
    if (fresh_ == 0) {
      return;
    }
    clear_corners();
    for (const Index id : {hull_.low().id, hull_.high().id}) {
      Corner corner{};
      Vector normal;
      corner.position[0] = line_of(id, normal);
      solver_.normals().row(0) = normal;
      solver_.solve(corner);
      corners_.push_back(corner);
      facets_.push_back(id);
      if (!is_start(id)) {
        vertices_.push_back(id);
      }
    }
    settle();
  }

 private:
  static double square(double x) { return x * x; }

  HullInterval hull_;
  CornerSolver<1> solver_;
};

/// In the plane corners are determinants of two lines.
template <>
class Region<2> : public RegionCorners<2> {
 public:
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
      if (!is_start(id)) {
        vertices_.push_back(id);
      }
    }
    settle();
  }

 private:
  /// Of the corner where two lines of the plane meet; none at the end of the region.
  double squared_length(Index a, Index b) const {
    if (is_start(a) || is_start(b)) {
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
