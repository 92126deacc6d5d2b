// SPDX-License-Identifier: Apache-2.0
/// Any bytes as forces: what a sender takes stays inside its deadband at the receiver, what it refuses changes nothing; and any bytes as
/// samples of a force.
#include <algorithm>
#include <bit>
#include <cmath>

#include <tactus/base/bytes.h>
#include <tactus/thesis/force_signal.h>
#include "tests/fuzz/require.h"

namespace {

using namespace tactus;

/// Of any bits, and of forces that a hand feels.
double newtons(ByteReader& in) {
  const std::uint8_t kind = in.u8();
  if (kind < 4) return std::bit_cast<double>(in.u64());
  return 1e-3 * static_cast<std::int16_t>(in.u16()) * (kind % 4 == 0 ? 100 : 1);
}

void forces(ByteReader& in) {
  ForceCoding coding;
  coding.rule = static_cast<ForceRule>(in.u8() % 2);
  coding.predictor = static_cast<ForcePredictor>(in.u8() % 2);
  coding.weber_fraction = 0.002 * in.u8();
  coding.floor = 1e-3 * in.u8();
  const std::uint32_t rate = 1 + in.u16();
  auto sender = ForceSender::create(coding, rate);
  if (!sender) return;
  ForceReceiver receiver(rate);
  for (std::int64_t tick = 0; in.ok(); tick += in.u8() % 16) {
    const Vec3 force{newtons(in), newtons(in), newtons(in)};
    const ForceState before = sender->state();
    const auto sample = sender->encode(tick, force);
    if (!sample) {
      require(sample.error().code == Errc::invalid_argument && sender->state() == before);
      continue;
    }
    if (!sample->empty()) require(receiver.push(*sample).has_value());
    require(receiver.state() == sender->state());
    const Vec3 shown = receiver.force(tick);
    const double error = norm(force - shown), rounding = std::ldexp(1.0, -static_cast<int>(kForceExp));
    if (coding.rule == ForceRule::weber)
      require(error <= std::max(coding.weber_fraction * std::max(norm(shown), coding.floor), rounding) * (1 + 1e-9));
    else require(error <= std::max(0.1 * (norm(shown) + 1e-5), rounding) * (1 + 1e-9));
  }
}

void hostile_samples(ByteReader& in) {
  ForceReceiver receiver(1 + in.u16());
  while (in.ok()) {
    const ForceState before = receiver.state();
    const auto sample = in.bytes(std::min<std::uint64_t>(in.u8() % 48, in.remaining()));
    if (!receiver.push(sample)) require(receiver.state() == before);
    const Vec3 force = receiver.force(static_cast<std::int64_t>(in.u16()));
    require(is_finite(force));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader in({data, size});
  if (in.u8() % 2 == 0) forces(in);
  else hostile_samples(in);
  return 0;
}
