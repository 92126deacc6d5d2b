// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a stream file: decoders of every part that its header declares and a client, fed to the end; seek, and again.
#include <algorithm>
#include <vector>

#include <tactus/client/replica.h>
#include <tactus/deformable/decoder.h>
#include <tactus/file/stream_file.h>
#include <tactus/packet/substream.h>
#include <tactus/rigid/rigid_decoder.h>
#include "tests/fuzz/packets.h"

namespace {

using namespace tactus;

constexpr DecodeLimits kLimits{.objects = 256, .vertices = 2048};  // decoding takes vertices x packets

/// Packets until the end or the first broken record.
std::size_t play(StreamFileReader& reader) {
  const StreamHeader& header = reader.header();
  auto rigid = RigidDecoder::create(header, kLimits).value();
  auto replica = Replica::create(header, {.interpolation = Interpolation::linear}).value();
  PartJoiner joiner(header);
  std::vector<DeformableDecoder> meshes;
  for (std::size_t i = 0; i < header.meshes.size(); ++i) meshes.push_back(DeformableDecoder::create(header, i, kLimits).value());
  for (std::size_t packets = 0;; ++packets) {
    const std::uint64_t before = reader.position();
    const auto record = reader.next();
    require(reader.position() >= before && (record || record.error().rule[0] == 'R'));
    if (!record || !*record) return packets;
    const auto part = split_part(header, (*record)->bytes);
    if (!part) continue;
    if (part->bytes.size() <= max_packet_size(header))
      require(std::ranges::equal(joiner.join(part->part, part->bytes), (*record)->bytes));
    if (part->part > 0) {
      DeformableDecoder& mesh = meshes[part->part - 1];
      if (const auto packet = decode_packet(mesh, part->bytes)) (void)mesh.displacements_at(packet->tick + 3);
    } else if (const auto packet = decode_packet(rigid, part->bytes)) {
      replica.apply(*packet, rigid.objects(), packet->tick + 2);
      (void)replica.pose_hash(packet->tick + 5);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> exact(data, data + size);
  auto reader = StreamFileReader::open(exact, kLimits);
  if (!reader) return 0;
  const std::size_t packets = play(*reader);
  for (const std::int64_t tick : {0, 1000, 1 << 30})
    if (reader->seek(tick)) require(play(*reader) <= packets + size);
  return 0;
}
