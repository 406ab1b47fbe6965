// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once for each instruction set, with everything inlined into functions of this
// file.
#include "neighbors/near_candidates.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#define REMANIFOLD_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__)
#define REMANIFOLD_AVX2 __attribute__((target("avx2")))
#endif

namespace remanifold::detail {
namespace {

/// Sums of as many candidates as registers hold stay there.
template <int kBytes>
REMANIFOLD_INLINE void sum_squares(const double* p, const double* axes, Index stride,
                                   int dim, Index count, double* sums) {
  typedef double Sums __attribute__((vector_size(kBytes)));
  typedef double Loose __attribute__((vector_size(kBytes), aligned(8), may_alias));
  constexpr Index kWidth = kBytes / static_cast<int>(sizeof(double));
  for (Index i = 0; i < count; i += kWidth) {
    Sums sum = {};
    for (int j = 0; j < dim; ++j) {
      const Sums difference =
          p[j] - *reinterpret_cast<const Loose*>(axes + Offset{j} * stride + i);
      sum += difference * difference;
    }
    *reinterpret_cast<Loose*>(sums + i) = sum;
  }
}

void sum_squares_plain(const double* p, const double* axes, Index stride, int dim,
                       Index count, double* sums) {
  sum_squares<16>(p, axes, stride, dim, count, sums);
}

Index pick_plain(const double* values, Index count, double limit, Index* places) {
  Index found = 0;
  for (Index i = 0; i < count; ++i) {
    places[found] = i;
    found += static_cast<Index>(values[i] <= limit);
  }
  return found;
}

#if defined(__x86_64__)
REMANIFOLD_AVX2 void sum_squares_avx2(const double* p, const double* axes, Index stride,
                                      int dim, Index count, double* sums) {
  sum_squares<32>(p, axes, stride, dim, count, sums);
}

/// For each set of four lanes, these lanes first: bytes of 32-bit numbers.
struct Compress {
  alignas(16) std::int8_t bytes[16][16];
  constexpr Compress() : bytes() {
    for (int mask = 0; mask < 16; ++mask) {
      int to = 0;
      for (int lane = 0; lane < 4; ++lane) {
        if ((mask >> lane & 1) != 0) {
          for (int byte = 0; byte < 4; ++byte) {
            bytes[mask][4 * to + byte] = static_cast<std::int8_t>(4 * lane + byte);
          }
          ++to;
        }
      }
    }
  }
};
constexpr Compress kCompress;

REMANIFOLD_AVX2 Index pick_avx2(const double* values, Index count, double limit,
                                Index* places) {
  const __m256d most = _mm256_set1_pd(limit);
  const __m128i four = _mm_set1_epi32(4);
  __m128i numbers = _mm_setr_epi32(0, 1, 2, 3);
  Index found = 0;
  Index i = 0;
  for (; i + 4 <= count; i += 4) {
    const int mask = _mm256_movemask_pd(
        _mm256_cmp_pd(_mm256_loadu_pd(values + i), most, _CMP_LE_OQ));
    const __m128i order =
        _mm_load_si128(reinterpret_cast<const __m128i*>(kCompress.bytes[mask]));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(places + found),
                     _mm_shuffle_epi8(numbers, order));
    found += __builtin_popcount(static_cast<unsigned>(mask));
    numbers = _mm_add_epi32(numbers, four);
  }
  for (; i < count; ++i) {
    places[found] = i;
    found += static_cast<Index>(values[i] <= limit);
  }
  return found;
}
#endif

struct Functions {
  decltype(&sum_squares_plain) sum = sum_squares_plain;
  decltype(&pick_plain) pick = pick_plain;
};

Functions choose() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return {sum_squares_avx2, pick_avx2};
  }
#endif
  return {};
}

const Functions& functions() {
  static const Functions chosen = choose();
  return chosen;
}

}  // namespace

void squared_distances(const double* p, const double* axes, Index stride, int dim,
                       Index count, double* sums) {
  functions().sum(p, axes, stride, dim, count, sums);
}

Index pick_near(const double* values, Index count, double limit, Index* places) {
  return functions().pick(values, count, limit, places);
}

}  // namespace remanifold::detail
