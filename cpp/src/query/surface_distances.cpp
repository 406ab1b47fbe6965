// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/surface_distances.hpp"

#include "base/csr.hpp"
#include "remanifold/facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace remanifold {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTurn = 6.283185307179586;
/// Share of a length that counts as rounding. Windows that are narrower are none, and
/// paths must be shorter by more to be preferred.
constexpr double kRounding = 1e-12;
/// Height of a triangle over its longest side up to which it counts as flat.
constexpr double kFlat = 1e-9;
/// Angles around a vertex by how much less than a full turn it may still be passed: it does
/// no harm to start at a vertex that no shortest path passes.
constexpr double kAngleRounding = 1e-9;
/// Share of a side beyond a window up to which a vertex is still seen through it: of two
/// windows that meet there one has to.
constexpr double kSeen = 1e-10;
constexpr int kPollEvery = 4096;

struct Vector2 {
  double x;
  double y;
};
Vector2 operator-(Vector2 a, Vector2 b) { return {a.x - b.x, a.y - b.y}; }
double cross(Vector2 a, Vector2 b) { return a.x * b.y - a.y * b.x; }
double length(Vector2 a) { return std::sqrt(a.x * a.x + a.y * a.y); }

/// What comes into a triangle through one of its sides. In the frame of that side, which
/// begins at its first vertex, the triangle lies above and the image of the vertex that
/// the lines come from below.
struct Window {
  Offset side;   // 3 triangle + number of the vertex opposite
  double begin;  // on the side
  double end;
  Vector2 image;
  double before;  // distance of the vertex that the lines come from
};

class Surface {
 public:
  Surface(const SimplexArray& triangles, const std::vector<double>& lengths,
          Index num_vertices)
      : triangles_(triangles),
        lengths_(lengths),
        across_(across(triangles, num_vertices)),
        corners_(detail::ragged_of<Offset>(
            num_vertices,
            [&](const auto& add) {
              for (Offset side = 0; side < static_cast<Offset>(lengths.size());
                   ++side) {
                add(triangles.vertices[side], side);
              }
            })),
        passed_(num_vertices, 0) {
    apexes_.resize(lengths.size());
    std::vector<double> angles(num_vertices, 0.0);
    for (Offset side = 0; side < static_cast<Offset>(lengths.size()); ++side) {
      const double base = lengths_[side];
      const double left = lengths_[next(next(side))];  // first vertex to apex
      const double right = lengths_[next(side)];
      const double x =
          base > 0 ? (base * base + left * left - right * right) / (2 * base) : 0;
      apexes_[side] = {x, std::sqrt(std::max(left * left - x * x, 0.0))};
      const double both = 2 * left * right;
      const double cosine =
          both > 0 ? (left * left + right * right - base * base) / both : 1;
      angles[triangles_.vertices[side]] += std::acos(std::clamp(cosine, -1.0, 1.0));
      // Around a flat triangle, where angles say little, any vertex may be passed.
      if (!(apexes_[side].y > kFlat * std::max(base, std::max(left, right)))) {
        passed_[apex_of(side)] = passed_[first(side)] = passed_[last(side)] = 1;
      }
      if (across_[side] < 0) {
        passed_[first(side)] = passed_[last(side)] = 1;
      }
    }
    for (Index v = 0; v < num_vertices; ++v) {
      if (angles[v] > kTurn - kAngleRounding) {
        passed_[v] = 1;
      }
    }
  }

  static Offset next(Offset side) { return side % 3 == 2 ? side - 2 : side + 1; }
  Index apex_of(Offset side) const { return triangles_.vertices[side]; }
  Index first(Offset side) const { return triangles_.vertices[next(side)]; }
  Index last(Offset side) const { return triangles_.vertices[next(next(side))]; }
  double base(Offset side) const { return lengths_[side]; }
  /// Where the third vertex is in the frame of a side.
  Vector2 apex(Offset side) const { return apexes_[side]; }
  /// The same side in the other triangle, or -1.
  Offset across(Offset side) const { return across_[side]; }
  /// Sides opposite to a vertex.
  const Offset* corners_begin(Index v) const { return corners_.begin(v); }
  const Offset* corners_end(Index v) const { return corners_.end(v); }
  /// Whether shortest paths may pass it: more than a full turn around, or the boundary.
  bool passed(Index v) const { return passed_[v] != 0; }

