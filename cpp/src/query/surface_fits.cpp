// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once for each instruction set. Everything is inlined into functions of this
// file, and vectors are never rounded otherwise than single values: no machine has results
// of its own.
#include "query/surface_fits.hpp"

#include <cmath>
#include <limits>
#include <utility>

#define REMANIFOLD_INLINE inline __attribute__((always_inline))

namespace remanifold::detail {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLanes = SurfaceFits::kLanes;
/// 1, u, v, u^2, uv, v^2.
constexpr int kUnknowns = 6;

using Lanes = double __attribute__((vector_size(32)));
// Not by using: Clang would not heed the alignment there.
typedef double Loose __attribute__((vector_size(32), aligned(8), may_alias));

REMANIFOLD_INLINE const Loose& at(const double* values, Index i) {
  return *reinterpret_cast<const Loose*>(values + i * kLanes);
}
REMANIFOLD_INLINE Loose& at(double* values, Index i) {
  return *reinterpret_cast<Loose*>(values + i * kLanes);
}

}  // namespace

/// Its functions take and give vectors by reference: how they are handed over by value
/// depends on the instruction set.
struct SurfaceFitsKernel {
  using Column = const double*;

  static REMANIFOLD_INLINE void root(Lanes& values) {
    for (int lane = 0; lane < kLanes; ++lane) {
      values[lane] = std::sqrt(values[lane]);
    }
  }

  /// sum += a b over rows, of which every fourth is added to one sum of four.
  static REMANIFOLD_INLINE void add_dot(Column a, Column b, Index begin, Index end,
                                        Lanes& sum) {
    Lanes fourths[4] = {};
    Index i = begin;
    for (; i + 4 <= end; i += 4) {
      fourths[0] += at(a, i) * at(b, i);
      fourths[1] += at(a, i + 1) * at(b, i + 1);
      fourths[2] += at(a, i + 2) * at(b, i + 2);
      fourths[3] += at(a, i + 3) * at(b, i + 3);
    }
    Lanes added = (fourths[0] + fourths[1]) + (fourths[2] + fourths[3]);
    for (; i < end; ++i) {
      added += at(a, i) * at(b, i);
    }
    sum += added;
  }

  /// The same of one column alone.
  static REMANIFOLD_INLINE void add_sum(Column a, Index begin, Index end, Lanes& sum) {
    Lanes fourths[4] = {};
    Index i = begin;
    for (; i + 4 <= end; i += 4) {
      fourths[0] += at(a, i);
      fourths[1] += at(a, i + 1);
      fourths[2] += at(a, i + 2);
      fourths[3] += at(a, i + 3);
    }
    Lanes added = (fourths[0] + fourths[1]) + (fourths[2] + fourths[3]);
    for (; i < end; ++i) {
      added += at(a, i);
    }
    sum += added;
  }

  /// L D L^T of a matrix of which the lower triangle is read, rows by descending diagonal,
  /// as SymmetricFactors.
  struct Factors {
    int order[kUnknowns][kLanes];
    Lanes factors[kUnknowns][kUnknowns];

    REMANIFOLD_INLINE void compute(const Lanes (&matrix)[kUnknowns][kUnknowns]) {
      alignas(32) double entries[kUnknowns][kUnknowns][kLanes];
      for (int i = 0; i < kUnknowns; ++i) {
        for (int j = 0; j <= i; ++j) {
          at(entries[i][j], 0) = matrix[i][j];
          at(entries[j][i], 0) = matrix[i][j];
        }
      }
      for (int lane = 0; lane < kLanes; ++lane) {
        sort_diagonal(entries, lane);
      }
      for (int i = 0; i < kUnknowns; ++i) {
        for (int k = 0; k <= i; ++k) {
          for (int lane = 0; lane < kLanes; ++lane) {
            factors[i][k][lane] = entries[order[i][lane]][order[k][lane]][lane];
          }
        }
      }
#pragma GCC unroll 6
      for (int k = 0; k < kUnknowns; ++k) {
        Lanes column[kUnknowns];
#pragma GCC unroll 6
        for (int j = 0; j < k; ++j) {
          column[j] = factors[j][j] * factors[k][j];
        }
#pragma GCC unroll 6
        for (int i = k; i < kUnknowns; ++i) {
          Lanes sum = {};
#pragma GCC unroll 6
          for (int j = 0; j < k; ++j) {
            sum += factors[i][j] * column[j];
          }
          factors[i][k] -= sum;
        }
        const Lanes one = {1, 1, 1, 1};
        const Lanes divisor = factors[k][k] != 0.0 ? factors[k][k] : one;
#pragma GCC unroll 6
        for (int i = k + 1; i < kUnknowns; ++i) {
          factors[i][k] /= divisor;
        }
      }
    }

