// SPDX-License-Identifier: GPL-3.0-or-later
// Asks for memory before it is needed, where the order of numbers says nothing of where
// things are.
#pragma once

namespace remanifold::detail {

inline void prefetch([[maybe_unused]] const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#endif
}

}  // namespace remanifold::detail
