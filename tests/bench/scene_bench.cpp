// SPDX-License-Identifier: Apache-2.0
/// Cost of scene declarations and files, and of the range coder below every packet.
#include <benchmark/benchmark.h>

#include <sstream>

#include <tactus/base/range_coder.h>
#include <tactus/file/stream_file.h>
#include <tactus/scene/scene_syntax.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

void header_parse(benchmark::State& state) {
  const auto bytes = write_scene(*testing::scene_of(static_cast<std::size_t>(state.range(0)))).value();
  for (auto _ : state) benchmark::DoNotOptimize(parse_scene(bytes));
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes.size()) * state.iterations());
}
BENCHMARK(header_parse)->Arg(1)->Arg(1000);

void file_read(benchmark::State& state) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *testing::scene_of(1)).value();
  const std::vector<std::uint8_t> packet(12, 0x5a);
  for (std::int64_t tick = 0; tick < 10000; ++tick) (void)writer.add(tick, packet, tick == 0);
  (void)writer.finish();
  const std::string text = out.str();
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  for (auto _ : state) {
    auto reader = StreamFileReader::open(bytes).value();
    while (reader.next().value()) {
    }
  }
  state.SetItemsProcessed(10000 * state.iterations());
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}
BENCHMARK(file_read)->Unit(benchmark::kMicrosecond);

void range_bits(benchmark::State& state) {
  std::vector<std::uint8_t> out(4096);
  std::mt19937 random(1);
  std::vector<std::uint32_t> bits(4096);
  for (auto& b : bits) b = random() % 5 == 0;
  for (auto _ : state) {
    RangeEncoder encoder(out);
    BitModel model;
    for (const std::uint32_t b : bits) encoder.bit(model, b);
    benchmark::DoNotOptimize(encoder.finish());
  }
  state.SetItemsProcessed(4096 * state.iterations());
}
BENCHMARK(range_bits);

}  // namespace
}  // namespace tactus
