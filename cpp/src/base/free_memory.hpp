// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that was freed goes back to the system. Allocators keep it, for what they expect
// to be asked for next; but steps free arrays of one size and ask for those of another, so
// that what one step has freed would come on top of what the next one takes.
#pragma once

#include <cstddef>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace remanifold::detail {

/// \param freed  bytes, about: little is not worth the while
inline void give_back_memory([[maybe_unused]] std::size_t freed) {
#ifdef __GLIBC__
  constexpr std::size_t worth = std::size_t{1} << 22;
  if (freed >= worth) {
    malloc_trim(0);
  }
#endif
}

}  // namespace remanifold::detail
