// SPDX-License-Identifier: Apache-2.0
/// Make spec/tables/deformable-start-models.csv from stream files of one deformable object each, profile main.
///   train_deformable_start_models a.tct b.tct ... > deformable-start-models.csv
/// The residuals of a vertex count three times, with the axes turned: the surfaces of these streams face z, those of others do not.
/// Every packet has the same weight; those in layers count for the choice of the layer only. Only streams whose packets build on the packet before or on the initial state.
#include <algorithm>
#include <cstddef>
#include <utility>

#include <tactus/deformable/deformable_decoder.h>
#include "tests/tools/start_models.h"

namespace tactus {

/// What MainReader decodes a residual with, if it decodes with a CountingDecoder.
inline void code_residual(CountingDecoder& coder, MainModels& models, const VertexContext& context, AxisContexts axes,
                          Vec3i& residual) noexcept {
  code_residual<CountingDecoder>(coder, models, context, axes, residual);
  CountingEncoder again = coder.again();
  Vec3i turned = residual;
  for (int turn = 1; turn < 3; ++turn) {
    std::rotate(axes.begin(), axes.begin() + 1, axes.end());
    std::rotate(turned.begin(), turned.begin() + 1, turned.end());
    code_residual(again, models, context, axes, turned);
  }
}

}  // namespace tactus

namespace {

using namespace tactus;

template <class Packets>
bool count_file(const Scene& scene, const Packets& packets, Counts& total) {
  const bool fits = scene.moving().empty() && scene.deformables.size() == 1;
  if (!fits || scene.deformables[0].profile != DeformableProfile::main) return false;
  const DeformableObject& object = scene.deformables[0];
  MainReader reader(object, std::make_shared<const VertexHierarchy>(vertex_hierarchy(object)));
  const MainState initial = initial_main_state(object);
  MainState state = initial, next = initial;
  Counts counts = no_counts<MainModels>();
  for (const auto& packet : packets) {
    MainModels models = main_start_models();
    CountingDecoder coder(packet, models, counts);
    MainHead head;
    code_main_start(coder, models, object, scene.baseline_span, head);
    const MainState& base = head.key ? initial : state;
    if (!reader.read(coder, models, head, base, next)) return false;
    next.tick = base.tick + head.tick_delta;
    std::swap(state, next);
  }
  const auto is_layer = [](std::size_t m) {
    const std::size_t at = m * sizeof(BitModel);
    return at == offsetof(MainModels, layer) || at == offsetof(MainModels, same_frame);
  };
  for (std::size_t m = 0; m < total.size(); ++m)
    for (std::size_t bit = 0; bit < 2; ++bit)
      if (!object.layered || is_layer(m)) total[m][bit] += counts[m][bit];
  return true;
}

bool print_table(const Counts& counts) {
  Table table(counts, 5);
  table.tree("KEY", 1);
  table.tree("LAYER", 1);
  table.tree("SAME_FRAME", 1);
  for (const char* name : {"BASELINE", "TICK", "LATE"}) table.magnitude(name);
  for (std::size_t i = 0; i < 2; ++i) table.tree(indexed("TOUCHED", {i}), 1);
  table.tree("SAME_TRIANGLE", 1);
  table.tree("NEAR_TRIANGLE", 1);
  table.tree("NEAR_INDEX", 63);
  table.magnitude("HAPTIC");
  table.tree("SAME_VISUAL", 1);
  table.magnitude("VISUAL");
  for (std::size_t i = 0; i < kDensities; ++i) table.tree(indexed("DENSITY", {i}), 3);
  for (std::size_t i = 0; i < DeformableObject::kWeightSets; ++i) table.tree(indexed("WEIGHT_SET", {i}), 3);
  for (const char* name : {"DRIVEN", "FADES"}) {
    table.chosen(indexed(name, {0}), 16384, 1);
    table.chosen(indexed(name, {1}), 1024, 5);
  }
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 3; ++j) table.magnitude(indexed("COEFFICIENT", {i, j}));
  for (std::size_t i = 0; i < kDensities * 4 * 9; ++i)
    table.tree(indexed("SIGNIFICANT", {i / 36, i / 9 % 4, i / 3 % 3, i % 3}), 1);
  for (std::size_t i = 0; i < 96; ++i) table.magnitude(indexed("COMPONENT", {i / 48, i / 16 % 3, i / 4 % 4, i % 4}));
  for (std::size_t i = 0; i < 15; ++i) table.tree(indexed("SIGN", {i / 5, i % 5}), 1);
  return table.complete();
}

}  // namespace

int main(int argc, char** argv) {
  Counts counts = no_counts<MainModels>();
  const auto count = [&](const Scene& scene, const auto& packets) { return count_file(scene, packets, counts); };
  if (!count_files(std::span(argv, static_cast<std::size_t>(argc)).subspan(1), count)) return 1;
  return print_table(counts) ? 0 : 1;
}
