// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a trace, coded with its contacts and compared with what its client shows: what the encoders take stays inside their
/// bounds, as `compare` measures them.
#include <vector>

#include <tactus/metrics/compare.h>
#include <tactus/metrics/deformable_errors.h>
#include <tactus/rigid/rigid_encoder.h>
#include <tactus/trace/trace_file.h>
#include "tests/fuzz/packets.h"

namespace {

using namespace tactus;

constexpr int kMaxFrames = 500;

struct Mesh {
  DeformableLink link;
  DeformableErrors fidelity;

  void look(std::size_t number, const TraceFrame& frame) {
    const auto touch = touch_of(frame, number);
    const auto packets = link.encode(frame.tick, frame.meshes[number].displacements, touch);
    if (!packets) return;
    for (const EncodedDeformablePacket& packet : *packets) require(packet.bytes.empty() || link.decode(packet.bytes));
    fidelity.add(frame.meshes[number].displacements, link.shown(frame.tick), touch);
    require(fidelity.worst_ratio() <= 1);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto reader = TraceReader::open_memory({data, size});
  TraceFrame frame;
  if (!reader || !reader->next(frame).value_or(false)) return 0;
  const auto header = stream_header(reader->info(), frame);
  if (!header) return 0;
  auto encoder = RigidEncoder::create(*header).value();
  auto decoder = RigidDecoder::create(*header).value();
  ErrorMetrics rigid(reader->info(), RigidTriggers{});
  std::vector<Mesh> meshes;
  for (std::size_t i = 0; i < header->meshes.size(); ++i)
    meshes.push_back({DeformableLink::create(*header, i, {}).value(),
                      {reader->info().meshes[i].rest, {}, header->meshes[i].rings, header->grid.position}});
  std::vector<Pose> shown(header->objects.size());
  for (int i = 0; i < kMaxFrames; ++i) {
    std::vector<Contact> contacts;
    for (const UserSample& user : frame.users) contacts.push_back(user.contact);
    const auto packet = encoder.encode(frame.tick, frame.objects, contacts);
    if (packet && !packet->bytes.empty()) require(decoder.decode(packet->bytes).has_value());
    for (std::size_t k = 0; k < shown.size(); ++k)
      shown[k] = to_pose(predict(decoder.objects()[k], frame.tick, *header), header->grid);
    if (packet) rigid.add(frame, shown);
    require(rigid.position().ticks_over() + rigid.rotation().ticks_over() + rigid.force().ticks_over() == 0);
    for (std::size_t m = 0; m < meshes.size(); ++m) meshes[m].look(m, frame);
    if (!reader->next(frame).value_or(false)) break;
  }
  return 0;
}