 private:
  static std::vector<FacetNumber> across(const SimplexArray& triangles,
                                         Index num_vertices) {
    // Facets are numbered by sorted triangles: sides are where their opposite vertex is.
    SimplexArray sorted = triangles;
    std::vector<Offset> side_of(triangles.vertices.size());
    std::vector<Offset> place_of(triangles.vertices.size());
    for (Offset t = 0; t < triangles.size(); ++t) {
      std::array<int, 3> order{0, 1, 2};
      std::sort(order.begin(), order.end(),
                [&](int a, int b) { return triangles[t][a] < triangles[t][b]; });
      for (int i = 0; i < 3; ++i) {
        sorted.vertices[3 * t + i] = triangles[t][order[i]];
        side_of[3 * t + i] = 3 * t + order[i];
        place_of[3 * t + order[i]] = 3 * t + i;
      }
    }
    const std::vector<FacetNumber> neighbors = facet_neighbors(sorted, num_vertices);
    std::vector<Offset> result(neighbors.size());
    for (std::size_t side = 0; side < result.size(); ++side) {
      const FacetNumber other = neighbors[place_of[side]];
      result[side] = other < 0 ? -1 : side_of[other];
    }
    return result;
  }

  const SimplexArray& triangles_;
  const std::vector<double>& lengths_;
  std::vector<Offset> across_;
  detail::Ragged<Offset> corners_;
  std::vector<char> passed_;
  std::vector<Vector2> apexes_;
};

class Propagation {
 public:
  Propagation(const Surface& surface, Index num_vertices, Offset num_sides,
              double* distances)
      : surface_(surface),
        distances_(distances),
        shortest_(num_sides, kInfinity),
        entries_(num_sides, 0.0) {
    std::fill(distances, distances + num_vertices, kInfinity);
  }

  void run(Index source, const Execution& execution) {
    distances_[source] = 0;
    start_at(source);
    for (int pops = 1; !queue_.empty(); ++pops) {
      if (pops % kPollEvery == 0) {
        execution.poll();
      }
      const Event event = queue_.top();
      queue_.pop();
      if (event.window < 0) {
        if (event.distance == distances_[event.vertex]) {
          start_at(event.vertex);
        }
        continue;
      }
      const Window window = windows_[event.window];
      free_.push_back(event.window);
      if (!useless(window)) {
        carry(window);
      }
    }
  }

 private:
  struct Event {
    double distance;
    Index vertex;
    Offset window;  // -1: the vertex begins
    bool operator<(const Event& other) const {
      return distance != other.distance ? distance > other.distance
                                        : window > other.window;
    }
  };

  /// Lines from a vertex to the sides opposite, and along the edges.
  void start_at(Index v) {
    const double before = distances_[v];
    for (const Offset* side = surface_.corners_begin(v);
         side != surface_.corners_end(v); ++side) {
      const Vector2 apex = surface_.apex(*side);
      const double base = surface_.base(*side);
      reach(surface_.first(*side), before + length(apex));
      reach(surface_.last(*side), before + length(apex - Vector2{base, 0}));
      cross_side(*side, {apex.x, -apex.y}, 0, base, before);
    }
  }

  void reach(Index v, double distance) {
    if (distance < distances_[v]) {
      distances_[v] = distance;
      if (surface_.passed(v)) {
        queue_.push({distance, v, -1});
      }
    }
  }

  /// From a triangle through one of its sides, in its frame: into the other triangle.
  void cross_side(Offset side, Vector2 image, double begin, double end, double before) {
    const Offset other = surface_.across(side);
    const double base = surface_.base(side);
    if (other < 0 || !(end - begin > kRounding * base)) {
      return;
    }
    if (surface_.first(other) != surface_.first(side)) {
      image.x = base - image.x;
      const double turned = base - end;
      end = base - begin;
      begin = turned;
    }
    const Window window{other, begin, end, image, before};
    if (useless(window)) {
      return;
    }
    const double nearest = length(image - Vector2{std::clamp(image.x, begin, end), 0});
    Offset place;
    if (free_.empty()) {
      place = static_cast<Offset>(windows_.size());
      windows_.push_back(window);
    } else {
      place = free_.back();
      free_.pop_back();
      windows_[place] = window;
    }
    queue_.push({before + nearest, -1, place});
  }

