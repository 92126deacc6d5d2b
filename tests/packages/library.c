/* SPDX-License-Identifier: Apache-2.0 */
/* The installed header and the installed library are of one version. */
#include <stdio.h>
#include <tactus.h>

int main(void) {
  printf("libtactus %#x\n", (unsigned)tactus_version());
  return tactus_version() == TACTUS_VERSION ? 0 : 1;
}
