/* SPDX-License-Identifier: Apache-2.0 */
/* Play two streams of one scene side by side: packets, hash of the last state, and how far apart they are shown. In C; compare_streams.py
   is the same program.   usage: compare_streams A.tct B.tct */
#include <math.h>
#include <stdio.h>
#include <tactus.h>

int main(int argc, char** argv) {
  static uint8_t files[2][1 << 24];
  tactus_player* players[2] = {NULL, NULL};
  tactus_error error;
  tactus_scene_info scene = {.size = sizeof scene};
  size_t packets[2] = {0, 0}, bytes[2] = {0, 0};
  double farthest = 0;
  if (argc != 3) return fprintf(stderr, "usage: compare_streams A.tct B.tct\n"), 2;
  for (int i = 0; i < 2; ++i) {
    FILE* file = fopen(argv[i + 1], "rb");
    size_t size = file != NULL ? fread(files[i], 1, sizeof files[i], file) : 0;
    if (file != NULL) fclose(file);
    if (tactus_player_open(files[i], size, NULL, &players[i], &error) != TACTUS_OK)
      return fprintf(stderr, "%s: %s (%s)\n", argv[i + 1], tactus_error_text(&error), error.rule), 1;
  }
  tactus_scene_get(tactus_receiver_scene(tactus_player_receiver(players[0])), &scene, NULL);
  for (int64_t tick = 0, next[2] = {0, 0}; next[0] != INT64_MAX || next[1] != INT64_MAX; ++tick) {
    for (int i = 0; i < 2; ++i) {
      tactus_packet_info info = {.size = sizeof info};
      for (; tactus_player_play(players[i], tick, &info, &error) == TACTUS_OK; ++packets[i]) bytes[i] += info.bytes;
      if (tactus_player_next_tick(players[i], &next[i], &error) != TACTUS_OK) next[i] = INT64_MAX;
    }
    for (uint32_t object = 0; object < scene.rigid; ++object) {
      tactus_pose a, b;
      tactus_receiver_poses(tactus_player_receiver(players[0]), tick, object, 1, &a, NULL);
      if (tactus_receiver_poses(tactus_player_receiver(players[1]), tick, object, 1, &b, &error) != TACTUS_OK) return 1;
      farthest = fmax(farthest,
                      hypot(hypot(a.position[0] - b.position[0], a.position[1] - b.position[1]), a.position[2] - b.position[2]));
    }
  }
  for (int i = 0; i < 2; tactus_player_destroy(players[i++])) {
    uint64_t hash = 0;
    tactus_receiver_state_hash(tactus_player_receiver(players[i]), 0, &hash, NULL);
    printf("%s: %zu packets, %zu bytes, state %016llx\n", argv[i + 1], packets[i], bytes[i], (unsigned long long)hash);
  }
  printf("at most %.3f mm apart\n", 1e3 * farthest);
  return 0;
}
