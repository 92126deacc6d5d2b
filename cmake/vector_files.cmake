# SPDX-License-Identifier: Apache-2.0
# The conformance vectors as files of their own, for tests that read such: TACTUS_VECTOR_FILES.
find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter)
set(TACTUS_VECTOR_FILES ${PROJECT_BINARY_DIR}/vector_files)
file(GLOB packs CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/conformance/vectors/*)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${packs})
file(REMOVE_RECURSE ${TACTUS_VECTOR_FILES})
execute_process(COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/conformance/run.py --unpack ${TACTUS_VECTOR_FILES}
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
