// SPDX-License-Identifier: Apache-2.0
/// Cost of the range coder below every packet, per binary decision.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <tactus/base/range_coder.h>

namespace tactus {
namespace {

constexpr std::size_t kBits = 4096;  // a fifth of them 1

std::vector<std::uint32_t> random_bits() {
  std::mt19937 random(1);
  std::vector<std::uint32_t> bits(kBits);
  for (auto& b : bits) b = random() % 5 == 0;
  return bits;
}

std::size_t encode(const std::vector<std::uint32_t>& bits, std::span<std::uint8_t> out) {
  RangeEncoder encoder(out);
  BitModel model;
  for (const std::uint32_t b : bits) encoder.bit(model, b);
  return encoder.finish();
}

void range_encode(benchmark::State& state) {
  const std::vector<std::uint32_t> bits = random_bits();
  std::vector<std::uint8_t> out(kBits);
  for (auto _ : state) benchmark::DoNotOptimize(encode(bits, out));
  state.SetItemsProcessed(static_cast<std::int64_t>(kBits) * state.iterations());
}
BENCHMARK(range_encode);

void range_decode(benchmark::State& state) {
  std::vector<std::uint8_t> out(kBits);
  const std::span coded = std::span(out).first(encode(random_bits(), out));
  for (auto _ : state) {
    RangeDecoder decoder(coded);
    BitModel model;
    std::uint32_t ones = 0;
    for (std::size_t i = 0; i < kBits; ++i) ones += decoder.bit(model);
    benchmark::DoNotOptimize(ones);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(kBits) * state.iterations());
}
BENCHMARK(range_decode);

}  // namespace
}  // namespace tactus
