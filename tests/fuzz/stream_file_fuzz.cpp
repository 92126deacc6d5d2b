// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a stream file: read to the end, decode every packet, seek, read again.
#include <cstdlib>
#include <vector>

#include "codec/rigid/rigid_decoder.h"
#include "codec/stream/file.h"

namespace {

using namespace tactus;

/// Packets until the end or the first error; a refused packet must leave the decoder as it was.
std::size_t read_all(StreamFileReader& reader, RigidDecoder& decoder) {
  std::size_t packets = 0;
  for (;;) {
    const std::uint64_t before = reader.position();
    const auto packet = reader.next();
    if (!packet) {
      if (packet.error().rule[0] != 'R' || reader.position() < before) std::abort();
      return packets;
    }
    if (!*packet) return packets;
    if (reader.position() <= before) std::abort();
    const std::uint64_t hash = decoder.state_hash();
    if (!decoder.decode((*packet)->bytes) && decoder.state_hash() != hash) std::abort();
    ++packets;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> exact(data, data + size);
  auto reader = StreamFileReader::open(exact);
  if (!reader) return 0;
  auto decoder = RigidDecoder::create(reader->header());
  if (!decoder) std::abort();
  const std::size_t packets = read_all(*reader, *decoder);
  for (const std::int64_t tick : {0, 1000, 1 << 30}) {
    if (!reader->seek(tick)) continue;
    auto fresh = RigidDecoder::create(reader->header());
    if (read_all(*reader, *fresh) > packets + size) std::abort();
  }
  return 0;
}
