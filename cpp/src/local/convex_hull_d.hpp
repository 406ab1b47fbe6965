// SPDX-License-Identifier: GPL-3.0-or-later
// The hull for K of 3 and more: facets are simplices that know their neighbors, all in flat
// arrays that are used again for the next sample. A point takes the place of the facets
// that it sees: each ridge of their horizon is joined to it, and the new facets find each
// other around the faces of the ridges.
#pragma once

#include "local/convex_hull.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace remanifold::detail {

/// \tparam K  3 or more, or Eigen::Dynamic
template <int K>
class HullPolytope {
 public:
  explicit HullPolytope(int dim)
      : dim_(dim), edges_(dim * dim), sizes_(dim), ids_(dim), corners_(dim + 1) {
    plan_minors();
    restart(1);
    const std::vector<double> origin(dim, 0.0);
    first_is_turned_ = is_visible_exactly(0, origin.data());
  }

  /// Back to the simplex at the start, scaled by `size`.
  void restart(double size) {
    const int k = dim();
    points_.clear();
    vertices_.clear();
    neighbors_.clear();
    planes_.clear();
    hidden_.clear();
    reaches_.clear();
    states_.clear();
    free_.clear();
    // The vertex with the id -1 - i is in slot K - i, so that ids are slots less K + 1.
    for (int which = k; which >= 0; --which) {
      for (int axis = 0; axis < k; ++axis) {
        points_.push_back(size * start_coordinate(k, which, axis));
      }
    }
    for (int opposite = 0; opposite <= k; ++opposite) {
      const int facet = add_facet();
      for (int i = 0; i < k; ++i) {
        vertices_[facet * k + i] = neighbors_[facet * k + i] = i + (i >= opposite);
      }
      // Facet f lies opposite vertex f, and so across the ridge opposite vertex f. Their
      // orientations alternate.
      if ((opposite % 2 != 0) != first_is_turned_) {
        std::swap(vertices_[facet * k], vertices_[facet * k + 1]);
        std::swap(neighbors_[facet * k], neighbors_[facet * k + 1]);
      }
      compute_plane(facet);
    }
  }

  /// Ids count from 0 on, and only points that are taken count.
  /// \returns false where the point is inside or on the hull
  bool insert(const double* coordinates) {
    const int k = dim();
    find_visible(coordinates);
    if (visible_.empty()) {
      return false;
    }
    const auto apex = static_cast<Index>(points_.size() / k);
    points_.insert(points_.end(), coordinates, coordinates + k);
    new_.clear();
    for (const int facet : visible_) {
      for (int i = 0; i < k; ++i) {
        const int across = neighbors_[facet * k + i];
        if (states_[across] == kOuter) {
          join(facet, i, across, apex);
        }
      }
    }
    for (const NewFacet& made : new_) {
      for (int j = 0; j < k; ++j) {
        if (j != made.position) {
          neighbors_[made.facet * k + j] = next_around(made, j);
        }
      }
      states_[made.facet] = kOuter;
    }
    for (const int facet : visible_) {
      states_[facet] = kFree;
      hidden_[facet] = kNoEnd;
      reaches_[facet] = 0;
      free_.push_back(facet);
    }
    return true;
  }

  /// Squared length of the farthest corner of the dual region; infinite where it has no
  /// end. Rounded: to a few digits where facets are flat.
  double squared_radius() const {
    double farthest = 0;
    for (const double reach : reaches_) {
      farthest = reach > farthest ? reach : farthest;
    }
    return farthest;
  }

  /// Those that there is room for: at least as many as there are.
  Offset room_of_facets() const { return static_cast<Offset>(states_.size()); }

  /// \param visit  called with the K ids of each facet
  template <class Visit>
  void for_each_facet(const Visit& visit) {
    const int k = dim();
    for (std::size_t facet = 0; facet < states_.size(); ++facet) {
      if (states_[facet] == kOuter) {
        for (int i = 0; i < k; ++i) {
          ids_[i] = vertices_[facet * k + i] - (k + 1);
        }
        visit(ids_.data());
      }
    }
  }

 private:
  /// Minors are expanded, at a cost of K 2^K a facet, up to this K.
  static constexpr int kMostExpanded = 16;
  static constexpr double kNoEnd = std::numeric_limits<double>::infinity();

  enum State : char { kFree, kMaking, kVisible, kOuter };

  /// Made of the ridge of a visible facet and the apex, which stands in place `position`.
  struct NewFacet {
    int facet;
    int from;
    int position;
  };

  /// Of a facet: where `normal . p - offset` is positive p is outside.
  struct Plane {
    double* normal;
    int dim;

    double& offset() const { return normal[dim]; }
    /// Sum of the absolute values of the terms that the normal was added up from, and the
    /// same of the offset: they bound the rounding of both.
    double& normal_terms() const { return normal[dim + 1]; }
    double& offset_terms() const { return normal[dim + 2]; }
  };
  std::size_t plane_size() const { return static_cast<std::size_t>(dim()) + 3; }
  Plane plane(std::size_t facet) {
    return {planes_.data() + facet * plane_size(), dim()};
  }

