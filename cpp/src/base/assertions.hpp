// SPDX-License-Identifier: GPL-3.0-or-later
// Whether steps verify what they return.
#pragma once

namespace remanifold::detail {

#ifdef NDEBUG
constexpr bool kAssertions = false;
#else
constexpr bool kAssertions = true;
#endif

/// Runs the check in Debug and under the sanitizers. In Release it is compiled, not run.
template <class Check>
void assert_that(const Check& check) {
  if constexpr (kAssertions) {
    check();
  }
}

}  // namespace remanifold::detail
