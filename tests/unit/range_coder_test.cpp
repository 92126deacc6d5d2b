// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/range_coder.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string_view>
#include <vector>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// What one test symbol was coded with.
struct Symbol {
  enum Kind { bit, raw, magnitude, signed_value } kind;
  unsigned count = 0;  // of raw bits
  std::int64_t value = 0;
};

struct Models {
  std::array<BitModel, 3> bits{};
  MagnitudeModel magnitudes{}, signed_values{};
};

template <class Coder>
std::int64_t code(Coder& coder, Models& models, const Symbol& s) {
  switch (s.kind) {
    case Symbol::bit:
      return coder.bit(models.bits[s.count % 3], static_cast<std::uint32_t>(s.value)) ? 1 : 0;
    case Symbol::raw:
      return coder.raw(s.count, static_cast<std::uint32_t>(s.value));
    case Symbol::magnitude:
      return coder.magnitude(models.magnitudes, static_cast<std::uint32_t>(s.value));
    default:
      return coder.signed_value(models.signed_values, static_cast<std::int32_t>(s.value));
  }
}

Bytes encode(const std::vector<Symbol>& symbols) {
  Bytes out(16 + symbols.size() * 16);
  RangeEncoder encoder(out);
  Models models;
  for (const Symbol& s : symbols) code(encoder, models, s);
  out.resize(encoder.finish());
  EXPECT_FALSE(encoder.overflow());
  return out;
}

void expect_round_trip(const std::vector<Symbol>& symbols) {
  const Bytes payload = encode(symbols);
  RangeDecoder decoder(payload);
  Models models;
  for (std::size_t i = 0; i < symbols.size(); ++i)
    ASSERT_EQ(code(decoder, models, symbols[i]), symbols[i].value) << "symbol " << i;
  EXPECT_FALSE(decoder.broken_rule());
  EXPECT_FALSE(decoder.too_wide());
}

TEST(RangeCoder, RandomSymbolsRoundTrip) {
  std::mt19937_64 random(4);
  for (int run = 0; run < 2000; ++run) {
    std::vector<Symbol> symbols(random() % 60);
    const auto skew = random() % 100;
    for (Symbol& s : symbols) {
      s.kind = static_cast<Symbol::Kind>(random() % 4);
      s.count = 1 + static_cast<unsigned>(random() % 16);
      const auto wide = static_cast<std::int64_t>((random() & 0xffffffffu) >> (random() % 32));
      if (s.kind == Symbol::bit) s.value = random() % 100 < skew;
      if (s.kind == Symbol::raw) s.value = static_cast<std::int64_t>(random() & ((1u << s.count) - 1));
      if (s.kind == Symbol::magnitude) s.value = wide;
      if (s.kind == Symbol::signed_value) s.value = (wide >> 1) * (random() % 2 ? 1 : -1);
    }
    expect_round_trip(symbols);
  }
}

TEST(RangeCoder, EveryWidthOfMagnitudeRoundTrips) {
  for (unsigned width = 0; width <= 32; ++width) {
    const std::int64_t top = width == 0 ? 0 : std::int64_t{1} << (width - 1);
    expect_round_trip({{Symbol::magnitude, 0, top}, {Symbol::magnitude, 0, width == 0 ? 0 : 2 * top - 1}});
    if (width < 32) expect_round_trip({{Symbol::signed_value, 0, top}, {Symbol::signed_value, 0, -top}});
  }
}

TEST(RangeCoder, CarriesRunThroughLongChains) {
  // All-ones raw bits push `low` to the top of its range; a certain bit at the end carries through every 0xff written.
  std::vector<Symbol> symbols(40, {Symbol::raw, 16, 65535});
  for (int i = 0; i < 300; ++i) symbols.push_back({Symbol::bit, 0, 1});
  expect_round_trip(symbols);
  symbols.insert(symbols.begin() + 20, 5, {Symbol::raw, 16, 0});
  expect_round_trip(symbols);
}