    REMANIFOLD_INLINE void sort_diagonal(
        const double (&entries)[kUnknowns][kUnknowns][kLanes], int lane) {
      double diagonal[kUnknowns];
      int rows[kUnknowns];
      for (int i = 0; i < kUnknowns; ++i) {
        diagonal[i] = std::abs(entries[i][i][lane]);
        rows[i] = i;
      }
      for (int k = 0; k < kUnknowns; ++k) {
        int largest = k;
        for (int i = k + 1; i < kUnknowns; ++i) {
          largest = diagonal[i] > diagonal[largest] ? i : largest;
        }
        std::swap(diagonal[k], diagonal[largest]);
        std::swap(rows[k], rows[largest]);
      }
      for (int i = 0; i < kUnknowns; ++i) {
        order[i][lane] = rows[i];
      }
    }

    REMANIFOLD_INLINE void solve(Lanes (&right)[kUnknowns]) const {
      alignas(32) double entries[kUnknowns][kLanes];
      Lanes column[kUnknowns];
      for (int i = 0; i < kUnknowns; ++i) {
        at(entries[i], 0) = right[i];
      }
      for (int i = 0; i < kUnknowns; ++i) {
        for (int lane = 0; lane < kLanes; ++lane) {
          column[i][lane] = entries[order[i][lane]][lane];
        }
      }
#pragma GCC unroll 6
      for (int i = 0; i < kUnknowns; ++i) {
#pragma GCC unroll 6
        for (int j = 0; j < i; ++j) {
          column[i] -= factors[i][j] * column[j];
        }
      }
      const Lanes none = {};
      const double least = std::numeric_limits<double>::min();
#pragma GCC unroll 6
      for (int i = kUnknowns - 1; i >= 0; --i) {
        const Lanes size = factors[i][i] < 0.0 ? -factors[i][i] : factors[i][i];
        column[i] = size > least ? column[i] / factors[i][i] : none;
        if (i + 1 < kUnknowns) {
          Lanes sum = {};
#pragma GCC unroll 6
          for (int j = i + 1; j < kUnknowns; ++j) {
            sum += factors[j][i] * column[j];
          }
          column[i] -= sum;
        }
      }
      for (int i = 0; i < kUnknowns; ++i) {
        at(entries[i], 0) = column[i];
      }
      for (int i = 0; i < kUnknowns; ++i) {
        for (int lane = 0; lane < kLanes; ++lane) {
          right[order[i][lane]][lane] = entries[i][lane];
        }
      }
    }
  };

  /// Normal equations of the fits, and what was summed for them.
  struct Equations {
    Lanes gram[kUnknowns][kUnknowns];
    Lanes right[kUnknowns];
    Lanes solution[kUnknowns];

    REMANIFOLD_INLINE void add(const Column (&columns)[kUnknowns], Column normal,
                               Index begin, Index end) {
      gram[0][0] += static_cast<double>(end - begin);
      for (int i = 1; i < kUnknowns; ++i) {
        add_sum(columns[i], begin, end, gram[i][0]);
      }
      // The products of the coordinates are columns themselves.
      gram[1][1] = gram[3][0];
      gram[2][1] = gram[4][0];
      gram[2][2] = gram[5][0];
      for (int i = 3; i < kUnknowns; ++i) {
        for (int j = 1; j <= i; ++j) {
          add_dot(columns[i], columns[j], begin, end, gram[i][j]);
        }
      }
      add_sum(normal, begin, end, right[0]);
      for (int i = 1; i < kUnknowns; ++i) {
        add_dot(columns[i], normal, begin, end, right[i]);
      }
    }

