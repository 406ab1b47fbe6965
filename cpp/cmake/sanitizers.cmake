# SPDX-License-Identifier: GPL-3.0-or-later
add_library(remanifold_sanitizers INTERFACE)
if(REMANIFOLD_SANITIZE)
  target_compile_options(
    remanifold_sanitizers INTERFACE -fsanitize=${REMANIFOLD_SANITIZE}
                                    -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(remanifold_sanitizers INTERFACE -fsanitize=${REMANIFOLD_SANITIZE})
endif()
