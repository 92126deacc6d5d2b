# SPDX-License-Identifier: Apache-2.0
# A file for pkg-config beside each library, from what the library links: tactus-codec.pc for tactus::codec.

# What other packages' targets are called there; a word with a dash in front is a flag for the linker. Headers alone: nothing to say.
set(TACTUS_PKG_CONFIG
  "tl::expected"
  "zstd::libzstd_shared       libzstd"
  "LZ4::lz4                   liblz4"
  "Threads::Threads           -pthread"
  "GnuTLS::GnuTLS             gnutls"
  "Eigen3::Eigen              eigen3"
  "SuiteSparse::LDL           -lldl"
  "SuiteSparse::CHOLMOD       -lcholmod"
  "Spectra::Spectra"
  "PkgConfig::ode             ode"
  "tomlplusplus::tomlplusplus tomlplusplus"
  "nlohmann_json::nlohmann_json"
  "Boost::headers"
  "dl                         -ldl")

# tactus_pkg_config(COMPONENT): write and install the file.
function(tactus_pkg_config component)
  get_target_property(linked tactus_${component} INTERFACE_LINK_LIBRARIES)
  get_target_property(name tactus_${component} OUTPUT_NAME)
  if(NOT name)
    set(name tactus_${component})
  endif()
  set(requires)
  set(libs -l${name})
  foreach(library IN LISTS linked)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" library "${library}")
    if(NOT library OR library MATCHES "BUILD_INTERFACE")
      continue()
    elseif(library MATCHES "^tactus::(.*)$")
      list(APPEND requires tactus-${CMAKE_MATCH_1})
      continue()
    endif()
    set(row ${TACTUS_PKG_CONFIG})
    list(FILTER row INCLUDE REGEX "^${library}( |$)")
    if(NOT row)
      message(FATAL_ERROR "cmake/pkgconfig.cmake does not know what pkg-config calls ${library}, which tactus_${component} links")
    endif()
    separate_arguments(words UNIX_COMMAND "${row}")
    list(POP_FRONT words)
    if(words MATCHES "^-")
      list(APPEND libs ${words})
    else()
      list(APPEND requires ${words})
    endif()
  endforeach()
  list(JOIN requires ", " requires)
  list(JOIN libs " " libs)
  string(REPLACE _ - package tactus-${component})
  file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  file(CONFIGURE OUTPUT ${package}.pc @ONLY CONTENT [[
prefix=${pcfiledir}/@up@
libdir=${prefix}/@CMAKE_INSTALL_LIBDIR@
includedir=${prefix}/@CMAKE_INSTALL_INCLUDEDIR@

Name: @package@
Description: @PROJECT_DESCRIPTION@ (@component@)
Version: @PROJECT_VERSION@
Requires: @requires@
Cflags: -I${includedir}
Libs: -L${libdir} @libs@
]])
  install(FILES ${PROJECT_BINARY_DIR}/${package}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()
