/* SPDX-License-Identifier: Apache-2.0 */
/* The first program: a cube slides and comes to rest, one second at 1 kHz. It prints what the other programs of this folder print. */
#include <stdio.h>
#include <stdlib.h>
#include <tactus_encoder.h>

static tactus_error error;
static void check(tactus_status status) {
  if (status != TACTUS_OK) exit((printf("%s (%s)\n", error.text, error.rule), 1));
}

int main(void) {
  tactus_scene_builder* builder;
  tactus_scene* scene; /* both ends declare the same */
  tactus_sender* sender;
  tactus_receiver* receiver;
  check(tactus_scene_builder_create(NULL, &builder, &error));
  check(tactus_scene_builder_rigid(builder, "cube", NULL, &error));
  check(tactus_scene_builder_build(builder, &scene, &error));
  check(tactus_sender_create(scene, NULL, &sender, &error));
  check(tactus_receiver_create(scene, NULL, &receiver, &error));

  size_t count = 0, bytes = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    const double t = (tick < 500 ? tick : 500) / 1000.0; /* s; at rest from 0.5 s on */
    const double x = 0.2 * t - 0.2 * t * t;              /* m */
    const double v = 0.2 - 0.4 * t;                      /* m/s */
    const tactus_rigid_sample cube = {.pose = {{x, 0, 0}, {1, 0, 0, 0}}, .velocity = {v, 0, 0}};
    const tactus_truth truth = {.size = sizeof truth, .objects = &cube, .object_count = 1};
    tactus_encoded encoded = {.size = sizeof encoded};
    check(tactus_sender_encode(sender, tick, &truth, &encoded, &error));
    for (size_t i = 0; i < encoded.packet_count; ++i) { /* mostly none: the receiver predicts */
      const tactus_packet* p = &encoded.packets[i];
      printf("tick %d: %u bytes\n", tick, p->bytes);
      count += 1, bytes += p->bytes; /* a network would be here */
      check(tactus_receiver_push(receiver, p->number, p->data, p->bytes, TACTUS_PACKET_TICK, NULL, &error));
    }
  }

  tactus_pose shown;
  check(tactus_receiver_poses(receiver, 999, 0, 1, &shown, NULL, &error));
  const double* x = shown.position;
  printf("%zu packets, %zu bytes; shown at tick 999: x %.4f m, y %.4f m, z %.4f m\n", count, bytes, x[0], x[1], x[2]);
  tactus_receiver_destroy(receiver);
  tactus_sender_destroy(sender);
  tactus_scene_destroy(scene);
  tactus_scene_builder_destroy(builder);
}
