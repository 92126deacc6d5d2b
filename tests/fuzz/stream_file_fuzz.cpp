// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a stream file: a receiver, fed to the end, that shows packets in their ticks and one that shows them late; a player; seek, and again.
#include <limits>
#include <vector>

#include <tactus/player.h>
#include <tactus/thesis/thesis.h>
#include "tests/fuzz/packets.h"

namespace {

using namespace tactus;

constexpr DecodeLimits kLimits{
    .objects = 256, .vertices = 2048, .thesis = &thesis_component};  // decoding takes vertices x packets
constexpr std::int64_t kDelay = 2;                                   // ticks

struct Heard {
  std::size_t records = 0;
  std::size_t accepted = 0;  ///< packets, before the first that is refused or that comes in another tick than its own
};

/// Records until the end or the first broken one.
Heard listen(StreamFileReader& reader, bool is_late) {
  const Interpolation at_once = reader.scene()->is_smoothed ? Interpolation::none : Interpolation::linear;
  const Interpolation interpolation = is_late ? Interpolation::playout : at_once;
  const ReceiverOptions options{.replica = {.interpolation = interpolation}, .limits = kLimits};
  auto receiver = Receiver::create(reader.scene(), options).value();
  Heard out;
  for (bool sound = true;; ++out.records) {
    const std::uint64_t before = reader.position();
    const auto record = reader.next();
    require(reader.position() >= before && (record || record.error().rule[0] == 'R'));
    if (!record || !*record) return out;
    const std::int64_t tick = (*record)->tick;
    const auto now = is_late ? std::optional(tick + kDelay) : std::nullopt;
    const auto packet = push_packet(receiver, (*record)->number, (*record)->bytes, now);
    sound = sound && packet && packet->tick == tick;
    if (sound) ++out.accepted;
    if (!packet) continue;
    if (packet->loads > 0) (void)receiver.load(0, packet->tick + 1);
    else if (packet->substream > 0) (void)receiver.replica().displacements(packet->substream - 1, packet->tick + 3);
    else (void)receiver.replica().pose_hash(packet->tick + 5);
  }
}

/// Packets played before the first that is refused.
std::size_t play(std::span<const std::uint8_t> file) {
  auto player = Player::open(file, {.replica = {}, .limits = kLimits}).value();
  for (std::size_t packets = 0;; ++packets) {
    const auto played = player.play(std::numeric_limits<std::int64_t>::max());
    if (!played) require(played.error().rule[0] == 'R' && played.error().bit_offset <= 8 * file.size());
    if (!played || !*played) return packets;
    require((*played)->offset + (*played)->bytes <= file.size());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> exact(data, data + size);
  auto reader = StreamFileReader::open(exact, kLimits);
  if (!reader) return 0;
  const Heard heard = listen(*reader, false);
  require(play(exact) == heard.accepted);
  for (const std::int64_t tick : {0, 1000, 1 << 30})
    if (reader->seek(tick)) require(listen(*reader, true).records <= heard.records + size);
  return 0;
}
