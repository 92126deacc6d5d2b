# SPDX-License-Identifier: Apache-2.0
# Every header is included as <tactus/...>, here as where the library is installed: PROJECT_BINARY_DIR/include/tactus holds links to the
# folders, codec/ being the top one.
file(GLOB entries LIST_DIRECTORIES true CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/codec/*)
list(FILTER entries EXCLUDE REGEX "CMakeLists.txt$")
list(APPEND entries ${PROJECT_SOURCE_DIR}/session ${PROJECT_SOURCE_DIR}/session/session.h ${PROJECT_SOURCE_DIR}/io/trace ${PROJECT_SOURCE_DIR}/io/net ${PROJECT_SOURCE_DIR}/io/seal
  ${PROJECT_SOURCE_DIR}/metrics ${PROJECT_SOURCE_DIR}/sim ${PROJECT_SOURCE_DIR}/device)
file(REMOVE_RECURSE ${PROJECT_BINARY_DIR}/include/tactus)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include/tactus)
foreach(entry IN LISTS entries)
  get_filename_component(name ${entry} NAME)
  file(CREATE_LINK ${entry} ${PROJECT_BINARY_DIR}/include/tactus/${name} SYMBOLIC)
endforeach()

# The headers of a library that are installed: FOLDER/FILE becomes <tactus/PREFIX/FILE>.
function(tactus_headers target folder prefix)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  if(NOT TACTUS_INSTALL)
    return()
  endif()
  foreach(header IN LISTS ARGN)
    get_filename_component(sub ${header} DIRECTORY)
    install(FILES ${PROJECT_SOURCE_DIR}/${folder}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tactus/${prefix}/${sub})
  endforeach()
endfunction()
