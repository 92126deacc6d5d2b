/* SPDX-License-Identifier: Apache-2.0 */
/* What a user of the installed C library writes: a cube that moves, its packets, and a receiver that shows where it is. */
#include <stdio.h>
#include <tactus_encoder.h>
#include <tactus_session.h>

static int failed(const char* call, const tactus_error* error) {
  fprintf(stderr, "%s: %s (%s). %s\n", call, error->text, error->rule, error->remedy);
  return 1;
}

int main(void) {
  tactus_scene_builder* builder = NULL;
  tactus_scene* scene = NULL;
  tactus_sender* sender = NULL;
  tactus_receiver* receiver = NULL;
  tactus_error error;
  size_t sent = 0;
  if (tactus_version() != TACTUS_VERSION) return fprintf(stderr, "header and library differ\n"), 1;
  if (tactus_scene_builder_create(NULL, &builder, &error)) return failed("create", &error);
  if (tactus_scene_builder_rigid(builder, "cube", NULL, &error)) return failed("rigid", &error);
  if (tactus_scene_builder_build(builder, &scene, &error)) return failed(error.object, &error);
  if (tactus_sender_create(scene, NULL, &sender, &error)) return failed("sender", &error);
  if (tactus_receiver_create(scene, NULL, &receiver, &error)) return failed("receiver", &error);
  for (int64_t tick = 0; tick < 200; ++tick) {
    tactus_rigid_sample cube = {.pose = {{1e-3 * (double)tick, 0, 0}, {1, 0, 0, 0}}, .velocity = {1, 0, 0}};
    tactus_truth truth = {.size = sizeof truth, .objects = &cube, .object_count = 1};
    tactus_encoded encoded = {.size = sizeof encoded};
    tactus_pose shown;
    if (tactus_sender_encode(sender, tick, &truth, &encoded, &error)) return failed("encode", &error);
    for (size_t i = 0; i < encoded.packet_count; ++i, ++sent) {
      const tactus_packet* packet = &encoded.packets[i];
      if (tactus_receiver_push(receiver, packet->number, packet->data, packet->bytes, TACTUS_PACKET_TICK, NULL, &error))
        return failed("push", &error);
    }
    if (tactus_receiver_poses(receiver, tick, 0, 1, &shown, NULL, &error)) return failed("poses", &error);
    if (shown.position[0] < cube.pose.position[0] - 0.006 || shown.position[0] > cube.pose.position[0] + 0.006) return 1;
  }
  printf("%zu packets in 200 ticks\n", sent);
  tactus_receiver_destroy(receiver);
  tactus_sender_destroy(sender);
  tactus_scene_destroy(scene);
  tactus_scene_builder_destroy(builder);
  return sent > 0 && sent < 20 ? 0 : 1;
}
