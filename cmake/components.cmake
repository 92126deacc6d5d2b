# SPDX-License-Identifier: Apache-2.0
# Parts of Tactus that can be left out, and the packages that they need.

# package          Debian package          target that proves it was found
set(TACTUS_PACKAGES
  "zstd            libzstd-dev             zstd::libzstd_shared"
  "LZ4             liblz4-dev              LZ4::lz4"
  "ode             libode-dev,pkgconf      PkgConfig::ode"
  "GnuTLS          libgnutls28-dev         GnuTLS::GnuTLS"
  "tomlplusplus    libtomlplusplus-dev     tomlplusplus::tomlplusplus"
  "CLI11           libcli11-dev            CLI11::CLI11"
  "nlohmann_json   nlohmann-json3-dev      nlohmann_json::nlohmann_json"
  "Eigen3          libeigen3-dev           Eigen3::Eigen"
  "LDL             libsuitesparse-dev      SuiteSparse::LDL"
  "CHOLMOD         libsuitesparse-dev      SuiteSparse::CHOLMOD"
  "Spectra         libspectra-dev          Spectra::Spectra"
  "libusb          libusb-1.0-0-dev,pkgconf PkgConfig::libusb"
  "hidapi          libhidapi-dev,pkgconf   PkgConfig::hidapi"
  "Boost           libboost-dev            Boost::headers"
  "Threads         libc6-dev               Threads::Threads"
  "fmt             libfmt-dev              fmt::fmt"
  "GTest           libgtest-dev            GTest::gtest_main"
  "benchmark       libbenchmark-dev        benchmark::benchmark"
  "Python3         python3                 Python3::Interpreter"
  "WasmClang clang-16,lld-16,binaryen,wasi-libc,libc++-16-dev-wasm32,libc++abi-16-dev-wasm32,libclang-rt-16-dev-wasm32 WasmClang::compiler"
  "Node            nodejs,npm              Node::node")

# These come without a CMake file: FindLZ4.cmake, FindLDL.cmake and FindCHOLMOD.cmake (installed beside ours), FindWasmClang.cmake, FindNode.cmake.
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})

# The packages whose ways differ from `find_package(NAME)`: ODE, libusb and hidapi come without a CMake file, Python needs its component named.
# A macro, so that what a package's own CMake file sets reaches the caller.
macro(tactus_find package)
  if(${package} STREQUAL ode)
    find_package(PkgConfig QUIET)
    if(PkgConfig_FOUND)
      pkg_check_modules(ode QUIET IMPORTED_TARGET ode)
    endif()
  elseif(${package} STREQUAL libusb)
    find_package(PkgConfig QUIET)
    if(PkgConfig_FOUND)
      pkg_check_modules(libusb QUIET IMPORTED_TARGET libusb-1.0)
    endif()
  elseif(${package} STREQUAL hidapi)
    find_package(PkgConfig QUIET)
    if(PkgConfig_FOUND)
      pkg_check_modules(hidapi QUIET IMPORTED_TARGET hidapi-hidraw)
    endif()
  elseif(${package} STREQUAL Python3)
    find_package(Python3 3.9 QUIET COMPONENTS Interpreter)
  else()
    find_package(${package} QUIET)
  endif()
endmacro()

# tactus_debian_packages(OUT name...): Debian packages that bring these, with blanks between.
function(tactus_debian_packages out)
  set(packages)
  foreach(name IN LISTS ARGN)
    set(row ${TACTUS_PACKAGES})
    list(FILTER row INCLUDE REGEX "^${name} ")
    separate_arguments(row UNIX_COMMAND "${row}")
    list(GET row 1 debian)
    list(APPEND packages ${debian})
  endforeach()
  string(REPLACE "," " " packages "${packages}")
  string(REPLACE ";" " " packages "${packages}")
  set(${out} "${packages}" PARENT_SCOPE)
endfunction()

# tactus_missing(OUT required...): Debian packages or components of ours that are needed and not there; empty when all is well.
# What is required is a component of ours (session, trace, net, fem, surface, sim, device, wasm, c) or a name from TACTUS_PACKAGES.
function(tactus_missing out)
  set(missing)
  foreach(required IN LISTS ARGN)
    if(required MATCHES "^(thesis|session|trace|net|seal|tets|fem|surface|sim|device|wasm|c)$")
      if(NOT TARGET tactus_${required})
        string(TOUPPER ${required} upper)
        list(APPEND missing "TACTUS_WITH_${upper}")
      endif()
      continue()
    endif()
    set(row ${TACTUS_PACKAGES})
    list(FILTER row INCLUDE REGEX "^${required} ")
    separate_arguments(row UNIX_COMMAND "${row}")
    list(GET row 1 debian)
    list(GET row 2 target)
    tactus_find(${required})
    if(NOT TARGET ${target})
      string(REPLACE "," " " debian "${debian}")
      list(APPEND missing "${required} (apt-get install ${debian})")
    endif()
  endforeach()
  list(JOIN missing ", " missing)
  set(${out} "${missing}" PARENT_SCOPE)
endfunction()

# tactus_component(NAME dir required...): build dir/ as TACTUS_WITH_<NAME> says.
#   AUTO  when everything required is there; else one line says what is left out and what brings it
#   ON    what is missing is an error
#   OFF   not at all
function(tactus_component name dir)
  if(NOT TACTUS_WITH_${name})
    return()
  endif()
  tactus_missing(missing ${ARGN})
  if(NOT missing)
    add_subdirectory(${dir})
  elseif(TACTUS_WITH_${name} STREQUAL AUTO)
    message(STATUS "Leaving out ${dir}/ (TACTUS_WITH_${name}=AUTO): it needs ${missing}")
  else()
    message(FATAL_ERROR "TACTUS_WITH_${name}=${TACTUS_WITH_${name}}: ${dir}/ needs ${missing}")
  endif()
endfunction()

# The components that are libraries, in the order in which they build on one another.
set(TACTUS_LIBRARIES codec thesis session trace net seal metrics tets modes surface fem sim device falcon hid openhaptics inverse3 c c_trace)

# tactus_components(BUILT LEFT_OUT): the libraries that are there and those that are not.
function(tactus_components built left_out)
  set(there)
  set(missing)
  foreach(component IN LISTS TACTUS_LIBRARIES)
    if(TARGET tactus_${component})
      list(APPEND there ${component})
    else()
      list(APPEND missing ${component})
    endif()
  endforeach()
  set(${built} "${there}" PARENT_SCOPE)
  set(${left_out} "${missing}" PARENT_SCOPE)
endfunction()
