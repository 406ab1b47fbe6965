# SPDX-License-Identifier: GPL-3.0-or-later
# Plain libraries that come without a CMake package. Used by the build and, installed, by
# remanifoldConfig.cmake.

# Define the imported target remanifold::<name>, or say which Debian package is missing.
function(remanifold_find_library name debian_package)
  if(TARGET remanifold::${name})
    return()
  endif()
  find_library(REMANIFOLD_${name}_LIBRARY NAMES ${name})
  mark_as_advanced(REMANIFOLD_${name}_LIBRARY)
  if(NOT REMANIFOLD_${name}_LIBRARY)
    message(FATAL_ERROR "remanifold needs the library ${name}. "
                        "On Debian: apt-get install ${debian_package}")
  endif()
  add_library(remanifold::${name} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(remanifold::${name}
                        PROPERTIES IMPORTED_LOCATION "${REMANIFOLD_${name}_LIBRARY}")
endfunction()

remanifold_find_library(gmp libgmp-dev)
remanifold_find_library(mpfr libmpfr-dev)
remanifold_find_library(lz4 liblz4-dev)