TEST(RangeCoder, TailIsShortAndImpliedZerosAreDropped) {
  EXPECT_TRUE(encode({}).empty());
  EXPECT_TRUE(encode({{Symbol::raw, 16, 0}, {Symbol::raw, 16, 0}}).empty()) << "zeros cost nothing";
  std::mt19937_64 random(5);
  double bits = 0, bytes = 0;
  for (int run = 0; run < 4000; ++run) {
    std::vector<Symbol> symbols(1 + random() % 10);
    for (Symbol& s : symbols) {
      s = {Symbol::raw, 8, static_cast<std::int64_t>(random() & 0xff)};
      bits += 8;
    }
    const Bytes payload = encode(symbols);
    EXPECT_TRUE(payload.empty() || payload.back() != 0);
    bytes += static_cast<double>(payload.size());
  }
  EXPECT_LT(bytes / 4000 - bits / 8 / 4000, 0.6) << "bytes per payload above the information content";
}

TEST(RangeCoder, ModelsAdaptTowardWhatTheySee) {
  BitModel m;
  for (int i = 0; i < 400; ++i) m.adapt(true);
  EXPECT_LT(m.zero, 1000);
  EXPECT_GE(m.zero, 1);
  for (int i = 0; i < 100000; ++i) m.adapt(true);
  EXPECT_GE(m.zero, 1) << "no symbol ever becomes impossible";
  for (int i = 0; i < 100000; ++i) m.adapt(false);
  EXPECT_LE(m.zero, 32767);
}

TEST(RangeCoder, AnAdaptedModelCostsItsEntropy) {
  std::mt19937_64 random(6);
  std::vector<Symbol> symbols(20000, {Symbol::bit, 0, 0});
  for (Symbol& s : symbols) s.value = random() % 100 < 5;
  const double entropy = -(0.05 * std::log2(0.05) + 0.95 * std::log2(0.95));
  EXPECT_LT(8.0 * static_cast<double>(encode(symbols).size()) / 20000, entropy * 1.1);
}

TEST(RangeCoder, SmallBufferSetsOverflowAndWritesNothingBeyond) {
  Bytes out(8, 0xaa);
  RangeEncoder encoder(std::span<std::uint8_t>(out).first(3));
  for (int i = 0; i < 10; ++i) encoder.raw(16, 0x5a5a);
  encoder.finish();
  EXPECT_TRUE(encoder.overflow());
  for (std::size_t i = 3; i < out.size(); ++i) EXPECT_EQ(out[i], 0xaa);
}

TEST(RangeCoder, BrokenPayloadsAreNamed) {
  const auto rule_after_one_bit = [](const Bytes& payload) {
    RangeDecoder decoder(payload);
    BitModel m;
    decoder.bit(m);
    const char* rule = decoder.broken_rule();
    return std::string_view(rule != nullptr ? rule : "");
  };
  EXPECT_EQ(rule_after_one_bit({1, 2, 3, 4, 5}), "R-RNG-2");
  EXPECT_EQ(rule_after_one_bit({1, 0}), "R-RNG-3");
  EXPECT_EQ(rule_after_one_bit({0xff, 0xff, 0xff, 0xfe}), "");
}

TEST(RangeCoder, TooWideMagnitudesAreRefused) {
  Bytes out(64);
  RangeEncoder encoder(out);
  MagnitudeModel m{};
  encoder.tree<4>(m, 15);
  encoder.raw(5, 18);  // 33 bits
  out.resize(encoder.finish());
  RangeDecoder decoder(out);
  MagnitudeModel n{};
  decoder.magnitude(n, 0);
  EXPECT_TRUE(decoder.too_wide());

  Bytes signed_out(64);
  RangeEncoder signed_encoder(signed_out);
  m = {};
  signed_encoder.magnitude(m, 0x80000000u);
  signed_encoder.raw(1, 0);
  signed_out.resize(signed_encoder.finish());
  RangeDecoder signed_decoder(signed_out);
  n = {};
  signed_decoder.signed_value(n, 0);
  EXPECT_TRUE(signed_decoder.too_wide());
}

TEST(RangeCoder, AnyBytesDecodeToSomething) {
  std::mt19937_64 random(7);
  for (int run = 0; run < 2000; ++run) {
    Bytes payload(random() % 40);
    for (auto& b : payload) b = static_cast<std::uint8_t>(random() % 4 ? random() : 0xff);
    RangeDecoder decoder(payload);
    Models models;
    for (int i = 0; i < 100; ++i)
      code(decoder, models, {static_cast<Symbol::Kind>(random() % 4), 1 + static_cast<unsigned>(random() % 16), 0});
    EXPECT_GE(decoder.range(), 1u << 24);
  }
}

}  // namespace
}  // namespace tactus
