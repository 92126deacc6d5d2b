// SPDX-License-Identifier: Apache-2.0
/// Any bytes as displacements of a small mesh, touches, lost packets and settings: what the encoder takes stays inside its bounds on the
/// decoder's output (profile main), what it refuses changes nothing.
#include <optional>
#include <vector>

#include <tactus/deformable/decoder.h>
#include <tactus/deformable/encoder.h>
#include "tests/fuzz/motions.h"
#include "tests/fuzz/packets.h"
#include "tests/fuzz/strip.h"

namespace {

using namespace tactus;

void check_bounds(const StreamHeader& header, const DeformableThresholds& thresholds, DeformableDecoder& decoder,
                  std::int64_t tick, std::span<const Vec3> truth, const std::optional<SurfaceTouch>& touch) {
  const std::vector<double> bound = strip_bounds(header, thresholds, touch);
  const auto shown = decoder.displacements_at(tick);
  for (std::size_t v = 0; v < truth.size(); ++v) require(norm(to_metres(shown[v], header.grid.position) - truth[v]) <= bound[v]);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader in({data, size});
  const StreamHeader header = strip(in.u8());
  DeformableEncoderOptions options;
  options.thresholds = {1e-6 * in.u16(), std::nullopt, 1e-6 * in.u16()};
  if (const unsigned percent = in.u8()) options.thresholds.weber_fraction = 0.01 * percent;
  options.key_interval = 0.1 * in.u8();
  auto encoder = DeformableEncoder::create(header, 0, options).value();
  auto decoder = DeformableDecoder::create(header, 0).value();
  std::vector<Vec3> displacement(header.meshes[0].rest.size());
  for (std::int64_t tick = 0; in.ok(); tick += 1 + in.u8() % 4) {
    std::vector<Vec3> next = displacement;
    move(in, next);
    std::optional<SurfaceTouch> touch;
    const unsigned what = in.u8();
    if (what & 1) touch = SurfaceTouch{in.u8() % 23u, step(in, 1e-3), 0.1 * in.u16()};
    const std::uint64_t before = encoder.state_hash();
    const auto packet = encoder.encode(tick, next, touch);
    require(packet || (packet.error().code == Errc::invalid_argument && encoder.state_hash() == before));
    if (!packet) continue;
    displacement = next;
    if (!packet->bytes.empty()) require(decoder.decode(packet->bytes).has_value());
    const auto rest = encoder.encode_rest();
    const bool lost = what & 2 && !rest.bytes.empty();
    if (lost) encoder.forget_last();
    else if (!rest.bytes.empty()) require(decoder.decode(rest.bytes).has_value());
    require(lost || decoder.state_hash() == encoder.state_hash());
    if (header.meshes[0].profile == DeformableProfile::main && !lost)
      check_bounds(header, options.thresholds, decoder, tick, displacement, touch);
  }
  return 0;
}
