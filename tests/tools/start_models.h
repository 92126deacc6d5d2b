// SPDX-License-Identifier: Apache-2.0
/// Start models from stream files: count how often each model of a packet coded a 0, and print the table.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/range_coder.h>
#include <tactus/file/stream_file.h>
#include <tactus/thesis/thesis.h>

namespace tactus {

/// How often each model coded a 0 and a 1.
using Counts = std::vector<std::array<double, 2>>;

/// Counts the bits of symbols that are known.
class CountingEncoder : public detail::SymbolCoder<CountingEncoder> {
 public:
  CountingEncoder(const BitModel* first, Counts& counts) : first_(first), counts_(counts) {}

  bool bit(BitModel& model, std::uint32_t value) noexcept {
    counts_[static_cast<std::size_t>(&model - first_)][value != 0 ? 1 : 0] += 1;
    return value != 0;
  }
  std::uint32_t raw(unsigned, std::uint32_t value) noexcept { return value; }

 private:
  const BitModel* first_;
  Counts& counts_;
};

/// `Models` is a struct of nothing but BitModel.
template <class Models>
Counts no_counts() {
  return Counts(sizeof(Models) / sizeof(BitModel));
}

/// Decodes symbols and counts the bits of each model on the way.
class CountingDecoder : public detail::SymbolCoder<CountingDecoder> {
 public:
  template <class Models>
  CountingDecoder(std::span<const std::uint8_t> payload, const Models& models, Counts& counts)
      : decoder_(payload), first_(reinterpret_cast<const BitModel*>(&models)), counts_(counts) {}

  bool bit(BitModel& model, std::uint32_t) noexcept {
    const bool value = decoder_.bit(model);
    counts_[static_cast<std::size_t>(&model - first_)][value ? 1 : 0] += 1;
    return value;
  }
  std::uint32_t raw(unsigned count, std::uint32_t) noexcept { return decoder_.raw(count); }
  CountingEncoder again() noexcept { return {first_, counts_}; }  ///< to count more symbols with the same models

 private:
  RangeDecoder decoder_;
  const BitModel* first_;
  Counts& counts_;
};

/// Calls count(scene, packets) for every file. False and a message on stderr when one cannot be read or count() returns false.
template <class Count>
bool count_files(std::span<char*> paths, Count count) {
  for (const char* path : paths) {
    std::ifstream in(path, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
    auto reader =
        StreamFileReader::open({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, {.thesis = &thesis_component});
    std::vector<std::span<const std::uint8_t>> packets;
    bool good = in && reader;
    while (good) {
      const auto packet = reader->next();
      good = packet.has_value();
      if (!good || !*packet) break;
      packets.push_back((*packet)->bytes);
    }
    if (good && count(*reader->scene(), packets)) continue;
    std::fprintf(stderr, "%s: not a stream file that this tool can count\n", path);
    return false;
  }
  return true;
}

/// Prints one row per model, in the order of the specification's table.
class Table {
 public:
  /// `rate`: how firmly a packet believes the table, see spec/30-range-coder.md section 2. Models without a count stay cold.
  Table(const Counts& counts, int rate) : counts_(counts), rate_(rate) { std::puts("model,zero,rate"); }

  /// The `size` models of one tree.
  void tree(const std::string& name, std::size_t size) {
    for (std::size_t node = 1; node <= size; ++node, ++at_) {
      const double zeros = counts_[at_][0], all = zeros + counts_[at_][1];
      constexpr double kPrior = 4;  // as if two bits of each kind had been seen: no symbol is ever ruled out
      const double p = (zeros + kPrior / 2) / (all + kPrior);
      const bool cold = all == 0;
      const long zero = std::min(32768L - 64, std::max(64L, std::lround(p * 32768)));
      std::printf("%s[%zu],%ld,%d\n", name.c_str(), node, cold ? 16384L : zero, cold ? 1 : rate_);
    }
  }
  void magnitude(const std::string& name) { tree(name, 15); }
  /// One model whose start is chosen: no stream file codes it.
  void chosen(const std::string& name, long zero, int rate) {
    std::printf("%s[1],%ld,%d\n", name.c_str(), zero, rate);
    ++at_;
  }
  /// Every model has its row.
  bool complete() const { return at_ == counts_.size(); }

 private:
  const Counts& counts_;
  int rate_;
  std::size_t at_ = 0;
};

inline std::string indexed(std::string name, std::initializer_list<std::size_t> indices) {
  for (const std::size_t i : indices) name += "[" + std::to_string(i) + "]";
  return name;
}

}  // namespace tactus
