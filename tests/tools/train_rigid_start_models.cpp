// SPDX-License-Identifier: Apache-2.0
/// Make spec/tables/rigid-start-models.csv from stream files of rigid objects.
///   train_rigid_start_models a.tct b.tct ... > rigid-start-models.csv
/// Every file has the same weight.
#include <tactus/rigid/rigid_syntax.h>
#include "tests/tools/start_models.h"

namespace {

using namespace tactus;

/// False: the packet names an object that is not there.
bool count_packet(std::span<const std::uint8_t> packet, const Scene& scene, Counts& counts) {
  RigidModels models = start_models();
  CountingDecoder coder(packet, models, counts);
  RigidHead head;
  code_head(coder, models, scene, head);
  const auto moving = scene.moving();
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < head.count; ++i) {
    if (moving.size() > 1) next += coder.magnitude(models.gap, 0);
    if (next >= moving.size()) return false;
    CodedUpdate update;
    code_update(coder, models, scene, moving[next++], update);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Counts total = no_counts<RigidModels>();
  const auto count_file = [&](const Scene& scene, const auto& packets) {
    if (!scene.deformables.empty()) return false;
    Counts counts = no_counts<RigidModels>();
    for (const auto& packet : packets)
      if (!count_packet(packet, scene, counts)) return false;
    for (std::size_t m = 0; m < total.size(); ++m)
      for (std::size_t bit = 0; bit < 2; ++bit)
        total[m][bit] += packets.empty() ? 0 : 1000 * counts[m][bit] / static_cast<double>(packets.size());
    return true;
  };
  if (!count_files(std::span(argv, static_cast<std::size_t>(argc)).subspan(1), count_file)) return 1;
  Table table(total, 4);
  table.tree("KEY", 1);
  for (const char* name : {"BASELINE", "TICK", "COUNT", "GAP"}) table.magnitude(name);
  table.tree("REASON", 3);
  table.tree("LEVEL", 15);
  table.tree("SMOOTHING_EXP", 7);
  table.tree("RETAINED", 3);
  for (std::size_t kind = 0; kind < 2; ++kind) {
    for (std::size_t context = 0; context < kPoseContexts; ++context) table.magnitude(indexed("POSE", {kind, context}));
    for (std::size_t context = 0; context < kMotionContexts; ++context) table.magnitude(indexed("MOTION", {kind, context}));
    for (std::size_t reason = 0; reason < 4; ++reason) table.tree(indexed("SIGN", {kind, reason}), 1);
  }
  for (std::size_t context = 0; context < 8; ++context) table.tree(indexed("PREDICTOR", {context}), 3);
  for (std::size_t of = 0; of < 3; ++of) table.magnitude(indexed("CONTACT", {of}));
  table.tree("LOD", 7);
  return table.complete() ? 0 : 1;
}
