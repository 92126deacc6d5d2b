// SPDX-License-Identifier: Apache-2.0
/// Packets of meshes that are damaged, late, lost or cut: an error with a rule or a decoded packet, never another state.
#include <tactus/deformable/decoder.h>

#include <gtest/gtest.h>

#include <memory>
#include <string_view>

#include <tactus/base/range_coder.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kSquares = 6;

struct Recorded {
  StreamHeader header;
  std::vector<Bytes> packets;
};

struct Coding {
  DeformableProfile profile;
  std::size_t modes = 0;
  bool split = false;
};

Recorded record(const Coding& coding, std::uint8_t span = 1) {
  const auto& [profile, modes, split] = coding;
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  Recorded out;
  out.header = testing::mesh_header(mesh, profile, modes > 0 ? testing::wave_basis(mesh, kSquares, modes) : ModeBasis{});
  out.header.baseline_span = span;
  out.header.meshes[0].models_kept = profile == DeformableProfile::thesis;
  out.header.meshes[0].split = split;
  testing::DentedSheet sheet(mesh, kSquares);
  auto encoder = DeformableEncoder::create(out.header, 0).value();
  for (std::int64_t k = 0; k < 40; ++k) {
    const auto frame = sheet.frame(k);
    const auto first = encoder.encode(k, frame.displacement, frame.touch).value();
    for (const EncodedDeformablePacket& packet : {first, encoder.encode_rest()})
      if (!packet.bytes.empty()) out.packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  }
  return out;
}

Result<DecodedDeformablePacket> decode_exact(DeformableDecoder& decoder, const Bytes& packet) {
  const auto exact = std::make_unique_for_overwrite<std::uint8_t[]>(packet.size());
  std::ranges::copy(packet, exact.get());
  return decoder.decode({exact.get(), packet.size()});
}

class DamagedPackets : public ::testing::TestWithParam<Coding> {
 protected:
  /// A decoder that has seen the first ten packets.
  DeformableDecoder started() const {
    auto decoder = DeformableDecoder::create(recorded_.header, 0).value();
    for (std::size_t i = 0; i < 10; ++i) EXPECT_TRUE(decoder.decode(recorded_.packets[i]));
    return decoder;
  }
  /// Refused, and nothing happened; or accepted by a decoder of its own.
  void expect_survived(DeformableDecoder& decoder, const Bytes& packet) const {
    const std::uint64_t hash = decoder.state_hash();
    const auto decoded = decode_exact(decoder, packet);
    if (decoded) {
      decoder = started();
      return;
    }
    EXPECT_TRUE(std::string_view(decoded.error().rule).starts_with("R-"));
    EXPECT_LE(decoded.error().code, Errc::state);
    EXPECT_LE(decoded.error().bit_offset, 8 * packet.size());
    EXPECT_EQ(decoder.state_hash(), hash);
    if (std::string_view(decoded.error().rule) == "R-PKT-7")
      decoder = started();  // it takes the baselines away, nothing else does
  }

  const Recorded recorded_ = record(GetParam(), 2);
};

TEST_P(DamagedPackets, EveryPrefixEveryBitEveryByte) {
  const Bytes good = recorded_.packets[10];
  DeformableDecoder decoder = started();
  for (std::size_t size = 0; size < good.size(); ++size)
    expect_survived(decoder, Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const int change : {1, 2, 4, 8, 16, 32, 64, 128, 255}) {
      Bytes bad = good;
      bad[i] = static_cast<std::uint8_t>(bad[i] ^ change);
      expect_survived(decoder, bad);
    }
  }
  Bytes longer = good;
  longer.resize(longer.size() + 12, 1);
  const auto refused = decode_exact(decoder, longer);
  ASSERT_FALSE(refused);
  EXPECT_STREQ(refused.error().rule, "R-RNG-2");
  EXPECT_TRUE(decode_exact(decoder, good));
  EXPECT_STREQ(decode_exact(decoder, good).error().rule, "R-PKT-5");
}

TEST_P(DamagedPackets, RandomBytes) {
  std::mt19937_64 random(5);
  DeformableDecoder decoder = started();
  for (int round = 0; round < 3000; ++round) {
    Bytes packet(2 + random() % 60);
    for (std::uint8_t& b : packet) b = static_cast<std::uint8_t>(random());
    packet[0] = recorded_.packets[10][0];
    packet[1] = recorded_.packets[10][1];
    expect_survived(decoder, packet);
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, DamagedPackets,
                         ::testing::Values(Coding{DeformableProfile::thesis}, Coding{DeformableProfile::main},
                                           Coding{DeformableProfile::main, 6}, Coding{DeformableProfile::main, 6, true}));

TEST(DeformableDecoder, LostPacketsAreNoticedAndKeysRepair) {
  const Recorded recorded = record({DeformableProfile::main});
  auto decoder = DeformableDecoder::create(recorded.header, 0).value();
  EXPECT_STREQ(decoder.decode(recorded.packets[1]).error().rule, "R-PKT-4");
  ASSERT_TRUE(decoder.decode(recorded.packets[0]));
  EXPECT_STREQ(decoder.decode(recorded.packets[2]).error().rule, "R-PKT-4");
  ASSERT_TRUE(decoder.decode(recorded.packets[1]));
  ASSERT_TRUE(decoder.decode(recorded.packets[2]));
}

TEST(DeformableDecoder, LimitsAndLengths) {
  Recorded recorded = record({DeformableProfile::main});
  DecodeLimits limits;
  limits.packet_bytes = 4;
  auto decoder = DeformableDecoder::create(recorded.header, 0, limits).value();
  EXPECT_STREQ(decoder.decode(Bytes(5)).error().rule, "R-PKT-1");
  EXPECT_STREQ(decoder.decode(Bytes(1)).error().rule, "R-PKT-2");
  limits.vertices = 10;
  EXPECT_STREQ(DeformableDecoder::create(recorded.header, 0, limits).error().rule, "R-STR-14");
  EXPECT_STREQ(DeformableDecoder::create(recorded.header, 1).error().rule, "R-API-5");
}

}  // namespace
}  // namespace tactus
