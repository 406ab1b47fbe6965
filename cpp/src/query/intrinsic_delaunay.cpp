// SPDX-License-Identifier: GPL-3.0-or-later
#include "remanifold/intrinsic_delaunay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace remanifold {
namespace {

constexpr Offset kMostFlips = 100;  // a triangle
constexpr Offset kPollEvery = 4096;
/// Sums of cotangents below zero by this share of their size are rounding.
constexpr double kRounding = 1e-10;
/// One side of a triangle may be longer than the others together by this share.
constexpr double kLongSide = 1e-12;

/// A side of a triangle: number 3 t + i is opposite to corner i of triangle t, and leads
/// from corner i + 1 to corner i + 2.
using Side = Offset;
constexpr Side kNone = -1;

Side next(Side side) { return side % 3 == 2 ? side - 2 : side + 1; }
Side previous(Side side) { return side % 3 == 0 ? side + 2 : side - 1; }

class Flipper {
 public:
  Flipper(const SimplexArray& triangles, const std::vector<double>& lengths,
          bool both_sides)
      : corners_(triangles.vertices), lengths_(lengths) {
    if (both_sides) {
      add_backs();
    }
    glue_.resize(lengths_.size());
    pair_sides(both_sides);
  }

  IntrinsicTriangulation run(const Execution& execution) {
    const Offset count = static_cast<Offset>(corners_.size()) / 3;
    std::vector<Offset> waiting(count);
    std::vector<std::uint8_t> waits(count, 1);
    for (Offset t = 0; t < count; ++t) {
      waiting[t] = count - 1 - t;
    }
    IntrinsicTriangulation result;
    for (Offset step = 0; !waiting.empty(); ++step) {
      if (step % kPollEvery == 0) {
        execution.poll();
      }
      const Offset t = waiting.back();
      waiting.pop_back();
      waits[t] = 0;
      for (Side side = 3 * t; side < 3 * t + 3; ++side) {
        if (!is_bad(side)) {
          continue;
        }
        if (result.num_flips == kMostFlips * count) {
          result.complete = false;
          waiting.clear();
          break;
        }
        const Offset other = glue_[side].twin / 3;
        flip(side);
        ++result.num_flips;
        for (const Offset changed : {other, t}) {
          if (waits[changed] == 0) {
            waits[changed] = 1;
            waiting.push_back(changed);
          }
        }
        break;
      }
    }
    result.triangles.vertices = std::move(corners_);
    result.lengths = std::move(lengths_);
    return result;
  }

 private:
  struct Glue {
    Side twin = kNone;
    bool alike = false;  // both lead the same way
  };

  Index from(Side side) const { return corners_[next(side)]; }
  Index to(Side side) const { return corners_[previous(side)]; }

  bool is_triangle(Offset t) const {
    const double* sides = lengths_.data() + 3 * t;
    const double longest = std::max({sides[0], sides[1], sides[2]});
    const double sum = sides[0] + sides[1] + sides[2];
    return longest > 0 && 2 * longest <= sum * (1 + kLongSide);
  }

  /// Triangle M + t is t seen from behind: corners 1 and 2 change places.
  void add_backs() {
    const std::size_t size = corners_.size();
    for (std::size_t first = 0; first < size; first += 3) {
      for (const std::size_t corner : {first, first + 2, first + 1}) {
        corners_.push_back(Index{corners_[corner]});
        lengths_.push_back(double{lengths_[corner]});
      }
    }
  }

  void pair_sides(bool both_sides) {
    struct Ends {
      Index low;
      Index high;
      Side side;
    };
    std::vector<Ends> ends;
    for (Side side = 0; side < static_cast<Side>(corners_.size()); ++side) {
      ends.push_back(
          {std::min(from(side), to(side)), std::max(from(side), to(side)), side});
    }
    std::sort(ends.begin(), ends.end(), [](const Ends& a, const Ends& b) {
      return a.low != b.low     ? a.low < b.low
             : a.high != b.high ? a.high < b.high
                                : a.side < b.side;
    });
    const auto same = [&](std::size_t i, std::size_t j) {
      return ends[i].low == ends[j].low && ends[i].high == ends[j].high;
    };
    for (std::size_t i = 0, end = 0; i < ends.size(); i = end) {
      for (end = i + 1; end < ends.size() && same(i, end); ++end) {
      }
      if (both_sides) {
        sew(i, end, [&](std::size_t place) { return ends[place].side; });
        continue;
      }
      const Side a = ends[i].side;
      if (end - i != 2 || !is_triangle(a / 3)) {
        continue;
      }
      const Side b = ends[i + 1].side;
      if (is_triangle(b / 3)) {
        const bool alike = from(a) == from(b);
        glue_[a] = {b, alike};
        glue_[b] = {a, alike};
      }
    }
  }

  /// Glues the sides of one edge, from begin to end, in pairs that lead opposite ways: the
  /// one that leads up of each triangle to the one that leads down of the next.
  template <typename SideAt>
  void sew(std::size_t begin, std::size_t end, const SideAt& side_at) {
    std::vector<Side> up;
    std::vector<Side> down;
    for (std::size_t i = begin; i < end; ++i) {
      const Side side = side_at(i);
      (from(side) < to(side) ? up : down).push_back(side);
    }
    // Fronts come before backs: put the sides of each triangle into the same place.
    const Side half = static_cast<Side>(corners_.size()) / 2;
    const auto triangle = [&](Side side) { return side % half / 3; };
    const auto before = [&](Side a, Side b) { return triangle(a) < triangle(b); };
    std::sort(up.begin(), up.end(), before);
    std::sort(down.begin(), down.end(), before);
    for (std::size_t i = 0; i < up.size(); ++i) {
      const Side a = up[i];
      const Side b = down[(i + 1) % down.size()];
      if (is_triangle(a / 3) && is_triangle(b / 3)) {
        glue_[a] = {b, false};
        glue_[b] = {a, false};
      }
    }
  }

