# SPDX-License-Identifier: GPL-3.0-or-later
add_library(remanifold_sanitizers INTERFACE)
if(REMANIFOLD_SANITIZE)
  # GCC takes what the sanitizers insert for uses of uninitialized variables. Two checks stand
  # before every load and cost a quarter of the compiler's time: a null pointer that is
  # followed stops the address sanitizer as well, and Eigen asserts alignment itself.
  target_compile_options(
    remanifold_sanitizers
    INTERFACE -fsanitize=${REMANIFOLD_SANITIZE} -fno-sanitize=null,alignment
              -fno-sanitize-recover=all -fno-omit-frame-pointer
              -Wno-maybe-uninitialized)
  target_link_options(remanifold_sanitizers INTERFACE -fsanitize=${REMANIFOLD_SANITIZE})
endif()
