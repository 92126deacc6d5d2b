# SPDX-License-Identifier: Apache-2.0
# cmake -D FOLDER=... -P compress.cmake: gzip every file in the folder, without its time, so that the same text gives the same bytes.
set(ENV{SOURCE_DATE_EPOCH} 0)
file(GLOB files ${FOLDER}/*)
foreach(file IN LISTS files)
  file(ARCHIVE_CREATE OUTPUT ${file}.gz PATHS ${file} FORMAT raw COMPRESSION GZip COMPRESSION_LEVEL 9)
  file(REMOVE ${file})
endforeach()
