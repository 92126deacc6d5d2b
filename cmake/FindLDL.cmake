# SPDX-License-Identifier: Apache-2.0
# SuiteSparse::LDL, for versions of SuiteSparse that bring no CMake file.
include(FindPackageHandleStandardArgs)

find_path(LDL_INCLUDE_DIR ldl.h PATH_SUFFIXES suitesparse)
find_library(LDL_LIBRARY ldl)
mark_as_advanced(LDL_INCLUDE_DIR LDL_LIBRARY)
find_package_handle_standard_args(LDL REQUIRED_VARS LDL_LIBRARY LDL_INCLUDE_DIR)

if(LDL_FOUND AND NOT TARGET SuiteSparse::LDL)
  add_library(SuiteSparse::LDL UNKNOWN IMPORTED)
  set_target_properties(SuiteSparse::LDL PROPERTIES
    IMPORTED_LOCATION ${LDL_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LDL_INCLUDE_DIR})
endif()
