// SPDX-License-Identifier: Apache-2.0
// The page that the build made, for page.cpp.
  .section .rodata
  .global tactus_page_begin, tactus_page_end
tactus_page_begin:
  .incbin TACTUS_PAGE
tactus_page_end:
  .section .note.GNU-stack, "", %progbits
