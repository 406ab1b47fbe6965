# SPDX-License-Identifier: GPL-3.0-or-later
# Third-party code of the core. All of it is private: no public header shows any of it.

# find_package that names the Debian package when it fails.
macro(remanifold_find_package name debian_package)
  find_package(${name} QUIET ${ARGN})
  if(NOT ${name}_FOUND)
    message(FATAL_ERROR "remanifold needs ${name} ${ARGV2}. "
                        "On Debian: apt-get install ${debian_package}")
  endif()
endmacro()

remanifold_find_package(TBB libtbb-dev)
remanifold_find_package(Eigen3 libeigen3-dev 3.4 NO_MODULE)
include(${CMAKE_CURRENT_LIST_DIR}/remanifoldLibraries.cmake)

# CGAL is header-only. It comments on build types that are not its own business here, and
# would use the C++ layer of GMP, one more library to link, for what the C layer does too.
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE
    TRUE
    CACHE INTERNAL "")
set(CGAL_WITH_GMPXX
    OFF
    CACHE BOOL "Let CGAL use the C++ layer of GMP")
mark_as_advanced(CGAL_WITH_GMPXX)
set(CMAKE_POLICY_DEFAULT_CMP0167 NEW) # CGAL finds Boost by Boost's own package
remanifold_find_package(CGAL libcgal-dev 5.4)
include(CGAL_Eigen3_support)
add_library(remanifold_cgal INTERFACE)
target_link_libraries(remanifold_cgal INTERFACE CGAL::CGAL CGAL::Eigen3_support)

# Only templates of FLANN are used, so its headers are enough. Their code for saving an
# index, which nothing here calls, is virtual and wants lz4.
find_path(
  REMANIFOLD_FLANN_INCLUDE_DIR
  NAMES flann/flann.hpp
  DOC "Directory of FLANN's headers")
mark_as_advanced(REMANIFOLD_FLANN_INCLUDE_DIR)
if(NOT REMANIFOLD_FLANN_INCLUDE_DIR)
  message(FATAL_ERROR "remanifold needs the headers of FLANN. "
                      "On Debian: apt-get install libflann-dev liblz4-dev")
endif()
add_library(remanifold_flann INTERFACE)
target_include_directories(remanifold_flann SYSTEM
                           INTERFACE ${REMANIFOLD_FLANN_INCLUDE_DIR})
