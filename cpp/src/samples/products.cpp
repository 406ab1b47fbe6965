// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once for each instruction set. Everything is inlined into functions of this
// file and no header has code: nothing built for one machine is linked into code for
// another.
#include "samples/products.hpp"

#define REMANIFOLD_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__)
#define REMANIFOLD_X86 1
#define REMANIFOLD_AVX2 __attribute__((target("avx2,fma")))
#define REMANIFOLD_AVX512 __attribute__((target("avx512f")))
#endif

namespace remanifold::detail {
namespace {

/// Rows of half a panel or less times kVectors vectors of columns: the sums stay in
/// registers.
template <class T, int kBytes, int kRows, int kVectors>
struct Micro {
  static constexpr int kWidth = kBytes / static_cast<int>(sizeof(T));
  static constexpr int kPanel = static_cast<int>(kPanelRows<T>);
  static constexpr int kPerPanel = kPanel / kWidth;
  typedef T Vector __attribute__((vector_size(kBytes)));
  typedef T Loose __attribute__((vector_size(kBytes), aligned(alignof(T)), may_alias));

  static REMANIFOLD_INLINE void run(const T* a, const T* b, Offset stride, Offset depth,
                                    T* c, Offset columns) {
    Vector sums[kRows][kVectors] = {};
    for (Offset k = 0; k < depth; ++k) {
      Vector right[kVectors];
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) {
        right[v] = *reinterpret_cast<const Loose*>(b + (v / kPerPanel) * stride +
                                                   (v % kPerPanel) * kWidth);
      }
#pragma GCC unroll 16
      for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
        for (int v = 0; v < kVectors; ++v) {
          sums[r][v] += a[r] * right[v];
        }
      }
      a += kPanel;
      b += kPanel;
    }
#pragma GCC unroll 16
    for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) {
        Loose* target = reinterpret_cast<Loose*>(c + r * columns + v * kWidth);
        *target += sums[r][v];
      }
    }
  }
};

/// kColumns panels of b against all of a.
template <class T, int kBytes, int kRows, int kColumns>
REMANIFOLD_INLINE void sweep(const T* a, Offset a_panels, const T* b, Offset stride,
                             Offset depth, T* c, Offset columns) {
  using Kernel = Micro<T, kBytes, kRows, kColumns*(64 / kBytes)>;
  for (Offset i = 0; i < a_panels; ++i) {
    for (int r = 0; r < Kernel::kPanel; r += kRows) {
      Kernel::run(a + i * stride + r, b, stride, depth,
                  c + (i * Kernel::kPanel + r) * columns, columns);
    }
  }
}

template <class T, int kBytes, int kRows, int kColumns>
REMANIFOLD_INLINE void multiply(const T* a, Offset a_panels, const T* b,
                                Offset b_panels, Offset stride, Offset depth, T* c,
                                Offset columns) {
  Offset j = 0;
  for (; j + kColumns <= b_panels; j += kColumns) {
    sweep<T, kBytes, kRows, kColumns>(a, a_panels, b + j * stride, stride, depth,
                                      c + j * kPanelRows<T>, columns);
  }
  for (; j < b_panels; ++j) {
    sweep<T, kBytes, kRows, 1>(a, a_panels, b + j * stride, stride, depth,
                               c + j * kPanelRows<T>, columns);
  }
}

template <class T>
REMANIFOLD_INLINE void bound(const T* products, const double* norms, Offset count,
                             double norm, double product_error, double square_error,
                             double* lower) {
  for (Offset q = 0; q < count; ++q) {
    const double sum = norm + norms[q];
    lower[q] = (0.5 * norms[q] - product_error * norm) * norms[q] -
               static_cast<double>(products[q]) - square_error * sum * sum;
  }
}

template <class T>
using Bound = void (*)(const T*, const double*, Offset, double, double, double,
                       double*);

template <class T>
void bound_plain(const T* products, const double* norms, Offset count, double norm,
                 double product_error, double square_error, double* lower) {
  bound(products, norms, count, norm, product_error, square_error, lower);
}

template <class T>
using Multiply = void (*)(const T*, Offset, const T*, Offset, Offset, Offset, T*,
                          Offset);

template <class T>
void multiply_plain(const T* a, Offset a_panels, const T* b, Offset b_panels,
                    Offset stride, Offset depth, T* c, Offset columns) {
  multiply<T, 16, 2, 1>(a, a_panels, b, b_panels, stride, depth, c, columns);
}

#ifdef REMANIFOLD_X86
template <class T>
REMANIFOLD_AVX2 void multiply_avx2(const T* a, Offset a_panels, const T* b,
                                   Offset b_panels, Offset stride, Offset depth, T* c,
                                   Offset columns) {
  multiply<T, 32, 4, 1>(a, a_panels, b, b_panels, stride, depth, c, columns);
}

template <class T>
REMANIFOLD_AVX512 void multiply_avx512(const T* a, Offset a_panels, const T* b,
                                       Offset b_panels, Offset stride, Offset depth,
                                       T* c, Offset columns) {
  multiply<T, 64, 8, 3>(a, a_panels, b, b_panels, stride, depth, c, columns);
}

template <class T>
REMANIFOLD_AVX2 void bound_avx2(const T* products, const double* norms, Offset count,
                                double norm, double product_error, double square_error,
                                double* lower) {
  bound(products, norms, count, norm, product_error, square_error, lower);
}
#endif

template <class T>
Bound<T> choose_bound() {
#ifdef REMANIFOLD_X86
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return bound_avx2<T>;
  }
#endif
  return bound_plain<T>;
}

template <class T>
Multiply<T> choose() {
#ifdef REMANIFOLD_X86
  if (__builtin_cpu_supports("avx512f")) {
    return multiply_avx512<T>;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return multiply_avx2<T>;
  }
#endif
  return multiply_plain<T>;
}

}  // namespace

void add_products(const float* a, Offset a_panels, const float* b, Offset b_panels,
                  Offset stride, Offset depth, float* c, Offset columns) {
  static const Multiply<float> run = choose<float>();
  run(a, a_panels, b, b_panels, stride, depth, c, columns);
}

void add_products(const double* a, Offset a_panels, const double* b, Offset b_panels,
                  Offset stride, Offset depth, double* c, Offset columns) {
  static const Multiply<double> run = choose<double>();
  run(a, a_panels, b, b_panels, stride, depth, c, columns);
}

void lower_bounds(const float* products, const double* norms, Offset count, double norm,
                  double product_error, double square_error, double* lower) {
  static const Bound<float> run = choose_bound<float>();
  run(products, norms, count, norm, product_error, square_error, lower);
}

void lower_bounds(const double* products, const double* norms, Offset count,
                  double norm, double product_error, double square_error,
                  double* lower) {
  static const Bound<double> run = choose_bound<double>();
  run(products, norms, count, norm, product_error, square_error, lower);
}

}  // namespace remanifold::detail
