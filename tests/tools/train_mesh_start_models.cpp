// SPDX-License-Identifier: Apache-2.0
/// Make spec/tables/mesh-start-models.csv from stream files: count how often each model of a packet coded a 0, write the table.
///   train_mesh_start_models a.tct b.tct ... > mesh-start-models.csv
/// Every packet has the same weight. Only streams whose packets build on the packet before or on the initial state.
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "codec/mesh/mesh_main_reader.h"
#include "codec/stream/file.h"

namespace {

using namespace tactus;

constexpr std::size_t kModels = sizeof(MeshModels) / sizeof(BitModel);
using Counts = std::vector<std::array<double, 2>>;

/// Decodes symbols and counts the bits of each model on the way.
class CountingDecoder : public detail::SymbolCoder<CountingDecoder> {
 public:
  CountingDecoder(std::span<const std::uint8_t> payload, const MeshModels& models, Counts& counts)
      : decoder_(payload), first_(reinterpret_cast<const BitModel*>(&models)), counts_(counts) {}

  bool bit(BitModel& model, std::uint32_t) noexcept {
    const bool value = decoder_.bit(model);
    counts_[static_cast<std::size_t>(&model - first_)][value ? 1 : 0] += 1;
    return value;
  }
  std::uint32_t raw(unsigned count, std::uint32_t) noexcept { return decoder_.raw(count); }

 private:
  RangeDecoder decoder_;
  const BitModel* first_;
  Counts& counts_;
};

bool count_file(const char* path, Counts& total) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
  auto reader = StreamFileReader::open({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  if (!in || !reader || reader->header().meshes.size() != 1) return false;
  const MeshObject& mesh = reader->header().meshes[0];
  MeshMainReader packets(mesh);
  MeshState state = initial_mesh_state(mesh), next = state;
  const MeshState initial = state;
  for (;;) {
    const auto packet = reader->next();
    if (!packet) return false;
    if (!*packet) return true;
    MeshModels models = mesh_start_models();
    CountingDecoder coder((*packet)->bytes.subspan(2), models, total);
    MeshHead head;
    code_mesh_start(coder, models, mesh, reader->header().baseline_span, head);
    if (!packets.read(coder, models, head, head.key ? initial : state, next)) return false;
    std::swap(state, next);
  }
}

void print_group(const std::string& name, std::size_t size, const Counts& counts, std::size_t& at) {
  for (std::size_t node = 1; node <= size; ++node, ++at) {
    const double zeros = counts[at][0], all = zeros + counts[at][1];
    constexpr double kPrior = 4;  // as if two bits of each kind had been seen: no symbol is ever ruled out
    const double p = (zeros + kPrior / 2) / (all + kPrior);
    const bool cold = all == 0;
    const long zero = std::min(32768L - 64, std::max(64L, static_cast<long>(p * 32768 + 0.5)));
    std::printf("%s[%zu],%ld,%d\n", name.c_str(), node, cold ? 16384L : zero, cold ? 1 : 5);
  }
}

std::string indexed(const char* name, std::initializer_list<std::size_t> indices) {
  std::string out = name;
  for (const std::size_t i : indices) out += "[" + std::to_string(i) + "]";
  return out;
}

std::size_t print_table(const Counts& counts) {
  std::size_t at = 0;
  print_group("KEY", 1, counts, at);
  for (const char* name : {"BASELINE", "TICK", "LATE"}) print_group(name, 15, counts, at);
  for (std::size_t i = 0; i < 2; ++i) print_group(indexed("TOUCHED", {i}), 1, counts, at);
  print_group("SAME_TRIANGLE", 1, counts, at);
  print_group("NEAR_TRIANGLE", 1, counts, at);
  print_group("NEAR_PLACE", 63, counts, at);
  print_group("HAPTIC", 15, counts, at);
  print_group("SAME_VISUAL", 1, counts, at);
  print_group("VISUAL", 15, counts, at);
  for (std::size_t i = 0; i < kDensities; ++i) print_group(indexed("DENSITY", {i}), 3, counts, at);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 3; ++j) print_group(indexed("COEFFICIENT", {i, j}), 15, counts, at);
  for (std::size_t i = 0; i < kDensities * 4 * 9; ++i)
    print_group(indexed("SIGNIFICANT", {i / 36, i / 9 % 4, i / 3 % 3, i % 3}), 1, counts, at);
  for (std::size_t i = 0; i < 18; ++i) print_group(indexed("COMPONENT", {i / 9, i / 3 % 3, i % 3}), 15, counts, at);
  return at;
}

}  // namespace

int main(int argc, char** argv) {
  Counts counts(kModels);
  for (int i = 1; i < argc; ++i) {
    if (count_file(argv[i], counts)) continue;
    std::fprintf(stderr, "%s: not a readable stream file of one mesh\n", argv[i]);
    return 1;
  }
  std::puts("model,zero,rate");
  return print_table(counts) == kModels ? 0 : 1;
}