    /// \param larger  the size that the columns are in units of, over that of these rows
    /// \param scatter  the root mean square distance of the first `count` rows
    REMANIFOLD_INLINE void solve(const Column (&columns)[kUnknowns], Column normal,
                                 double* residual, Index count, const Lanes& larger,
                                 Lanes& scatter) {
      const Lanes one = {1, 1, 1, 1};
      const Lanes square = larger * larger;
      const Lanes factors[kUnknowns] = {one, larger, larger, square, square, square};
      Lanes scaled[kUnknowns][kUnknowns];
#pragma GCC unroll 6
      for (int i = 0; i < kUnknowns; ++i) {
#pragma GCC unroll 6
        for (int j = 0; j <= i; ++j) {
          scaled[i][j] = gram[i][j] * factors[j] * factors[i];
        }
        solution[i] = right[i] * factors[i];
      }
      Factors decomposed;
      decomposed.compute(scaled);
      Lanes least = {kInfinity, kInfinity, kInfinity, kInfinity};
      Lanes largest = -least;
#pragma GCC unroll 6
      for (int i = 0; i < kUnknowns; ++i) {
        const Lanes& pivot = decomposed.factors[i][i];
        least = pivot < least ? pivot : least;
        largest = pivot > largest ? pivot : largest;
      }
      decomposed.solve(solution);
#pragma GCC unroll 6
      for (int i = 1; i < kUnknowns; ++i) {
        solution[i] *= factors[i];
      }
      for (Index row = 0; row < count; ++row) {
        Lanes left = at(normal, row) - solution[0];
#pragma GCC unroll 6
        for (int i = 1; i < kUnknowns; ++i) {
          left -= solution[i] * at(columns[i], row);
        }
        at(residual, row) = left;
      }
      Lanes rest = {};
      add_dot(residual, residual, 0, count, rest);
      rest /= static_cast<double>(count - kUnknowns);
      root(rest);
      const Lanes nothing = {kNaN, kNaN, kNaN, kNaN};
      scatter = least > kFlatDesign * largest ? rest : nothing;
    }
  };

  static REMANIFOLD_INLINE void run(SurfaceFits& fits) {
    const Index narrow = fits.narrow_;
    const Index wide = fits.wide_;
    const Offset stride = Offset{wide} * kLanes;
    double* columns[kUnknowns] = {};
    for (int i = 1; i < kUnknowns; ++i) {
      columns[i] = fits.design_.data() + (i - 1) * stride;
    }
    double* const normals = fits.design_.data() + 5 * stride;
    double* const residual = fits.design_.data() + 6 * stride;
    const Lanes nothing = {kNaN, kNaN, kNaN, kNaN};
    Lanes narrow_size;
    Lanes size;
    split(fits, columns[1], columns[2], normals, narrow_size, size);

    Lanes scatter = nothing;
    Lanes wide_scatter = nothing;
    Lanes curvature = nothing;
    if (wide > kUnknowns) {
      const Lanes unit = 1.0 / size;
      for (Index row = 0; row < wide; ++row) {
        const Lanes u = at(columns[1], row) * unit;
        const Lanes v = at(columns[2], row) * unit;
        at(columns[1], row) = u;
        at(columns[2], row) = v;
        at(columns[3], row) = u * u;
        at(columns[4], row) = u * v;
        at(columns[5], row) = v * v;
      }
      const Column known[kUnknowns] = {columns[0], columns[1], columns[2],
                                       columns[3], columns[4], columns[5]};
      Equations equations{};
      equations.add(known, normals, 0, narrow);
      if (narrow > kUnknowns) {
        equations.solve(known, normals, residual, narrow, size / narrow_size, scatter);
        scatter = narrow_size > 0.0 ? scatter : nothing;
      }
      equations.add(known, normals, narrow, wide);
      const Lanes one = {1, 1, 1, 1};
      equations.solve(known, normals, residual, wide, one, wide_scatter);
      curvature = size;
      bend(equations.solution, curvature);
      // Where all neighbors are in one place.
      scatter = size > 0.0 ? scatter : nothing;
      wide_scatter = size > 0.0 ? wide_scatter : nothing;
      curvature = wide_scatter == wide_scatter ? curvature : nothing;
    }
    at(fits.scatter_.data(), 0) = scatter;
    at(fits.wide_scatter_.data(), 0) = wide_scatter;
    at(fits.curvature_.data(), 0) = curvature;
  }

