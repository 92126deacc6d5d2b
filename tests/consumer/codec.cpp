// SPDX-License-Identifier: Apache-2.0
/// What a user of the installed library writes: a scene of a cube and a strip that is touched, a sender, a receiver, and the packets
/// between them, one of which the network drops.
#include <tactus/tactus.h>

#include <cstdio>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace {

/// Both ends declare the same scene.
auto declare() {
  const tactus::TriMesh strip{.vertices = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0.01, 0.01, 0}, {0, 0.02, 0}, {0.01, 0.02, 0}},
                              .triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}}};
  tactus::SceneBuilder scene;
  scene.rigid("cube").deformable("strip", strip, {.rings = 0, .layered = true});
  scene.baselines(2);  // so that one packet may be dropped
  return std::move(scene).build();
}

/// The client's replica is where the server says that things are.
const char* look(tactus::Receiver& receiver, std::int64_t tick, const tactus::Truth& truth) {
  const tactus::Pose cube = receiver.pose(0, tick);
  if (tactus::norm(cube.position - truth.objects[0].pose.position) > tactus::RigidTriggers{}.visual_position)
    return "the client sees the cube elsewhere";
  const auto shown = receiver.displacements(0, tick), u = truth.deformables[0].displacements;
  if (tactus::norm(tactus::Vec3{shown[0], shown[1], shown[2]} - tactus::Vec3{u[0], u[1], u[2]}) >
      tactus::DeformableThresholds{}.visual)
    return "the client sees the touched corner elsewhere";
  return nullptr;
}

const char* send_and_receive() {
  const auto scene = declare();
  if (!scene) return "the scene is refused";
  auto sender = tactus::Sender::create(*scene);
  auto receiver = tactus::Receiver::create(*scene);
  if (!sender || !receiver) return "there is no sender or no receiver";

  std::size_t haptic = 0, dropped = 0;
  for (std::int64_t tick = 1; tick <= 3; ++tick) {
    tactus::RigidSample cube;
    cube.pose.position = {0.25, -0.5, 0.1 * static_cast<double>(tick)};
    const std::vector<float> pushed(18, -0.001F * static_cast<float>(tick));  // every vertex
    const tactus::DeformableTruth strip{pushed, tactus::SurfaceTouch{.triangle = 0, .force = 1, .stiffness = 500}};
    const tactus::Truth truth{.objects = {&cube, 1}, .deformables = {&strip, 1}};

    const auto packets = sender->encode(tick, truth);
    if (!packets) return "the truth is refused";
    for (const tactus::Packet& packet : *packets) {
      haptic += packet.layer == tactus::Layer::haptic ? 1 : 0;
      if (tick == 2 && packet.layer == tactus::Layer::visual) {  // the network is slow: what is not touched can do without
        sender->forget_last(packet.substream);
        ++dropped;
      } else if (const auto decoded = receiver->push(packet.number, packet.bytes); decoded) {
        sender->acknowledge(decoded->substream, decoded->number);
      } else {
        return advice(decoded.error()) == tactus::Advice::request_key ? "a key packet is needed" : "a packet is refused";
      }
    }
    if (const char* complaint = look(*receiver, tick, truth)) return complaint;
  }
  if (haptic != 3 || dropped != 1) return "pushes of a millimetre yield other packets";
  for (std::size_t substream = 0; substream < 2; ++substream)
    if (receiver->state_hash(substream) != sender->state_hash(substream)) return "the ends hold different states";
  return nullptr;
}

/// Also where this file is compiled with -ffast-math.
const char* hold_what_is_no_number() {
  const auto scene = tactus::SceneBuilder().rigid("cube").build();
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  std::vector<tactus::RigidSample> wrong(4);
  wrong[0].pose.position.x = nan;
  wrong[1].pose.rotation.w = nan;
  wrong[2].pose.position.x = infinite;
  wrong[3].velocity.x = nan;
  for (const tactus::RigidSample& sample : wrong) {
    auto sender = tactus::Sender::create(*scene);
    if (!sender->encode(0, {.objects = {&sample, 1}})) return "NaN or infinity stops the others";
    if (sender->held().size() != 1 || std::string_view(sender->held()[0].rule) != "R-API-1") return "NaN or infinity is taken";
  }
  return nullptr;
}

}  // namespace

int main() {
  const char* complaint = send_and_receive();
  if (complaint == nullptr) complaint = hold_what_is_no_number();
  std::puts(complaint ? complaint : "packets of a cube and of a strip in layers, there and back");
  return complaint ? 1 : 0;
}