  int dim() const { return K == Eigen::Dynamic ? dim_ : K; }
  const double* point(Index slot) const { return points_.data() + slot * dim(); }

  int add_facet() {
    const int k = dim();
    if (!free_.empty()) {
      const int facet = free_.back();
      free_.pop_back();
      return facet;
    }
    vertices_.resize(vertices_.size() + k);
    neighbors_.resize(neighbors_.size() + k);
    planes_.resize(planes_.size() + plane_size());
    hidden_.push_back(0);
    reaches_.push_back(0);
    states_.push_back(kOuter);
    return static_cast<int>(states_.size()) - 1;
  }

  /// A facet on the ridge opposite vertex i and the apex.
  void join(int facet, int i, int across, Index apex) {
    const int k = dim();
    const int made = add_facet();
    states_[made] = kMaking;
    for (int j = 0; j < k; ++j) {
      vertices_[made * k + j] = vertices_[facet * k + j];
    }
    vertices_[made * k + i] = apex;
    neighbors_[made * k + i] = across;
    neighbors_[across * k + place_of(facet, neighbors_.data() + across * k)] = made;
    neighbors_[facet * k + i] = ~made;
    compute_plane(made);
    new_.push_back({made, facet, i});
  }

  int place_of(int what, const int* list) const {
    int i = 0;
    while (list[i] != what) {
      ++i;
    }
    return i;
  }

  /// The new facet across the ridge opposite vertex j of a new one: through the visible
  /// facets, around the face without vertex j and the apex.
  int next_around(const NewFacet& made, int j) const {
    const int k = dim();
    int facet = made.from;
    int leave = j;
    Index behind = vertices_[facet * k + made.position];
    for (;;) {
      const int next = neighbors_[facet * k + leave];
      if (next < 0) {
        return ~next;
      }
      leave = place_of(behind, vertices_.data() + next * k);
      behind = vertices_[next * k + place_of(facet, neighbors_.data() + next * k)];
      facet = next;
    }
  }

  /// Its normal has the minors of the edges of the facet.
  void compute_plane(int facet) {
    const int k = dim();
    const Index* vertices = vertices_.data() + facet * k;
    const Plane plane = this->plane(facet);
    // Differences from a vertex of the start, where there is one: two of these are so near
    // to each other that rounding would swallow how they differ from any other point.
    int first = 0;
    while (first < k && vertices[first] > k) {
      ++first;
    }
    const bool ends = first == k;
    first = ends ? 0 : first;
    const double* base = point(vertices[first]);
    if constexpr (K == 3) {
      // Cyclic, so that the sign stays.
      const double* p = point(vertices[(first + 1) % 3]);
      const double* q = point(vertices[(first + 2) % 3]);
      const double u[] = {p[0] - base[0], p[1] - base[1], p[2] - base[2]};
      const double v[] = {q[0] - base[0], q[1] - base[1], q[2] - base[2]};
      for (int i = 0; i < 3; ++i) {
        const double left = u[(i + 1) % 3] * v[(i + 2) % 3];
        const double right = u[(i + 2) % 3] * v[(i + 1) % 3];
        plane.normal[i] = left - right;
        sizes_[i] = std::abs(left) + std::abs(right);
      }
    } else if (k <= kMostExpanded) {
      compute_minors(vertices, first, plane.normal);
    } else {
      leave_undecided(facet);
      return;
    }
    double offset = 0;
    double square = 0;
    double normal_terms = 0;
    double offset_terms = 0;
    for (int i = 0; i < k; ++i) {
      offset += plane.normal[i] * base[i];
      square += plane.normal[i] * plane.normal[i];
      normal_terms += sizes_[i];
      offset_terms += sizes_[i] * std::abs(base[i]);
    }
    plane.offset() = offset;
    plane.normal_terms() = normal_terms;
    plane.offset_terms() = offset_terms;
    // |normal| |p| < offset, with the error of both, and of this itself, on the safe side.
    const double error = 2 * rounding();
    const double hidden =
        (offset - error * offset_terms) / (std::sqrt(square) + error * normal_terms);
    hidden_[facet] = hidden > 0 ? hidden * hidden * (1 - error) : 0;
    reaches_[facet] = ends ? square / (offset * offset) : kNoEnd;
  }

  /// Every question about this facet goes to the exact predicate.
  void leave_undecided(int facet) {
    const Plane plane = this->plane(facet);
    std::fill_n(plane.normal, plane_size(), 0.0);
    hidden_[facet] = 0;
    reaches_[facet] = kNoEnd;
  }

