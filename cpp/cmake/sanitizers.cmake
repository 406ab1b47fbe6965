# SPDX-License-Identifier: GPL-3.0-or-later
add_library(remanifold_sanitizers INTERFACE)
if(REMANIFOLD_SANITIZE)
  # GCC takes what the sanitizers insert for uses of uninitialized variables.
  target_compile_options(
    remanifold_sanitizers
    INTERFACE -fsanitize=${REMANIFOLD_SANITIZE} -fno-sanitize-recover=all
              -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  target_link_options(remanifold_sanitizers INTERFACE -fsanitize=${REMANIFOLD_SANITIZE})
endif()
