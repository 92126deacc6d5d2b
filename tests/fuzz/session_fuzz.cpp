// SPDX-License-Identifier: Apache-2.0
/// A session in any state, and datagrams whose check holds, whatever is in them: the input is a row of (operation, size, its bytes).
/// Nothing long is answered, to an address that is not validated no more than it sent, and what an end sends can be read.
#include <algorithm>
#include <cstring>

#include <tactus/session/device_signal.h>
#include "tests/fuzz/session_world.h"

namespace tactus::testing {
namespace {

constexpr int kMostScenes = 6, kMostJoins = 20;  // for the time they take

struct Play : World {
  int scenes = 0, joins = 0;

  void step(std::uint8_t op, Input bytes) {
    std::array<double, 8> v{};
    if (!bytes.empty()) std::memcpy(v.data(), bytes.data(), std::min(sizeof v, bytes.size()));
    const Direction direction = op & 16u ? Direction::up : Direction::down;
    const std::uint64_t peer = direction == Direction::up && (op & 32u) ? 2 : 1;
    const Bytes& newest = direction == Direction::up ? up : down;
    const unsigned ahead = (op >> 6) + 1u, first = bytes.empty() ? 0 : bytes[0];
    const std::vector<RigidSample> samples(scene->objects.size(),
                                           {{{v[0], v[1], v[2]}, {}}, {v[3], v[4], v[5]}, {v[6], v[7], 0}});
    const std::vector<float> shape(12, static_cast<float>(v[3]));
    const std::vector<DeformableTruth> shapes(scene->deformables.size(), {shape, SurfaceTouch{first % 2, 1, 500}});
    const auto contact = op & 16u ? std::optional(DeviceContact{{v[3], v[4], v[5]}, 500}) : std::nullopt;
    const unsigned what = op % 16;
    if (what == 0) now += first * std::uint64_t{first} * 50;
    else if (what == 1) now += first * std::uint64_t{50'000};
    else if (what == 2) {
      const auto device = server.device(0, now += 1000);
      const Contact pushes{ContactKind::surface, 0, {v[3], v[4], v[5]}, {0, 0, 1}, device.value_or(DeviceSample{}).position, 500};
      const bool touches = scene->driven && device && is_finite(pushes.point);
      static_cast<void>(server.submit(now, tick++, {samples, {&pushes, touches ? 1u : 0u}, shapes}));
    } else if (what == 3) static_cast<void>(client.submit(now, {{v[0], v[1], v[2]}, {}, {}, first, 0}, contact));
    else if (what < 6) drain(what == 4);
    else if (what < 8) hostile(Bytes(bytes.begin(), bytes.end()), what == 7, direction, peer);
    else if (what < 10) hostile(numbered(newest, ahead, what - 7, bytes), false, direction, peer);
    else if (what == 10) hostile(changed(newest, ahead, bytes), false, direction, peer);
    else if (what == 11) hostile(without_check(newest), false, direction, peer);  // again
    else if (what == 12 && ++joins < kMostJoins) to_server(2, join);
    else if (what == 13) op & 16u ? client.close() : server.close(first % 2, LeaveReason::bye);
    else if (what == 14 && ++joins < kMostJoins) client.open(now, first);
    else if (what == 15 && ++scenes < kMostScenes) replace(kScenes[first % 3]);
    server.handle_timeout(now);
    client.handle_timeout(now);
    if (what > 5) drain(op & 16u);
  }
};

}  // namespace
}  // namespace tactus::testing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tactus::testing::Play play;
  play.client.open(play.now, 1);
  for (std::span<const std::uint8_t> left(data, size); left.size() >= 3;) {
    const std::size_t bytes = std::min<std::size_t>(left[1] + 256u * (left[2] % 8), left.size() - 3);
    play.step(left[0], left.subspan(3, bytes));
    left = left.subspan(3 + bytes);
  }
  return 0;
}
