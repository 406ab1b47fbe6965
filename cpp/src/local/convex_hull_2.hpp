// SPDX-License-Identifier: GPL-3.0-or-later
// The hull in the plane is a polygon, of about six vertices.
#pragma once

#include "local/convex_hull.hpp"
#include "remanifold/types.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace remanifold::detail {

struct PlanePoint {
  double x;
  double y;
};
static_assert(sizeof(PlanePoint) == 2 * sizeof(double));

/// Sign of the orientation of a, b, c: positive where they turn left. Exact.
inline int orientation(PlanePoint a, PlanePoint b, PlanePoint c) {
  // Bound on the rounding error of the determinant: Shewchuk, Adaptive Precision
  // Floating-Point Arithmetic and Fast Robust Geometric Predicates (1997), section 4.3.
  constexpr double error = (3 + 16 * 0x1p-53) * 0x1p-53;
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  const double determinant = left - right;
  const double bound = error * (std::abs(left) + std::abs(right));
  if (determinant > bound) {
    return 1;
  }
  if (-determinant > bound) {
    return -1;
  }
  const double* const points[] = {&a.x, &b.x, &c.x};
  return exact_orientation(2, points);
}

class HullPolygon {
 public:
  struct Vertex {
    PlanePoint point;
    Index id;
    double value;  // what the caller knows of the edge to the next vertex
  };

  /// Back to the triangle at the start, scaled by `size`.
  /// \param value  of all three edges
  void restart(double size, double value) {
    vertices_.clear();
    for (int which = 0; which < 3; ++which) {
      vertices_.push_back(
          {{size * start_coordinate(2, which, 0), size * start_coordinate(2, which, 1)},
           start_id(which),
           value});
    }
  }

  /// \param value_of  called with the two ids of each new edge
  /// \returns false where the point is inside or on the hull
  template <class ValueOf>
  bool insert(PlanePoint point, Index id, const ValueOf& value_of) {
    const std::size_t n = vertices_.size();
    signs_.resize(n);
    std::size_t visible = n;  // an edge that has the point on its outer side
    for (std::size_t i = 0; i < n; ++i) {
      const Vertex& next = vertices_[i + 1 == n ? 0 : i + 1];
      signs_[i] =
          static_cast<std::int8_t>(orientation(vertices_[i].point, next.point, point));
      visible = signs_[i] < 0 ? i : visible;
    }
    if (visible == n) {
      return false;
    }
    // The chain of such edges, and those in line with the point at its ends.
    std::size_t first = visible;
    std::size_t length = 1;
    for (; signs_[(first + n - 1) % n] <= 0 && length + 1 < n; ++length) {
      first = (first + n - 1) % n;
    }
    for (; signs_[(first + length) % n] <= 0 && length + 1 < n; ++length) {
    }
    if (first + length > n) {
      std::rotate(vertices_.begin(), vertices_.begin() + static_cast<Offset>(first),
                  vertices_.end());
      first = 0;
    }
    const auto at = vertices_.begin() + static_cast<Offset>(first) + 1;
    const Vertex vertex{point, id, 0};
    if (length == 1) {
      vertices_.insert(at, vertex);
    } else {
      *at = vertex;
      vertices_.erase(at + 1, at + static_cast<Offset>(length) - 1);
    }
    const std::size_t after = (first + 2) % vertices_.size();
    vertices_[first].value = value_of(vertices_[first].id, id);
    vertices_[first + 1].value = value_of(id, vertices_[after].id);
    return true;
  }

  /// Counterclockwise.
  const std::vector<Vertex>& vertices() const { return vertices_; }

 private:
  std::vector<Vertex> vertices_;
  std::vector<std::int8_t> signs_;
};

}  // namespace remanifold::detail