  /// Of the angle opposite to a side.
  double cotangent(Side side) const {
    const double a = lengths_[side];
    const double b = lengths_[next(side)];
    const double c = lengths_[previous(side)];
    // Heron's formula, as it loses the least for thin triangles.
    std::array<double, 3> sorted{a, b, c};
    std::sort(sorted.begin(), sorted.end());
    const auto [low, middle, high] = sorted;
    const double product = (high + (middle + low)) * (low - (high - middle)) *
                           (low + (high - middle)) * (high + (middle - low));
    return ((b - a) * (b + a) + c * c) / std::sqrt(std::max(product, 0.0));
  }

  bool is_bad(Side side) const {
    const Side twin = glue_[side].twin;
    // A triangle glued to itself has not that much of angles.
    if (twin == kNone || twin / 3 == side / 3) {
      return false;
    }
    const double first = cotangent(side);
    const double second = cotangent(twin);
    return first + second < -kRounding * (std::abs(first) + std::abs(second));
  }

  /// Turns a triangle over: corners 1 and 2 change places.
  void mirror(Offset t) {
    const std::array<Side, 3> sides{3 * t, 3 * t + 2, 3 * t + 1};  // new numbers
    const std::array<Glue, 3> old{glue_[3 * t], glue_[3 * t + 1], glue_[3 * t + 2]};
    std::swap(corners_[3 * t + 1], corners_[3 * t + 2]);
    std::swap(lengths_[3 * t + 1], lengths_[3 * t + 2]);
    for (int i = 0; i < 3; ++i) {
      Glue glue = old[i];
      if (glue.twin != kNone && glue.twin / 3 == t) {
        glue.twin = sides[glue.twin % 3];
      } else if (glue.twin != kNone) {
        glue.alike = !glue.alike;
        glue_[glue.twin] = {sides[i], glue.alike};
      }
      glue_[sides[i]] = glue;
    }
  }

  /// The other diagonal of the two triangles at a side, a b c and b a d, which become
  /// a d c and d b c.
  void flip(Side ab) {
    if (glue_[ab].alike) {
      mirror(glue_[ab].twin / 3);
    }
    const Side ba = glue_[ab].twin;
    const Offset t = ab / 3;
    const Offset u = ba / 3;
    const Index a = from(ab);
    const Index b = to(ab);
    const Index c = corners_[ab];
    const Index d = corners_[ba];
    const std::array<Side, 4> old{next(ab), previous(ab), next(ba), previous(ba)};
    const std::array<Side, 4> now{3 * u, 3 * t + 1, 3 * t + 2, 3 * u + 2};
    std::array<Glue, 4> glue;
    std::array<double, 4> length;
    for (int i = 0; i < 4; ++i) {
      glue[i] = glue_[old[i]];
      length[i] = lengths_[old[i]];
      const auto place = std::find(old.begin(), old.end(), glue[i].twin);
      if (place != old.end()) {
        glue[i].twin = now[place - old.begin()];
      }
    }
    const auto [bc, ca, ad, db] = length;
    const double diagonal = other_diagonal(lengths_[ab], bc, ca, ad, db);
    for (int i = 0; i < 4; ++i) {
      glue_[now[i]] = glue[i];
      lengths_[now[i]] = length[i];
      if (glue[i].twin != kNone) {
        glue_[glue[i].twin] = {now[i], glue[i].alike};
      }
    }
    glue_[3 * t] = {3 * u + 1, false};
    glue_[3 * u + 1] = {3 * t, false};
    lengths_[3 * t] = lengths_[3 * u + 1] = diagonal;
    const std::array<Index, 3> first{a, d, c};
    const std::array<Index, 3> second{d, b, c};
    std::copy(first.begin(), first.end(), corners_.begin() + 3 * t);
    std::copy(second.begin(), second.end(), corners_.begin() + 3 * u);
  }

  /// From c to d, with a at the origin and b on the first axis.
  static double other_diagonal(double ab, double bc, double ca, double ad, double db) {
    const auto along = [&](double to_a, double to_b) {
      return ((to_a - to_b) * (to_a + to_b) / ab + ab) / 2;
    };
    const auto off = [](double length, double place) {
      return std::sqrt(std::max((length - place) * (length + place), 0.0));
    };
    const double c = along(ca, bc);
    const double d = along(ad, db);
    return std::hypot(c - d, off(ca, c) + off(ad, d));
  }

  std::vector<Index> corners_;
  std::vector<double> lengths_;
  std::vector<Glue> glue_;
};

}  // namespace

IntrinsicTriangulation intrinsic_delaunay(const SimplexArray& triangles,
                                          const std::vector<double>& lengths,
                                          bool both_sides, const Execution& execution) {
  if (triangles.arity != 3) {
    throw std::invalid_argument("simplices of " + std::to_string(triangles.arity) +
                                " vertices, expected triangles");
  }
  if (lengths.size() != triangles.vertices.size()) {
    throw std::invalid_argument(std::to_string(lengths.size()) + " lengths for " +
                                std::to_string(triangles.size()) +
                                " triangles, expected three for each");
  }
  return Flipper(triangles, lengths, both_sides).run(execution);
}

}  // namespace remanifold
