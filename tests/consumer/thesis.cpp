// SPDX-License-Identifier: Apache-2.0
/// A user of the component thesis: a mesh of its profile, a cube that a client interpolates, and the force that goes back. Without the component
/// the receiver refuses both.
#include <tactus/tactus.h>
#include <tactus/thesis/force_signal.h>
#include <tactus/thesis/thesis.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <vector>

namespace {

const char* send_and_receive() {
  const tactus::TriMesh sheet{.vertices = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}}, .triangles = {{0, 1, 2}}};
  tactus::SceneBuilder builder;
  builder.rigid("cube")
      .rigid_profile(tactus::RigidProfile::thesis)
      .deformable("sheet", sheet, {.profile = tactus::DeformableProfile::thesis});
  const auto scene = builder.build({.thesis = &tactus::thesis_component});
  if (!scene) return "the scene is refused";
  const auto declaration = tactus::write_scene(**scene);
  if (!declaration) return "the declaration cannot be written";
  if (const auto without = tactus::parse_scene(*declaration); without || std::string_view(without.error().rule) != "R-DEF-2")
    return "the declaration is not refused without the component";
  const auto declared = tactus::parse_scene(*declaration, {.thesis = &tactus::thesis_component});
  if (!declared) return "the declaration is refused";

  const tactus::ReceiverOptions linear{.replica = {.interpolation = tactus::Interpolation::linear}, .limits = {}};
  auto sender = tactus::Sender::create(*scene);
  auto receiver = tactus::Receiver::create(declared->scene, linear);
  if (!sender || !receiver) return "there is no sender or no receiver";
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    tactus::RigidSample cube;
    cube.pose.position = {0.001 * static_cast<double>(tick), 0, 0};
    const std::vector<float> pushed(9, -0.0001F * static_cast<float>(tick));
    const tactus::DeformableTruth shape{pushed, {}};
    const auto packets = sender->encode(tick, {.objects = {&cube, 1}, .deformables = {&shape, 1}});
    if (!packets) return "a tick is refused";
    for (const tactus::Packet& packet : *packets)
      if (!receiver->push(packet.number, packet.bytes)) return "a packet is refused";
    if (std::abs(receiver->displacements(0, tick)[2] - pushed[2]) > 3e-4) return "the client sees the sheet elsewhere";
  }

  auto force = tactus::ForceSender::create({}, 1000);
  if (!force) return "there is no sender of forces";
  const auto sample = force->encode(0, {0, 0, 2});
  tactus::ForceReceiver arriving(1000);
  if (!sample || sample->empty() || !arriving.push(*sample)) return "the force is not sent";
  return tactus::norm(arriving.force(0) - tactus::Vec3{0, 0, 2}) < 1e-3 ? nullptr : "another force arrives";
}

}  // namespace

int main() {
  if (const char* why = send_and_receive()) {
    std::puts(why);
    return 1;
  }
  std::puts("a client with component thesis shows a mesh of its profile and interpolates");
  return 0;
}
