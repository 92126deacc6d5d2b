// SPDX-License-Identifier: Apache-2.0
/// Make spec/tables/rigid-start-models.csv from stream files of rigid objects.
///   train_rigid_start_models a.tct b.tct ... > rigid-start-models.csv
/// Every file has the same weight.
#include <tactus/rigid/rigid_syntax.h>
#include "tests/tools/start_models.h"

namespace {

using namespace tactus;

void count_packet(std::span<const std::uint8_t> packet, const StreamHeader& header, const std::vector<std::uint32_t>& moving,
                  Counts& counts) {
  RigidModels models = start_models();
  CountingDecoder coder(packet.subspan(2), models, counts);
  PacketHead head;
  code_head(coder, models, header, moving.size(), head);
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < head.count; ++i) {
    if (moving.size() > 1) next += coder.magnitude(models.gap, 0);
    CodedUpdate update;
    code_update(coder, models, header.objects[moving.at(next++)].dof, update);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Counts total = no_counts<RigidModels>();
  const auto count_file = [&](const StreamHeader& header, const auto& packets) {
    const auto moving = moving_objects(header);
    Counts counts = no_counts<RigidModels>();
    for (const auto& packet : packets) count_packet(packet, header, moving, counts);
    for (std::size_t m = 0; m < total.size(); ++m)
      for (std::size_t bit = 0; bit < 2; ++bit)
        total[m][bit] += packets.empty() ? 0 : 1000 * counts[m][bit] / static_cast<double>(packets.size());
    return header.meshes.empty();
  };
  if (!count_files(std::span(argv, static_cast<std::size_t>(argc)).subspan(1), count_file)) return 1;
  Table table(total, 4);
  table.tree("KEY", 1);
  for (const char* name : {"BASELINE", "TICK", "COUNT", "GAP"}) table.magnitude(name);
  table.tree("REASON", 3);
  table.tree("LEVEL", 7);
  for (std::size_t q = 0; q < kQuantities; ++q)
    for (std::size_t hint = 0; hint < kHints; ++hint) table.magnitude(indexed("RESIDUAL", {q, hint}));
  return table.complete() ? 0 : 1;
}
