# SPDX-License-Identifier: Apache-2.0
include(CMakePackageConfigHelpers)
include(${CMAKE_CURRENT_LIST_DIR}/pkgconfig.cmake)

# Parts of an installation, each a Debian package (packages.cmake): library, development, tools, python.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)

# Install what was built. Each library has its own export set, so that a user of the codec needs no package of the others.
# Public headers are the targets' FILE_SET HEADERS and land below include/tactus/ in the same tree as here.
function(tactus_install)
  set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tactus)
  tactus_components(built left_out)
  foreach(component IN LISTS built)
    install(TARGETS tactus_${component} EXPORT tactus_${component}
      LIBRARY COMPONENT library NAMELINK_COMPONENT development ARCHIVE COMPONENT development)
    install(EXPORT tactus_${component} NAMESPACE tactus:: FILE ${component}.cmake DESTINATION ${config_dir})
    tactus_pkg_config(${component})
  endforeach()
  if(TARGET tactus_sim)
    install(DIRECTORY sim/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus COMPONENT tools FILES_MATCHING PATTERN "*.toml" PATTERN "*.obj" PATTERN "README.md")
    install(DIRECTORY reports/plans DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus COMPONENT tools FILES_MATCHING PATTERN "*.toml" PATTERN "README.md")
  endif()
  if(TARGET tactus_trace)
    install(FILES cmake/FindLZ4.cmake DESTINATION ${config_dir})
  endif()
  if(TARGET tactus_fem)
    install(FILES cmake/FindLDL.cmake cmake/FindCHOLMOD.cmake DESTINATION ${config_dir})
  endif()

  configure_package_config_file(cmake/tactusConfig.cmake.in tactusConfig.cmake INSTALL_DESTINATION ${config_dir})
  write_basic_package_version_file(tactusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/tactusConfig.cmake ${PROJECT_BINARY_DIR}/tactusConfigVersion.cmake
    DESTINATION ${config_dir})
  install(FILES LICENSE README.md CHANGELOG.md CONTRIBUTING.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libtactus-dev COMPONENT development)
  install(DIRECTORY spec docs examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libtactus-dev COMPONENT development
    PATTERN "*.md" PATTERN "*.csv" PATTERN "*.cpp" PATTERN "*.c" PATTERN "*.h" PATTERN "*.cs" PATTERN "*.py" PATTERN "*.mjs"
    PATTERN "make.py" EXCLUDE PATTERN "tools" EXCLUDE PATTERN "__pycache__" EXCLUDE PATTERN "CMakeLists.txt" EXCLUDE)
endfunction()
