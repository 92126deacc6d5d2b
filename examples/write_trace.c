/* SPDX-License-Identifier: Apache-2.0 */
/* The same recording as of write_trace.cpp, through the C interface.   usage: write_trace OUT.mcap */
#include <math.h>
#include <stdio.h>
#include <tactus_trace.h>

enum { ROWS = 1000 };
static int64_t time_ns[ROWS];
static double position[ROWS][3], rotation[ROWS][4], force[ROWS][3];

int main(int argc, char** argv) {
  if (argc != 2) return fprintf(stderr, "usage: write_trace OUT.mcap\n"), 2;
  for (int i = 0; i < ROWS; ++i) {
    const double t = i / 500.0;
    time_ns[i] = INT64_C(2000000) * i;
    position[i][0] = 0.05 * sin(3 * t), position[i][1] = 0.02 * cos(2 * t);
    rotation[i][0] = cos(t / 2), rotation[i][3] = sin(t / 2);
    force[i][2] = 2 + sin(7 * t);
  }
  tactus_arrays* arrays = NULL;
  tactus_error error;
  const char* notes = "";
  if (tactus_arrays_create(time_ns, ROWS, 0, 0, "write_trace", &arrays, &error) != TACTUS_OK ||
      tactus_arrays_object(arrays, "cup", *position, *rotation, NULL, NULL, &error) != TACTUS_OK ||
      tactus_arrays_user(arrays, "hand", NULL, NULL, *force, &error) != TACTUS_OK ||
      tactus_arrays_contact(arrays, "hand", "cup", 500, TACTUS_CONTACT_SURFACE, 1, &error) != TACTUS_OK ||
      tactus_arrays_write(arrays, argv[1], &notes, &error) != TACTUS_OK)
    return fprintf(stderr, "%s: %s (%s)\n", argv[1], error.text, error.rule), 1;
  printf("%s", notes); /* missing samples, times off the grid */
  tactus_arrays_destroy(arrays);
  return 0;
}
