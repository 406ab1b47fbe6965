# SPDX-License-Identifier: GPL-3.0-or-later
add_library(remanifold_warnings INTERFACE)
target_compile_options(
  remanifold_warnings
  INTERFACE -Wall
            -Wextra
            -Wpedantic
            -Wcast-align
            -Wconversion
            -Wno-sign-conversion
            -Wnon-virtual-dtor
            -Woverloaded-virtual
            -Wshadow
            $<$<BOOL:${REMANIFOLD_WARNINGS_AS_ERRORS}>:-Werror>)
