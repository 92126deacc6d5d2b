# SPDX-License-Identifier: Apache-2.0
# Run by cpack before it packs what was installed for it: the licence and the changes, which Debian wants of every package, and modes of
# folders for everybody, whatever the umask of who makes the packages (CPack sets them for a umask of 022 only).
string(TIMESTAMP day "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH, where that is set
set(changelog "tactus (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * See the history of the repository.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${day}
")
set(copyright [[
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Tactus

Files: *
Copyright: 2026 the contributors of Tactus
License: Apache-2.0
 On Debian systems, the full text of the Apache License, Version 2.0 is in
 /usr/share/common-licenses/Apache-2.0.
]])
foreach(part IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${part} upper)
  set(folder ${CPACK_TEMPORARY_DIRECTORY}/${part}${CPACK_PACKAGING_INSTALL_PREFIX}/share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  file(WRITE ${folder}/copyright "${copyright}")
  file(WRITE ${CPACK_TEMPORARY_DIRECTORY}/changelog/changelog "${changelog}")
  execute_process(COMMAND ${CMAKE_COMMAND} -D FOLDER=${CPACK_TEMPORARY_DIRECTORY}/changelog -P ${CMAKE_CURRENT_LIST_DIR}/compress.cmake
    COMMAND_ERROR_IS_FATAL ANY)
  file(RENAME ${CPACK_TEMPORARY_DIRECTORY}/changelog/changelog.gz ${folder}/changelog.gz)
  file(CHMOD ${folder}/copyright ${folder}/changelog.gz PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endforeach()
file(REMOVE_RECURSE ${CPACK_TEMPORARY_DIRECTORY}/changelog)

file(GLOB_RECURSE entries LIST_DIRECTORIES true ${CPACK_TEMPORARY_DIRECTORY}/*)
foreach(entry IN LISTS entries)
  if(IS_DIRECTORY ${entry} AND NOT IS_SYMLINK ${entry})
    file(CHMOD ${entry} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  endif()
endforeach()
