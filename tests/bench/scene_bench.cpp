// SPDX-License-Identifier: Apache-2.0
/// Cost of scene declarations.
#include <benchmark/benchmark.h>

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

}  // namespace
}  // namespace tactus
