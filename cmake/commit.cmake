# SPDX-License-Identifier: Apache-2.0
# cmake -D SOURCE=... -D OUTPUT=commit.h -P commit.cmake: the commit that is built and its day, empty outside of a checkout of our own.
# Where what the program is built from differs from the commit, "-dirty-" and the first digits of a digest of the differences follow.
cmake_minimum_required(VERSION 3.22)
set(built_from CMakeLists.txt CMakePresets.json cmake codec session io metrics sim device cli bindings spec)
find_package(Git QUIET)

# Sets `out` to the lines that git prints as a list, and to FAILED where it fails.
function(ask_git out)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} -c core.quotePath=false ${ARGN}
    RESULT_VARIABLE failed OUTPUT_VARIABLE text OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(failed)
    set(text FAILED)
  endif()
  string(REPLACE ";" "\\;" text "${text}")
  string(REPLACE "\n" ";" text "${text}")
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

# Sets `out` to what is to follow the commit.
function(list_changes out)
  set(${out} PARENT_SCOPE)
  ask_git(changed diff --name-only --no-renames --ignore-submodules HEAD -- ${built_from})
  ask_git(untracked ls-files --others --exclude-standard -- ${built_from})
  set(listed)
  foreach(file IN LISTS changed untracked)
    set(digest)  # of nothing: the file was removed
    if(EXISTS "${SOURCE}/${file}" AND NOT IS_DIRECTORY "${SOURCE}/${file}")
      file(SHA256 "${SOURCE}/${file}" digest)
    endif()
    string(APPEND listed "${file} ${digest}\n")
  endforeach()
  if("FAILED" IN_LIST changed OR "FAILED" IN_LIST untracked)
    set(${out} -dirty PARENT_SCOPE)
  elseif(listed)
    string(SHA256 digest "${listed}")
    string(SUBSTRING ${digest} 0 8 digest)
    set(${out} -dirty-${digest} PARENT_SCOPE)
  endif()
endfunction()

set(commit)
set(date)
if(GIT_FOUND AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} describe --always --abbrev=12 --match=v[0-9]*
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} log -1 --format=%cs
    OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(commit)
  list_changes(changes)
  string(APPEND commit "${changes}")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define TACTUS_COMMIT \"${commit}\"\n#define TACTUS_DATE \"${date}\"\n" @ONLY)
