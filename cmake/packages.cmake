# SPDX-License-Identifier: Apache-2.0
# `cpack` in a finished build makes Debian packages, one for each part of an installation that the build has:
#   libtactus0     the C interface (library)
#   libtactus-dev  headers, libraries, files for CMake and pkg-config, specification, examples (development)
#   tactus         the program with its manual, completion, scenes and plans (tools)
#   python3-tactus the Python package (python)

# The packages whose headers and libraries our libraries need, and no other.
set(dev_depends)
set(dev_packages zstd LZ4 ode GnuTLS tomlplusplus Eigen3 LDL Spectra)
foreach(row IN LISTS TACTUS_PACKAGES)
  separate_arguments(words UNIX_COMMAND "${row}")
  list(GET words 0 package)
  list(GET words 1 debian)
  list(GET words 2 target)
  if(package IN_LIST dev_packages AND TARGET ${target})
    string(REPLACE "," ";" debian "${debian}")
    list(APPEND dev_depends ${debian})
  endif()
endforeach()
list(REMOVE_DUPLICATES dev_depends)
list(JOIN dev_depends ", " dev_depends)

set(parts development)
if(TARGET tactus_c)
  list(APPEND parts library)
  set(library_depends ", libtactus${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION})")
endif()
if(TARGET tactus)
  list(APPEND parts tools)
endif()
if(TARGET tactus_python)
  list(APPEND parts python)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${parts})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME tactus)
set(CPACK_PACKAGE_VENDOR "Tactus")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
# Two scripts of cpack: when the packages are from, and what is in them beside what is installed.
set(CPACK_PACKAGE_SOURCE ${PROJECT_SOURCE_DIR})
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/package_date.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/package_files.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Who makes the packages answers for them, and says so as in Debian's own tools.
set(maintainer "Local build <nobody@tactus.invalid>")
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(maintainer "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${maintainer} CACHE STRING "Who answers for the packages; DEBFULLNAME and DEBEMAIL are the default")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtactus-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libexpected-dev, ${dev_depends}${library_depends}")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Codec for shared haptic environments, files for development
 Headers and libraries of the codec and of the components beside it, files
 for CMake and pkg-config, the specification of the format, and examples.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libtactus${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
file(CONFIGURE OUTPUT triggers CONTENT "activate-noawait ldconfig\n" @ONLY)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/triggers)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "Codec for shared haptic environments, C interface
 Encodes and decodes streams of object states at 1 kHz, within bounds that
 people feel and see.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME tactus)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
# Scripts of lab/ are Python, their figures matplotlib's.
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "python3, python3-numpy, python3-matplotlib")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "tetgen")
# The user of tactus@.service; where there is no systemd, nobody needs it.
file(CONFIGURE OUTPUT postinst CONTENT "#!/bin/sh\nset -e\nif [ configure = \"$1\" ] && command -v systemd-sysusers >/dev/null; then systemd-sysusers tactus.conf; fi\n" @ONLY)
set(everybody OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
file(CHMOD ${PROJECT_BINARY_DIR}/postinst PERMISSIONS ${everybody})
set(CPACK_DEBIAN_TOOLS_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/postinst)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "Codec for shared haptic environments, command line
 Simulates touches, encodes them into packets, decodes them and measures the
 error; records haptic devices and runs sessions over a network.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-tactus)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, libtactus${PROJECT_VERSION_MAJOR} (>= ${PROJECT_VERSION})")
file(CONFIGURE OUTPUT prerm CONTENT "#!/bin/sh\nset -e\npy3clean -p python3-tactus\n" @ONLY)
file(CHMOD ${PROJECT_BINARY_DIR}/prerm PERMISSIONS ${everybody})
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Codec for shared haptic environments, Python package
 Traces, streams and reports as arrays of NumPy.")

include(CPack)
