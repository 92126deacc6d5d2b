// SPDX-License-Identifier: Apache-2.0
/// What a user of the installed library writes: one object, one packet, there and back.
#include <codec/rigid/rigid_encoder.h>
#include <codec/tactus.h>

#include <cstdio>

namespace {

const char* round_trip() {
  tactus::StreamHeader header;
  header.objects.push_back({.name = "cube", .dof = tactus::Dof::all, .initial = {}});

  auto encoder = tactus::RigidEncoder::create(header);
  auto decoder = tactus::RigidDecoder::create(header);
  if (!encoder || !decoder) return "the header is refused";

  const tactus::RigidSample truth{
      .pose = {.position = {0.25, -0.5, 1.0}, .rotation = {}}, .velocity = {0.1, 0, 0}, .angular_velocity = {}};
  const auto packet = encoder->encode(1, {&truth, 1}, {});
  if (!packet || packet->bytes.empty()) return "a jump of a metre yields no packet";
  if (!decoder->decode(packet->bytes)) return "the packet is refused";

  const tactus::Pose seen = tactus::to_pose(tactus::predict(decoder->objects()[0], 1, header), header.grid);
  if (tactus::norm(seen.position - truth.pose.position) > tactus::RigidTriggers{}.visual_position)
    return "the client sees another place";
  if (decoder->state_hash() != encoder->state_hash()) return "the ends hold different states";
  return nullptr;
}

}  // namespace

int main() {
  const char* complaint = round_trip();
  std::puts(complaint ? complaint : "one packet, there and back");
  return complaint ? 1 : 0;
}