  /// Whether the way through an end of the side is shorter for all of the window: it is if
  /// it is for the end of the window farthest from there.
  bool useless(const Window& window) const {
    const double base = surface_.base(window.side);
    const double to_begin =
        window.before + length(window.image - Vector2{window.begin, 0});
    const double to_end = window.before + length(window.image - Vector2{window.end, 0});
    return distances_[surface_.first(window.side)] + window.end <
               to_end * (1 - kRounding) ||
           distances_[surface_.last(window.side)] + base - window.begin <
               to_begin * (1 - kRounding);
  }

  /// Through a triangle, to one of the other sides or to both.
  void carry(const Window& window) {
    const Offset side = window.side;
    const Vector2 apex = surface_.apex(side);
    const Vector2 image = window.image;
    const double rise = apex.y - image.y;
    if (!(rise > 0)) {
      return;  // the triangle is flat, and its sides were reached along their edges
    }
    const double entry = image.x - (apex.x - image.x) * image.y / rise;
    // A window that ends where the apex is seen lies on one side of it, whatever rounding
    // says: paths through other vertices come as near there.
    const double beyond = kSeen * surface_.base(side);
    bool left = window.begin < entry - beyond;
    bool right = window.end > entry + beyond;
    if (window.begin - beyond <= entry && entry <= window.end + beyond) {
      const double distance = window.before + length(apex - image);
      reach(surface_.apex_of(side), distance);
      if (left && right) {
        if (distance < shortest_[side]) {
          shortest_[side] = distance;
          entries_[side] = entry;
        } else {
          left = entry < entries_[side];
          right = entry > entries_[side];
        }
      }
    }
    const double base = surface_.base(side);
    if (left) {
      // On the side from the first vertex to the apex.
      const Offset own = Surface::next(Surface::next(side));
      const double stop = window.end < entry ? met(image, window.end, {0, 0}, apex) : 1;
      go_on(own, {0, 0}, apex, image,
            window.begin > 0 ? met(image, window.begin, {0, 0}, apex) : 0, stop,
            surface_.first(side), window.before);
    }
    if (right) {
      const Offset own = Surface::next(side);
      const Vector2 start{base, 0};
      const double stop =
          window.begin > entry ? met(image, window.begin, start, apex) : 1;
      go_on(own, start, apex, image,
            window.end < base ? met(image, window.end, start, apex) : 0, stop,
            surface_.last(side), window.before);
    }
  }

  /// How far along a segment the line from the image through a point of the side meets it.
  static double met(Vector2 image, double through, Vector2 start, Vector2 stop) {
    const Vector2 line = Vector2{through, 0} - image;
    const double both = cross(stop - start, line);
    return both != 0 ? std::clamp(cross(image - start, line) / both, 0.0, 1.0) : 0;
  }

  /// From the frame of the side that the window came in by to that of another one.
  void go_on(Offset side, Vector2 start, Vector2 stop, Vector2 image, double from,
             double to, Index start_vertex, double before) {
    const double base = surface_.base(side);
    const Vector2 along = stop - start;
    const double size = length(along);
    if (!(size > 0)) {
      return;
    }
    const Vector2 way = image - start;
    Vector2 seen{(along.x * way.x + along.y * way.y) / size,
                 -std::abs(cross(along, way)) / size};
    double begin = std::min(from, to) * base;
    double end = std::max(from, to) * base;
    if (surface_.first(side) != start_vertex) {
      seen.x = base - seen.x;
      const double turned = base - end;
      end = base - begin;
      begin = turned;
    }
    cross_side(side, seen, begin, end, before);
  }

  const Surface& surface_;
  double* distances_;
  std::vector<double> shortest_;  // to the apex of each side, through the side
  std::vector<double> entries_;   // where that way comes in
  std::vector<Window> windows_;
  std::vector<Offset> free_;
  std::priority_queue<Event> queue_;
};

}  // namespace

std::vector<double> surface_distances(const SimplexArray& triangles,
                                      const std::vector<double>& lengths,
                                      Index num_vertices,
                                      const std::vector<Index>& sources,
                                      const Execution& execution) {
  const Surface surface(triangles, lengths, num_vertices);
  std::vector<double> result(sources.size() * num_vertices);
  for (std::size_t row = 0; row < sources.size(); ++row) {
    Propagation(surface, num_vertices, static_cast<Offset>(lengths.size()),
                result.data() + row * num_vertices)
        .run(sources[row], execution);
  }
  return result;
}

}  // namespace remanifold
