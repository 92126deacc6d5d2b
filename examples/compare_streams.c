/* SPDX-License-Identifier: Apache-2.0 */
/* Play two streams of one scene side by side: packets, hash of the last state, and how far apart the first object is shown.
   compare_streams.py and compare_streams.mjs are the same program.   usage: compare_streams A.tct B.tct */
#include <math.h>
#include <stdio.h>
#include <tactus.h>

int main(int argc, char** argv) {
  static uint8_t files[2][1 << 24];
  tactus_player* players[2] = {NULL, NULL};
  tactus_error error;
  size_t packets[2] = {0, 0}, bytes[2] = {0, 0};
  double farthest = 0;
  if (argc != 3) return fprintf(stderr, "usage: compare_streams A.tct B.tct\n"), 2;
  for (int i = 0; i < 2; ++i) {
    FILE* file = fopen(argv[i + 1], "rb");
    if (file == NULL) return perror(argv[i + 1]), 1;
    if (tactus_player_open(files[i], fread(files[i], 1, sizeof files[i], file), NULL, &players[i], &error) != TACTUS_OK)
      return fprintf(stderr, "%s: %s (%s)\n", argv[i + 1], error.text, error.rule), 1;
  }
  tactus_player_info at[2] = {{.size = sizeof *at}, {.size = sizeof *at}};
  for (int64_t tick = 0; at[0].next_tick != INT64_MAX || at[1].next_tick != INT64_MAX; ++tick) {
    tactus_pose shown[2];
    for (int i = 0; i < 2; ++i) {
      tactus_packet_info info = {.size = sizeof info};
      for (; tactus_player_play(players[i], tick, &info, &error) == TACTUS_OK; ++packets[i]) bytes[i] += info.bytes;
      if (tactus_player_get(players[i], &at[i], &error) != TACTUS_OK) at[i].next_tick = INT64_MAX;
      if (tactus_receiver_poses(tactus_player_receiver(players[i]), tick, 0, 1, &shown[i], NULL, &error) != TACTUS_OK)
        return fprintf(stderr, "%s: no rigid object\n", argv[i + 1]), 1;
    }
    const double *a = shown[0].position, *b = shown[1].position;
    farthest = fmax(farthest, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
  }
  for (int i = 0; i < 2; tactus_player_destroy(players[i++])) {
    uint64_t hash = 0;
    tactus_receiver_hash(tactus_player_receiver(players[i]), 0, &hash, 0, NULL, NULL);
    printf("%s: %zu packets, %zu bytes, state %016llx\n", argv[i + 1], packets[i], bytes[i], (unsigned long long)hash);
  }
  return printf("at most %.3f mm apart\n", 1e3 * farthest) < 0;
}
