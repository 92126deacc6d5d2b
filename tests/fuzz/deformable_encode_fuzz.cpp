// SPDX-License-Identifier: Apache-2.0
/// Any bytes as displacements of a small deformable object, touches, lost packets and settings: what the sender takes stays inside its
/// bounds at the receiver (profile main), what breaks a rule is the last that broke none, and a packet that builds on an acknowledged state decodes.
#include <algorithm>
#include <optional>
#include <vector>

#include <tactus/deformable/displacement.h>
#include <tactus/receiver.h>
#include <tactus/sender.h>
#include "tests/fuzz/motions.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/strip.h"

namespace {

using namespace tactus;

constexpr std::size_t kSubstream = 1;

void check_bounds(const DeformableThresholds& thresholds, Receiver& receiver, std::int64_t tick, const DeformableTruth& truth) {
  const Scene& scene = *receiver.scene();
  const std::vector<double> bound = strip_bounds(scene, thresholds, truth.touch);
  const auto shown = receiver.replica().displacements(0, tick);
  const float* u = truth.displacements.data();
  for (std::size_t v = 0; v < shown.size(); ++v, u += 3)
    require(norm(to_metres(shown[v], scene.grid.position) - Vec3{u[0], u[1], u[2]}) <= bound[v]);
}

/// What happens to the packets of a tick.
struct Fate {
  bool drop_visual = false;  ///< which the sender knows
  bool lose = false, acknowledge = false;
};

/// Both ends, which hold the same state unless the last packet was lost.
struct Ends {
  Sender sender;
  Receiver receiver;
  bool agree = true;

  /// False: the visual packet was dropped, bounds need not hold.
  bool deliver(std::span<const Packet> packets, const Fate& fate) {
    for (const Packet& packet : packets) {
      require(packet.substream == kSubstream);
      if (packet.layer == Layer::visual && fate.drop_visual) {
        sender.forget_last(kSubstream);
        return false;
      }
      agree = !fate.lose;
      if (fate.lose) continue;
      require(receiver.push(packet.number, packet.bytes).has_value());
      if (fate.acknowledge) sender.acknowledge(packet.substream, packet.number);
    }
    return true;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader in({data, size});
  const std::uint8_t choice = in.u8();
  const SharedScene scene = Scene::create(strip(choice), kStripLimits).value();
  SenderOptions options;
  const bool has_answers = (choice & 224) == 96;  // the receiver's: any packet may be lost, but not of a layered object
  if (has_answers) options.policy.baseline = Baseline::acknowledged;
  DeformableThresholds& thresholds = options.deformable.thresholds;
  thresholds = {1e-6 * in.u16(), std::nullopt, 1e-6 * in.u16()};
  if (const unsigned percent = in.u8()) thresholds.weber_fraction = std::min(0.01 * percent, 1.0);
  options.policy.key_interval = 0.1 * in.u8();
  Ends ends{Sender::create(scene, options).value(), Receiver::create(scene).value()};
  std::vector<float> displacements(3 * scene->deformables[0].rest.size());
  for (std::int64_t tick = 0; in.ok(); tick += 1 + in.u8() % 4) {
    std::vector<float> next = displacements;
    move(in, next);
    DeformableTruth truth{next, {}};
    const unsigned what = in.u8();
    if (what & 1) truth.touch = SurfaceTouch{in.u8() % 23u, step(in, 1e-3), 0.1 * in.u16()};
    const auto packets = ends.sender.encode(tick, {.deformables = {&truth, 1}});
    require(packets.has_value());
    for (const HeldPart& held : ends.sender.held()) {
      if (held.part == TruthPart::touch) truth.touch.reset();
      else next = displacements;
    }
    displacements = next;
    const Fate fate{(what & 2) != 0, has_answers && (what & 4), has_answers && (what & 8)};
    const bool complete = ends.deliver(*packets, fate);
    if (!ends.agree) continue;
    require(ends.receiver.state_hash(kSubstream) == ends.sender.state_hash(kSubstream));
    if (complete && scene->deformables[0].profile == DeformableProfile::main)
      check_bounds(thresholds, ends.receiver, tick, truth);
  }
  return 0;
}
