// SPDX-License-Identifier: Apache-2.0
/// Make spec/tables/rigid-start-models.csv from stream files: count how often each model of a packet coded a 0, write the table.
///   train_start_models a.tct b.tct ... > rigid-start-models.csv
/// Every file has the same weight. Models that no file uses stay cold.
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "codec/rigid/rigid_syntax.h"
#include "codec/stream/file.h"

namespace {

using namespace tactus;

constexpr std::size_t kModels = sizeof(RigidModels) / sizeof(BitModel);
using Counts = std::array<std::array<double, 2>, kModels>;

/// Decodes symbols and counts the bits of each model on the way.
class CountingDecoder : public detail::SymbolCoder<CountingDecoder> {
 public:
  CountingDecoder(std::span<const std::uint8_t> payload, const RigidModels& models, Counts& counts)
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

bool count_file(const char* path, Counts& total) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
  auto reader = StreamFileReader::open({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  if (!in || !reader) return false;
  const auto moving = moving_objects(reader->header());
  Counts counts{};
  double packets = 0;
  for (;;) {
    const auto packet = reader->next();
    if (!packet) return false;
    if (!*packet) break;
    count_packet((*packet)->bytes, reader->header(), moving, counts);
    packets += 1;
  }
  for (std::size_t m = 0; m < kModels; ++m) {
    for (std::size_t bit = 0; bit < 2; ++bit) total[m][bit] += packets > 0 ? 1000 * counts[m][bit] / packets : 0;
  }
  return true;
}

void print_group(const std::string& name, std::size_t size, const Counts& counts, std::size_t& at) {
  for (std::size_t node = 1; node <= size; ++node, ++at) {
    const double zeros = counts[at][0], all = zeros + counts[at][1];
    constexpr double kPrior = 4;  // as if two bits of each kind had been seen: no symbol is ever ruled out
    const double p = (zeros + kPrior / 2) / (all + kPrior);
    const bool cold = all == 0;
    const long zero = std::min(32768L - 64, std::max(64L, static_cast<long>(p * 32768 + 0.5)));
    std::printf("%s[%zu],%ld,%d\n", name.c_str(), node, cold ? 16384L : zero, cold ? 1 : 4);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Counts counts{};
  for (int i = 1; i < argc; ++i) {
    if (count_file(argv[i], counts)) continue;
    std::fprintf(stderr, "%s: not a readable stream file\n", argv[i]);
    return 1;
  }
  std::puts("model,zero,rate");
  std::size_t at = 0;
  print_group("KEY", 1, counts, at);
  for (const char* name : {"BASELINE", "TICK", "COUNT", "GAP"}) print_group(name, 15, counts, at);
  print_group("REASON", 3, counts, at);
  print_group("LEVEL", 7, counts, at);
  for (std::size_t q = 0; q < kQuantities; ++q) {
    for (std::size_t hint = 0; hint < kHints; ++hint) {
      print_group("RESIDUAL[" + std::to_string(q) + "][" + std::to_string(hint) + "]", 15, counts, at);
    }
  }
  return at == kModels ? 0 : 1;
}
