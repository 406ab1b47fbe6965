// SPDX-License-Identifier: GPL-3.0-or-later
// Every bit of the result depends on every bit of the key: the finalizer of MurmurHash3
// (Appleby, public domain).
#pragma once

#include <cstdint>

namespace remanifold::detail {

constexpr std::uint64_t mix_bits(std::uint64_t key) {
  key ^= key >> 33;
  key *= 0xff51afd7ed558ccdULL;
  key ^= key >> 33;
  key *= 0xc4ceb9fe1a85ec53ULL;
  return key ^ key >> 33;
}

}  // namespace remanifold::detail