  /// Of the height of a point over a facet, in units of the terms.
  double rounding() const {
    // A minor is a sum of products of K - 1 differences: rounded K - 1 times for these,
    // K - 2 times as products, at most (K - 1) (K - 2) / 2 times in sums. The products with
    // coordinates and their sum add K + 1, the bound itself is rounded K + 4 times.
    const int k = dim();
    return (4 * k + 2 + (k - 1) * (k - 2) / 2) * 0x1p-53;
  }

  /// A term of a minor in Laplace's expansion by its last row.
  struct Term {
    int set;   // the axes of the minor
    int edge;  // entry of that row
    int rest;  // the axes of the minor without this entry
    bool negative;
  };

  /// The terms of all minors of the first rows, by ascending sets of axes: those of more
  /// rows stand behind those they are made of.
  void plan_minors() {
    const int k = dim();
    if (k > kMostExpanded) {
      return;
    }
    minors_.resize(std::size_t{2} << k);
    const int all = (1 << k) - 1;
    for (int set = 3; set < all; ++set) {
      std::vector<int> axes;
      for (int axis = 0; axis < k; ++axis) {
        if ((set >> axis & 1) != 0) {
          axes.push_back(axis);
        }
      }
      const auto row = static_cast<int>(axes.size()) - 1;
      for (int i = row; row > 0 && i >= 0; --i) {
        plan_.push_back(
            {set, row * k + axes[i], set & ~(1 << axes[i]), (row - i) % 2 != 0});
      }
    }
  }

  void compute_minors(const Index* vertices, int first, double* normal) {
    const int k = dim();
    const int all = (1 << k) - 1;
    const double* base = point(vertices[first]);
    for (int row = 0; row + 1 < k; ++row) {
      const double* p = point(vertices[row < first ? row : row + 1]);
      for (int axis = 0; axis < k; ++axis) {
        edges_[row * k + axis] = p[axis] - base[axis];
      }
    }
    double* minors = minors_.data();
    double* sizes = minors + all + 1;
    std::fill(minors_.begin(), minors_.end(), 0.0);
    for (int axis = 0; axis < k; ++axis) {
      minors[1 << axis] = edges_[axis];
      sizes[1 << axis] = std::abs(edges_[axis]);
    }
    for (const Term& term : plan_) {
      const double product = edges_[term.edge] * minors[term.rest];
      minors[term.set] += term.negative ? -product : product;
      sizes[term.set] += std::abs(edges_[term.edge]) * sizes[term.rest];
    }
    for (int axis = 0; axis < k; ++axis) {
      const int set = all & ~(1 << axis);
      // As if the first vertex had changed places until it was the first.
      normal[axis] = (k - 1 - axis + first) % 2 != 0 ? -minors[set] : minors[set];
      sizes_[axis] = sizes[set];
    }
  }

  /// The facets that the point sees: that have it on their outer side. Exact.
  void find_visible(const double* p) {
    const int k = dim();
    const double error = rounding();
    double largest = 0;
    double squared_norm = 0;
    for (int i = 0; i < k; ++i) {
      largest = std::max(largest, std::abs(p[i]));
      squared_norm += p[i] * p[i];
    }
    visible_.clear();
    const std::size_t num_facets = states_.size();
    for (std::size_t facet = 0; facet < num_facets; ++facet) {
      if (squared_norm < hidden_[facet]) {
        continue;
      }
      const Plane plane = this->plane(facet);
      double height = -plane.offset();
      for (int i = 0; i < k; ++i) {
        height += plane.normal[i] * p[i];
      }
      const double bound =
          error * (plane.normal_terms() * largest + plane.offset_terms());
      if (height > bound || (height >= -bound && is_visible_exactly(facet, p))) {
        states_[facet] = kVisible;
        visible_.push_back(static_cast<int>(facet));
      }
    }
  }

  bool is_visible_exactly(std::size_t facet, const double* p) {
    const int k = dim();
    for (int i = 0; i < k; ++i) {
      corners_[i] = point(vertices_[facet * k + i]);
    }
    corners_[k] = p;
    return exact_orientation(k, corners_.data()) > 0;
  }

  int dim_;
  bool first_is_turned_ = false;  // the facet without the first vertex, from the origin
  std::vector<double> points_;    // K coordinates a slot
  std::vector<Index> vertices_;   // K slots a facet, positive orientation
  std::vector<int> neighbors_;    // K a facet, opposite its vertices; ~ of a new one
  std::vector<double> planes_;    // as Plane
  std::vector<double> hidden_;    // squared norm up to which no point sees a facet
  std::vector<double> reaches_;  // squared length of the corner that is dual to a facet
  std::vector<State> states_;
  std::vector<int> free_;
  std::vector<int> visible_;
  std::vector<NewFacet> new_;
  std::vector<Term> plan_;
  std::vector<double> edges_;   // of a facet, K - 1 rows
  std::vector<double> minors_;  // and their terms, a subset of the axes each
  std::vector<double> sizes_;   // terms of a normal
  std::vector<Index> ids_;      // of for_each_facet
  std::vector<const double*> corners_;
};

}  // namespace remanifold::detail
