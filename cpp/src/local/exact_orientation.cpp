// SPDX-License-Identifier: GPL-3.0-or-later
// Exact signs of orientation by CGAL, in a file of their own: its headers take the compiler
// longer than the hulls that ask for them.
#include "local/convex_hull.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Linear_algebraCd.h>
#include <CGAL/Number_types/internal/Exact_type_selector.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace remanifold::detail {
namespace {

/// Up to this many dimensions minors cost less than to divide rational numbers.
constexpr int kMostByMinors = 8;

/// The sum of two doubles that do not overlap: some 106 bits.
struct DoubleDouble {
  double high = 0;
  double low = 0;
};

/// Exact (Knuth).
DoubleDouble sum_of(double a, double b) {
  const double sum = a + b;
  const double part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

/// Relative error below 4 units of 2^-106 (Joldes, Muller and Popescu, 2017: algorithms 6
/// and 12; of products below 6).
DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble high = sum_of(a.high, b.high);
  const DoubleDouble low = sum_of(a.low, b.low);
  const DoubleDouble sum = sum_of(high.high, high.low + low.high);
  return sum_of(sum.high, sum.low + low.low);
}

DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const double product = a.high * b.high;
  const double error = std::fma(a.high, b.high, -product);
  return sum_of(product, error + (a.high * b.low + a.low * b.high));
}

DoubleDouble operator-(const DoubleDouble& a) { return {-a.high, -a.low}; }

/// The terms of all minors of the first rows of a matrix, a set of columns after its
/// subsets: the last minor is the determinant, found without a division.
///
/// \param add  takes a set of columns, the set without one of them, the place of that one
///             in the last of the rows, and whether the term is subtracted
template <class Add>
void for_each_term(int dim, const Add& add) {
  std::vector<int> sizes(std::size_t{1} << dim, 0);
  for (std::size_t columns = 1; columns < sizes.size(); ++columns) {
    sizes[columns] = sizes[columns & (columns - 1)] + 1;
    const int row = sizes[columns] - 1;
    bool negative = row % 2 != 0;
    for (int j = 0; j < dim; ++j) {
      if ((columns >> j & 1U) != 0) {
        add(columns, columns & ~(std::size_t{1} << j), row * dim + j, negative);
        negative = !negative;
      }
    }
  }
}

/// Zero where their bound on the error does not tell.
int sign_by_double_doubles(int dim, const double* const* points) {
  std::vector<DoubleDouble> edges;
  double longest = 0;
  for (int i = 1; i <= dim; ++i) {
    for (int j = 0; j < dim; ++j) {
      edges.push_back(sum_of(points[i][j], -points[0][j]));
      longest = std::max(longest, std::abs(edges.back().high));
    }
  }
  // Far from where a double overflows or loses bits at its lower end.
  if (!(longest < 1e10)) {
    return 0;
  }
  std::vector<DoubleDouble> minors(std::size_t{1} << dim);
  std::vector<double> sizes(minors.size(), 0);
  minors[0].high = 1;
  sizes[0] = 1;
  for_each_term(dim,
                [&](std::size_t columns, std::size_t rest, int place, bool negative) {
                  const DoubleDouble term = edges[place] * minors[rest];
                  minors[columns] = minors[columns] + (negative ? -term : term);
                  sizes[columns] += std::abs(edges[place].high) * sizes[rest];
                });
  // Each of `dim` levels: a product, and as many sums of what is no larger than the size.
  const double bound = std::ldexp(1.01 * dim * (6 + 4 * dim), -106) * sizes.back();
  if (!(sizes.back() > 1e-200) || std::abs(minors.back().high) <= bound) {
    return 0;
  }
  return minors.back().high > 0 ? 1 : -1;
}

int sign_by_minors(int dim, const double* const* points) {
  using Number = CGAL::internal::Exact_ring_selector<double>::Type;
  std::vector<Number> edges;
  for (int i = 1; i <= dim; ++i) {
    for (int j = 0; j < dim; ++j) {
      edges.push_back(Number(points[i][j]) - Number(points[0][j]));
    }
  }
  std::vector<Number> minors(std::size_t{1} << dim, Number(0));
  minors[0] = Number(1);
  for_each_term(
      dim, [&](std::size_t columns, std::size_t rest, int place, bool negative) {
        if (CGAL::sign(edges[place]) != CGAL::ZERO &&
            CGAL::sign(minors[rest]) != CGAL::ZERO) {
          const Number term = edges[place] * minors[rest];
          minors[columns] = negative ? minors[columns] - term : minors[columns] + term;
        }
      });
  return static_cast<int>(CGAL::sign(minors.back()));
}

int sign_by_elimination(int dim, const double* const* points) {
  using Number = CGAL::Exact_rational;
  using Algebra = CGAL::Linear_algebraCd<Number>;
  Algebra::Matrix edges(dim, dim);
  for (int i = 0; i < dim; ++i) {
    for (int j = 0; j < dim; ++j) {
      edges(i, j) = Number(points[i + 1][j]) - Number(points[0][j]);
    }
  }
  return static_cast<int>(Algebra::sign_of_determinant(edges));
}

}  // namespace

int exact_orientation(int dim, const double* const* points) {
  const auto& p = points;
  if (dim == 2) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
    return static_cast<int>(CGAL::orientation(
        Point(p[0][0], p[0][1]), Point(p[1][0], p[1][1]), Point(p[2][0], p[2][1])));
  }
  if (dim == 3) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
    return static_cast<int>(CGAL::orientation(
        Point(p[0][0], p[0][1], p[0][2]), Point(p[1][0], p[1][1], p[1][2]),
        Point(p[2][0], p[2][1], p[2][2]), Point(p[3][0], p[3][1], p[3][2])));
  }
  if (dim > kMostByMinors) {
    return sign_by_elimination(dim, points);
  }
  const int sign = sign_by_double_doubles(dim, points);
  return sign != 0 ? sign : sign_by_minors(dim, points);
}

}  // namespace remanifold::detail
