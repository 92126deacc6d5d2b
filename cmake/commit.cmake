# SPDX-License-Identifier: Apache-2.0
# cmake -D SOURCE=... -D OUTPUT=commit.h -P commit.cmake: the commit that is built and its day, empty outside of a checkout of our own.
find_package(Git QUIET)
set(commit)
set(date)
if(GIT_FOUND AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} describe --always --dirty --abbrev=12 --match=v[0-9]*
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} log -1 --format=%cs
    OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define TACTUS_COMMIT \"${commit}\"\n#define TACTUS_DATE \"${date}\"\n" @ONLY)
