// SPDX-License-Identifier: Apache-2.0
/// Cost of stream files, per file of 10 000 packets of 12 bytes.
#include <benchmark/benchmark.h>

#include <sstream>

#include <tactus/file/stream_file.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

constexpr std::int64_t kPackets = 10000;

void file_write(benchmark::State& state) {
  const std::vector<std::uint8_t> packet(12, 0x5a);
  const SharedScene scene = testing::scene_of(1);
  for (auto _ : state) {
    std::ostringstream out;
    auto writer = StreamFileWriter::create(out, *scene).value();
    for (std::int64_t tick = 0; tick < kPackets; ++tick)
      (void)writer.add(tick, static_cast<std::uint64_t>(tick + 1), packet, tick % 5000 == 0);
    (void)writer.finish();
    benchmark::DoNotOptimize(writer.bytes());
  }
  state.SetItemsProcessed(kPackets * state.iterations());
}
BENCHMARK(file_write)->Unit(benchmark::kMicrosecond);

void file_read(benchmark::State& state) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *testing::scene_of(1)).value();
  const std::vector<std::uint8_t> packet(12, 0x5a);
  for (std::int64_t tick = 0; tick < kPackets; ++tick)
    (void)writer.add(tick, static_cast<std::uint64_t>(tick + 1), packet, tick == 0);
  (void)writer.finish();
  const std::string text = out.str();
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  for (auto _ : state) {
    auto reader = StreamFileReader::open(bytes).value();
    while (reader.next().value()) {
    }
  }
  state.SetItemsProcessed(kPackets * state.iterations());
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}
BENCHMARK(file_read)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tactus
