// SPDX-License-Identifier: GPL-3.0-or-later
// Products of many rows with many rows, in the widest vectors that the machine has. Sums
// are rounded in whatever order is fastest, so that the last bits differ from machine to
// machine: good for bounds (see kProductDepth), not for results.
#pragma once

#include "remanifold/types.hpp"

namespace remanifold::detail {

/// Rows are stored in panels of so many, coordinate by coordinate: one cache line each.
template <class T>
constexpr Offset kPanelRows = 64 / static_cast<Offset>(sizeof(T));

/// Coordinates that are summed up before the sum is added to c: the error of a sum over
/// D coordinates is below (kProductDepth + D / kProductDepth + 4) roundings of the product
/// of the norms.
constexpr Offset kProductDepth = 256;

/// c[i, j] += <a_i, b_j> over `depth` <= kProductDepth coordinates.
/// \param a, b  first panel at the first coordinate, 64-byte aligned
/// \param stride  elements from panel to panel
/// \param c  row-major with rows of length `columns`
void add_products(const float* a, Offset a_panels, const float* b, Offset b_panels,
                  Offset stride, Offset depth, float* c, Offset columns);
void add_products(const double* a, Offset a_panels, const double* b, Offset b_panels,
                  Offset stride, Offset depth, double* c, Offset columns);

/// lower[q] = half the squared distance of two vectors, short of the part of the first,
/// from their product and norms, less the given error of the product relative to both
/// norms and of the square relative to their sum.
void lower_bounds(const float* products, const double* norms, Offset count, double norm,
                  double product_error, double square_error, double* lower);
void lower_bounds(const double* products, const double* norms, Offset count,
                  double norm, double product_error, double square_error,
                  double* lower);

}  // namespace remanifold::detail
