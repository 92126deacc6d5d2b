// SPDX-License-Identifier: Apache-2.0
#include "conformance/make_vectors/features.h"

#include <array>
#include <bit>
#include <map>

namespace tactus::conformance {
namespace {

constexpr std::array kFlags{
    Flag{"order", "breaks two rules; the one that is read first counts"},
    Flag{"key", "a key packet after the first packet of a substream"},
    Flag{"loss", "packets are missing, overtaken or come twice: sequence numbers do not follow each other"},
    Flag{"baselines", "baseline_span is greater than 1"},
    Flag{"substreams", "packets begin with a substream byte"},
    Flag{"bounds", "the scene declaration has a bounds record"},
    Flag{"loads", "the scene has loads"},
    Flag{"eased", "the scene is eased"},
    Flag{"motion", "the scene has motion constants"},
    Flag{"driven", "the scene is driven"},
    Flag{"elastic", "a deformable object has an elastic body"},
    Flag{"basis", "a deformable object has modes that are declared"},
    Flag{"computed_basis", "a deformable object has modes that both ends compute"},
    Flag{"layered", "a deformable object has haptic and visual layers"},
    Flag{"fade", "corrections outside a deformable object's basis fade"},
    Flag{"weight_sets", "a deformable object has several sets of weights"},
    Flag{"models_kept", "entropy models are part of a deformable object's state"},
    Flag{"client", "runs a client: the testee is called with --replica"},
    Flag{"session", "runs the client's end of a session: the testee is called with --session and reads a .script file"},
    Flag{"large", "the input has bytes that are not in the .tct file but in the member repeat"},
};

/// Reads on and on; past the end everything is 0.
class Skimmer {
 public:
  explicit Skimmer(std::span<const std::uint8_t> data) : data_(data) {}

  bool at_end() const { return at_ >= data_.size(); }
  /// The next bytes, as many as there are.
  Skimmer take(std::uint64_t bytes) {
    const std::size_t begin = at_;
    skip(bytes);
    return Skimmer(data_.subspan(begin, at_ - begin));
  }
  void skip(std::uint64_t bytes) { at_ = bytes < data_.size() - at_ ? at_ + static_cast<std::size_t>(bytes) : data_.size(); }
  unsigned u8() { return at_end() ? 0 : data_[at_++]; }
  unsigned u16() {
    const unsigned low = u8();
    return low | u8() << 8;
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !at_end(); shift += 7) {
      const unsigned byte = u8();
      value |= std::uint64_t{byte & 0x7f} << shift;
      if (byte < 0x80) break;
    }
    return value;
  }
  void skip_varints(std::uint64_t count) {
    for (; count > 0 && !at_end(); --count) varint();
  }

