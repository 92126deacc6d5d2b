# SPDX-License-Identifier: Apache-2.0
include(CMakePackageConfigHelpers)

# Install what was built. Each library has its own export set, so that a user of the codec needs no package of the others.
# Public headers are the targets' FILE_SET HEADERS and land below include/tactus/ in the same tree as here.
function(tactus_install)
  set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tactus)
  tactus_components(built without)
  foreach(component IN LISTS built)
    install(TARGETS tactus_${component} EXPORT tactus_${component})
    install(EXPORT tactus_${component} NAMESPACE tactus:: FILE ${component}.cmake DESTINATION ${config_dir})
  endforeach()
  if(TARGET tactus_sim)
    install(DIRECTORY sim/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus FILES_MATCHING PATTERN "*.toml" PATTERN "*.obj")
  endif()
  if(TARGET tactus_fem)
    install(FILES cmake/FindLDL.cmake cmake/FindCHOLMOD.cmake DESTINATION ${config_dir})
  endif()

  configure_package_config_file(cmake/tactusConfig.cmake.in tactusConfig.cmake INSTALL_DESTINATION ${config_dir})
  write_basic_package_version_file(tactusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/tactusConfig.cmake ${PROJECT_BINARY_DIR}/tactusConfigVersion.cmake
    DESTINATION ${config_dir})
endfunction()
