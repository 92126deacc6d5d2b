# SPDX-License-Identifier: Apache-2.0
# Read by cpack. The files in the packages, and the packages themselves, have the time of the commit: one commit gives the same bytes, at
# any time and in any folder, by the same compiler and umask. SOURCE_DATE_EPOCH says another time; outside of a checkout it is needed.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH} AND EXISTS ${CPACK_PACKAGE_SOURCE}/.git)
  execute_process(COMMAND git -C ${CPACK_PACKAGE_SOURCE} log -1 --format=%ct
    OUTPUT_VARIABLE seconds OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(seconds MATCHES "^[0-9]+$")
    set(ENV{SOURCE_DATE_EPOCH} ${seconds})
  endif()
endif()
