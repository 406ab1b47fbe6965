# SPDX-License-Identifier: GPL-3.0-or-later
add_library(remanifold_sanitizers INTERFACE)
if(REMANIFOLD_SANITIZE)
  # GCC takes what the sanitizers insert for uses of uninitialized variables. Four checks
  # stand at every load and cost half of the compiler's time: a null pointer that is
  # followed, and places outside of an object, stop the address sanitizer as well, and Eigen
  # asserts alignment itself.
  target_compile_options(
    remanifold_sanitizers
    INTERFACE -fsanitize=${REMANIFOLD_SANITIZE} -fno-sanitize=null,alignment,object-size,pointer-overflow
              -fno-sanitize-recover=all -fno-omit-frame-pointer
              -Wno-maybe-uninitialized)
  target_link_options(remanifold_sanitizers INTERFACE -fsanitize=${REMANIFOLD_SANITIZE})
endif()
