/* SPDX-License-Identifier: Apache-2.0 */
/* What a user of the installed C library for traces writes: here there is none, and that is said. */
#include <stdio.h>
#include <string.h>
#include <tactus_trace.h>

int main(void) {
  tactus_trace* trace = NULL;
  tactus_error error = {0};
  const tactus_status status = tactus_trace_open("nowhere.mcap", NULL, 0, &trace, &error);
  printf("status %d, %s\n", status, error.rule);
  return status == TACTUS_IO && strcmp(error.rule, "R-TRC-1") == 0 && trace == NULL ? 0 : 1;
}
