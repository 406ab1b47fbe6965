// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once for each instruction set, with everything inlined into functions of this
// file.
#include "base/rank_few.hpp"

#define REMANIFOLD_INLINE inline __attribute__((always_inline))

namespace remanifold::detail {
namespace {

/// Vectors as wide as the registers: wider ones are taken apart badly.
template <int kBytes>
struct Wide {
  static constexpr Index kKeys = kBytes / static_cast<int>(sizeof(float));
  typedef float Keys __attribute__((vector_size(kBytes)));
  typedef std::int32_t Ranks __attribute__((vector_size(kBytes)));
  typedef float LooseKeys __attribute__((vector_size(kBytes), aligned(4), may_alias));
  typedef std::int32_t LooseRanks
      __attribute__((vector_size(kBytes), aligned(4), may_alias));

  /// Of kBlocks vectors of keys from `first` on: the sums stay in registers.
  template <int kBlocks>
  static REMANIFOLD_INLINE void rank_blocks(const float* keys, Index count, Index first,
                                            std::int32_t* ranks) {
    Keys own[kBlocks];
    Ranks less[kBlocks] = {};
#pragma GCC unroll 8
    for (int b = 0; b < kBlocks; ++b) {
      own[b] = *reinterpret_cast<const LooseKeys*>(keys + first + b * kKeys);
    }
    for (Index j = 0; j < count; ++j) {
      const Keys key = keys[j] - Keys{};
#pragma GCC unroll 8
      for (int b = 0; b < kBlocks; ++b) {
        less[b] -= key < own[b];
      }
    }
#pragma GCC unroll 8
    for (int b = 0; b < kBlocks; ++b) {
      *reinterpret_cast<LooseRanks*>(ranks + first + b * kKeys) = less[b];
    }
  }

  static REMANIFOLD_INLINE void rank_all(const float* keys, Index count,
                                         std::int32_t* ranks) {
    constexpr int kBlocks = 4;
    Index first = 0;
    for (; first + kBlocks * kKeys <= count; first += kBlocks * kKeys) {
      rank_blocks<kBlocks>(keys, count, first, ranks);
    }
    for (; first < count; first += kKeys) {
      rank_blocks<1>(keys, count, first, ranks);
    }
  }
};

void rank_plain(const float* keys, Index count, std::int32_t* ranks) {
  Wide<16>::rank_all(keys, count, ranks);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void rank_avx2(const float* keys, Index count,
                                               std::int32_t* ranks) {
  Wide<32>::rank_all(keys, count, ranks);
}
#endif

using Rank = void (*)(const float*, Index, std::int32_t*);

Rank choose() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return rank_avx2;
  }
#endif
  return rank_plain;
}

}  // namespace

void rank_few(const float* keys, Index count, std::int32_t* ranks) {
  static const Rank rank = choose();
  rank(keys, count, ranks);
}

}  // namespace remanifold::detail
