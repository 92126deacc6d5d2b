# SPDX-License-Identifier: Apache-2.0
# Compiled once for the components that take it in, FEM and MODES: Spectra's templates are half a minute of work.
if(NOT TARGET tactus_slowest_modes)
  add_library(tactus_slowest_modes OBJECT ${PROJECT_SOURCE_DIR}/sim/modes/slowest_modes.cpp)
  target_include_directories(tactus_slowest_modes PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(tactus_slowest_modes PRIVATE tactus_flags Eigen3::Eigen Spectra::Spectra)
  target_compile_definitions(tactus_slowest_modes PRIVATE EIGEN_MPL2_ONLY)
  set_target_properties(tactus_slowest_modes PROPERTIES CXX_VISIBILITY_PRESET default
    POSITION_INDEPENDENT_CODE ON)
endif()
