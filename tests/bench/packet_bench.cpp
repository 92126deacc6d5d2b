// SPDX-License-Identifier: Apache-2.0
/// Cost of packet mechanics alone: numbers, baselines, acknowledgements and refusals below a codec whose payload is its head.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include <tactus/packet/substream_decoder.h>
#include <tactus/packet/substream_encoder.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

struct TickState {
  std::int64_t tick = 0;
};

class HeadEncoder {
 public:
  using State = TickState;
  Result<Payload> encode(const EncodeRequest<State>& request, std::span<std::uint8_t> out) noexcept {
    std::memcpy(out.data(), &request.head, sizeof request.head);
    return Payload{.size = sizeof request.head, .reason = Reason::visual, .updates = 1};
  }
  void commit(const State& base, State& next) noexcept { next = base; }
};

class HeadDecoder {
 public:
  using State = TickState;
  static constexpr const char* kTickRule = "R-RIG-1";
  Result<PacketHead> read_head(std::span<const std::uint8_t> payload) noexcept {
    PacketHead head;
    std::memcpy(&head, payload.data(), sizeof head);
    return head;
  }
  Result<void> read_body(const State&, std::int64_t, DecodedPacket&) noexcept { return {}; }
  void commit(const State& base, State& next) noexcept { next = base; }
  std::uint64_t bit() const noexcept { return 0; }
};

SharedScene scene_of_span(std::uint8_t span) {
  SceneSpec spec = testing::spec_of(1);
  spec.baseline_span = span;
  return testing::shared(std::move(spec));
}

/// A packet per tick, there and back. Acknowledgements arrive `delay` packets late; 0: each packet builds on the one before.
void send_and_accept(benchmark::State& state) {
  const auto delay = static_cast<std::size_t>(state.range(0));
  const SharedScene scene = scene_of_span(delay == 0 ? 1 : 64);
  SenderPolicy policy;
  policy.key_interval = 0;
  policy.baseline = delay == 0 ? Baseline::previous : Baseline::acknowledged;
  SubstreamEncoder<HeadEncoder> encoder(*scene, policy, 0, 64, 1, TickState{});
  SubstreamDecoder<HeadDecoder> decoder(*scene, {}, TickState{});
  std::vector<std::uint64_t> sent(64);
  std::int64_t tick = 0;
  for (auto _ : state) {
    const Packet packet = encoder.encode(++tick, Layer::all).value();
    if (const auto decoded = decoder.decode(packet.number, packet.bytes); !decoded) {
      state.SkipWithError(decoded.error().rule);
      break;
    }
    const auto at = static_cast<std::size_t>(tick);
    sent[at % sent.size()] = packet.number;
    if (delay > 0 && at > delay) encoder.acknowledge(sent[(at - delay) % sent.size()]);
  }
}
BENCHMARK(send_and_accept)->ArgName("delay")->Arg(0)->Arg(1)->Arg(40);

/// A packet that arrives a second time (R-PKT-5).
void refuse_late(benchmark::State& state) {
  const SharedScene scene = scene_of_span(1);
  SubstreamEncoder<HeadEncoder> encoder(*scene, {}, 0, 64, 1, TickState{});
  SubstreamDecoder<HeadDecoder> decoder(*scene, {}, TickState{});
  const Packet packet = encoder.encode(1, Layer::all).value();
  if (!decoder.decode(packet.number, packet.bytes)) state.SkipWithError("the first one is refused");
  std::span<const std::uint8_t> bytes = packet.bytes;
  for (auto _ : state) {
    benchmark::DoNotOptimize(bytes);
    if (decoder.decode(packet.number, bytes)) {
      state.SkipWithError("a late packet is accepted");
      break;
    }
  }
}
BENCHMARK(refuse_late);

}  // namespace
}  // namespace tactus