 private:
  /// Coordinates in the frames, along with the reach, which is a matter of these alone.
  static REMANIFOLD_INLINE void split(SurfaceFits& fits, double* first, double* second,
                                      double* normals, Lanes& narrow_size,
                                      Lanes& size) {
    Lanes x[3];
    Lanes a[3];
    Lanes b[3];
    for (int axis = 0; axis < 3; ++axis) {
      x[axis] = at(fits.centers_[axis].data(), 0);
      a[axis] = at(fits.frames_[axis].data(), 0);
      b[axis] = at(fits.frames_[3 + axis].data(), 0);
    }
    const Lanes c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                        a[0] * b[1] - a[1] * b[0]};
    const Lanes scales = at(fits.scales_.data(), 0);
    const Lanes least = kNearest * kNearest * scales * scales;
    // The largest of fractions, divided once.
    Lanes rise = {};
    Lanes square = {1, 1, 1, 1};
    Lanes farthest = {};
    narrow_size = farthest;
    for (Index i = 0; i < fits.wide_; ++i) {
      const double* neighbor = fits.neighbors_.data() + 3 * Offset{i} * kLanes;
      const Lanes v[3] = {at(neighbor, 0) - x[0], at(neighbor, 1) - x[1],
                          at(neighbor, 2) - x[2]};
      const Lanes along = v[0] * a[0] + v[1] * a[1] + v[2] * a[2];
      const Lanes across = v[0] * b[0] + v[1] * b[1] + v[2] * b[2];
      const Lanes normal = v[0] * c[0] + v[1] * c[1] + v[2] * c[2];
      const Lanes length = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      at(first, i) = along;
      at(second, i) = across;
      at(normals, i) = normal;
      const Lanes tangent = along * along + across * across;
      farthest = farthest < tangent ? tangent : farthest;
      if (i < fits.narrow_) {
        narrow_size = farthest;
      }
      const Lanes height = normal * normal;
      const auto steeper =
          (length >= least) & (height * (square * square) > rise * (length * length));
      rise = steeper ? height : rise;
      square = steeper ? length : square;
    }
    root(narrow_size);
    size = farthest;
    root(size);
    root(rise);
    const Lanes inverse = 2.0 * rise / square;
    const Lanes unbounded = {kInfinity, kInfinity, kInfinity, kInfinity};
    // Rounding is not curvature.
    at(fits.reach_.data(), 0) = inverse * scales > kFlat ? 1.0 / inverse : unbounded;
  }

  /// \param curvature  the size of the neighborhood on entry
  static REMANIFOLD_INLINE void bend(const Lanes (&solution)[kUnknowns],
                                     Lanes& curvature) {
    const Lanes& uu = solution[3];
    const Lanes& uv = solution[4];
    const Lanes& vv = solution[5];
    const Lanes first = 4.0 * (uu * uu) + uv * uv;
    const Lanes both = 2.0 * (uv * uu) + 2.0 * (vv * uv);
    const Lanes second = uv * uv + 4.0 * (vv * vv);
    const Lanes mean = (first + second) / 2.0;
    const Lanes half = (first - second) / 2.0;
    for (int lane = 0; lane < kLanes; ++lane) {
      const double largest = mean[lane] + std::hypot(half[lane], both[lane]);
      curvature[lane] =
          std::sqrt(largest > 0 ? largest : 0.0) / (curvature[lane] * curvature[lane]);
    }
  }
};

namespace {

void run_plain(SurfaceFits& fits) { SurfaceFitsKernel::run(fits); }

#if defined(__x86_64__)
__attribute__((target("avx2"))) void run_avx2(SurfaceFits& fits) {
  SurfaceFitsKernel::run(fits);
}
#endif

using Run = void (*)(SurfaceFits&);

Run choose() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return run_avx2;
  }
#endif
  return run_plain;
}

}  // namespace

SurfaceFits::SurfaceFits(Index narrow, Index wide)
    : narrow_(narrow),
      wide_(wide),
      neighbors_(static_cast<std::size_t>(wide) * 3 * kLanes),
      design_(static_cast<std::size_t>(wide) * 7 * kLanes) {}

void SurfaceFits::set_sample(int lane, const double* point, double scale,
                             const double* frame) {
  for (int axis = 0; axis < 3; ++axis) {
    centers_[axis][lane] = point[axis];
    frames_[axis][lane] = frame[axis];
    frames_[3 + axis][lane] = frame[3 + axis];
  }
  scales_[lane] = scale;
}

void SurfaceFits::leave_out(int lane) {
  constexpr double nothing[6] = {};
  set_sample(lane, nothing, 0, nothing);
  for (Index i = 0; i < wide_; ++i) {
    set_neighbor(lane, i, nothing);
  }
}

void SurfaceFits::fit() {
  static const Run run = choose();
  run(*this);
}

}  // namespace remanifold::detail
