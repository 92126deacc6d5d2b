// SPDX-License-Identifier: Apache-2.0
/// A receiver of one cube, as small as it gets: what the program contains is looked at.
#include <cstdint>
#include <cstdio>
#include <span>

#include <tactus/receiver.h>
#include <tactus/scene/scene_builder.h>

int main(int, char** arguments) {
  const auto scene = tactus::SceneBuilder().rigid("cube").build();
  if (!scene) return 1;
  auto receiver = tactus::Receiver::create(*scene);
  if (!receiver) return 1;
  const std::span packet(reinterpret_cast<const std::uint8_t*>(arguments), 8);  // as if it had come from a network
  const bool is_packet = receiver->push(1, packet).has_value();
  const tactus::RigidPose shown = receiver->replica().pose(0, 1);
  std::printf("%d %d\n", static_cast<int>(is_packet), shown.position[0]);
  return 0;
}