 private:
  std::span<const std::uint8_t> data_;
  std::size_t at_ = 0;
};

/// One deformable object of the scene declaration.
void skim_deformable(Skimmer& in, Features& out) {
  if (in.at_end()) return;
  const unsigned profile = in.u8();
  if (profile > 1) return in.skip(~std::uint64_t{0});
  out.profiles.insert(profile == 0 ? "thesis" : "main");
  in.skip(in.u8());
  in.skip(profile == 0 ? 2 : 5);  // rings and quant_bits, or rings and frame_period
  if (in.u8() == 1) out.flags.insert(profile == 0 ? "models_kept" : "layered");
  if (profile == 1) {
    if (in.u16() > 0) out.flags.insert("fade");
    if (std::popcount(in.u8()) > 1) out.flags.insert("weight_sets");
  }
  const std::uint64_t vertices = in.varint(), triangles = in.varint();
  in.skip_varints(3 * vertices);
  in.skip_varints(3 * triangles);
  if (profile == 0) return;
  const unsigned basis = in.u8();
  if (basis == 0) return;
  const std::uint64_t modes = in.varint();
  out.flags.insert(basis == 1 ? "basis" : "computed_basis");
  if (basis == 2) return in.skip_varints(2 * in.varint());
  for (std::uint64_t k = 0; k < modes && !in.at_end(); ++k) {
    in.skip(2);
    in.skip_varints(3 * vertices);
  }
}

/// How many substreams the scene has.
std::uint64_t skim_declaration(Skimmer& in, Features& out) {
  in.skip(6);
  const unsigned flags = in.u16();
  const bool has_deformables = flags & 1u, known = flags <= 63;
  if (flags & 4u) out.flags.insert("eased");
  in.skip(4 + 10);  // body_size, tick_rate to max_extrapolation
  if (in.u8() > 1) out.flags.insert("baselines");
  bool moving = false;
  for (std::uint64_t objects = in.varint(); objects > 0 && !in.at_end(); --objects) {
    in.skip(1);
    moving = in.u8() != 0 || moving;
    in.skip(in.u8());
    in.skip(28);
  }
  std::uint64_t substreams = moving ? 1 : 0;
  for (std::uint64_t count = has_deformables ? in.varint() : 0; count > 0 && !in.at_end(); --count) {
    ++substreams;
    skim_deformable(in, out);
  }
  if (known && (flags & 2u)) {
    out.flags.insert("loads");
    ++substreams;
    in.skip(2);
  }
  if (known && (flags & 8u)) out.flags.insert("motion");
  if (known && (flags & 16u)) out.flags.insert("driven");
  if (known && (flags & 32u)) out.flags.insert("elastic");
  return substreams;
}

/// Packets whose sequence numbers do not follow those before them.
void skim_records(Skimmer& in, bool with_substream, Features& out) {
  std::map<unsigned, unsigned> next;  // sequence, by substream
  while (!in.at_end()) {
    const unsigned type = in.u8();
    Skimmer packet = in.take(in.varint());
    in.skip(4);
    if (type != 1) continue;
    packet.varint();
    const unsigned substream = with_substream ? packet.u8() : 0;
    if (packet.at_end()) continue;
    const unsigned sequence = packet.u16();
    const auto [expected, first] = next.try_emplace(substream, sequence);
    if (!first && expected->second != sequence) out.flags.insert("loss");
    expected->second = (sequence + 1) & 0xffff;
  }
}

/// Magic to body, without `crc`.
std::size_t declaration_size(std::span<const std::uint8_t> file) {
  std::size_t size = 12;
  for (unsigned i = 0; i < 4 && file.size() >= 12; ++i) size += std::size_t{file[8 + i]} << (8 * i);
  return size;
}

/// Key packets that come after others of their substream.
void read_answer(std::string_view answer, Features& out) {
  std::set<std::string> substreams;
  for (std::size_t begin = 0; begin < answer.size();) {
    const std::size_t end = answer.find('\n', begin);
    const std::string_view line = answer.substr(begin, end - begin);
    begin = end + 1;
    if (!line.starts_with(R"({"packet":)")) continue;
    const std::size_t part = line.find(R"("part":)");
    const std::string substream{part == std::string_view::npos ? "" : line.substr(part, line.find(',', part) - part)};
    const bool first = substreams.insert(substream).second;
    if (!first && line.find(R"("key":true)") != std::string_view::npos) out.flags.insert("key");
  }
  if (answer.find(R"("bounds":{)") != std::string_view::npos || answer.find(R"("R-STR-17")") != std::string_view::npos)
    out.flags.insert("bounds");
}

}  // namespace

std::span<const Flag> all_flags() { return kFlags; }

Features features(std::span<const std::uint8_t> file, std::string_view answer) {
  Features out;
  Skimmer in(file);
  Skimmer declaration = in.take(declaration_size(file));
  in.skip(4);
  const bool several = skim_declaration(declaration, out) > 1;
  if (several) out.flags.insert("substreams");
  skim_records(in, several, out);
  read_answer(answer, out);
  return out;
}

}  // namespace tactus::conformance
