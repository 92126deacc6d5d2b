// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_syntax.h>

#include <gtest/gtest.h>

#include <functional>
#include <string_view>

#include <tactus/base/bytes.h>
#include <tactus/base/hash.h>

namespace tactus {
namespace {

StreamHeader two_objects() {
  StreamHeader header;
  header.tick_rate = 500;
  header.objects.resize(2);
  header.objects[0].name = "cube";
  header.objects[0].dof = Dof::x | Dof::rz;
  header.objects[0].initial.position = {1, -2, 3};
  header.objects[1].name = "tisch \xc3\xa4";
  header.objects[1].dof = Dof::none;
  return header;
}

TEST(StreamHeader, RoundTrips) {
  const StreamHeader header = two_objects();
  const auto bytes = write_header(header);
  ASSERT_TRUE(bytes);
  const auto parsed = parse_header(*bytes);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->size, bytes->size());
  EXPECT_EQ(parsed->header.tick_rate, 500u);
  EXPECT_EQ(parsed->header.grid, header.grid);
  ASSERT_EQ(parsed->header.objects.size(), 2u);
  EXPECT_EQ(parsed->header.objects[0].initial, header.objects[0].initial);
  EXPECT_EQ(parsed->header.objects[1].name, header.objects[1].name);
  EXPECT_EQ(write_header(parsed->header).value(), *bytes) << "equal headers, equal bytes";
}

TEST(StreamHeader, WriterRefusesWhatTheReaderWould) {
  const std::pair<const char*, std::function<void(StreamHeader&)>> cases[] = {
      {"R-STR-3", [](StreamHeader& h) { h.profile = Profile::main; }},
      {"R-STR-6", [](StreamHeader& h) { h.tick_rate = 0; }},
      {"R-STR-6", [](StreamHeader& h) { h.tick_rate = 1000001; }},
      {"R-STR-7", [](StreamHeader& h) { h.grid.position = 31; }},
      {"R-STR-7", [](StreamHeader& h) { h.grid.velocity = 23; }},
      {"R-STR-7", [](StreamHeader& h) { h.grid.velocity = 9; }},
      {"R-STR-7", [](StreamHeader& h) { h.grid.rotation = 29; }},
      {"R-STR-7", [](StreamHeader& h) { h.grid.spin = 6; }},
      {"R-STR-8", [](StreamHeader& h) { h.max_extrapolation = 0; }},
      {"R-STR-9", [](StreamHeader& h) { h.baseline_span = 65; }},
      {"R-STR-11", [](StreamHeader& h) { h.objects[0].name.clear(); }},
      {"R-STR-11", [](StreamHeader& h) { h.objects[0].name = h.objects[1].name; }},
      {"R-STR-11", [](StreamHeader& h) { h.objects[0].name = "\xc3"; }},
      {"R-STR-11", [](StreamHeader& h) { h.objects[0].name = "\xed\xa0\x80"; }},
      {"R-STR-11", [](StreamHeader& h) { h.objects[0].name = "a\nb"; }},
      {"R-STR-12", [](StreamHeader& h) { h.objects[0].dof = Dof::rx | Dof::ry; }},
      {"R-STR-12", [](StreamHeader& h) { h.objects[0].dof = 64; }},
      {"R-STR-13",
       [](StreamHeader& h) {
         h.objects[0].initial.rotation = {1 << 29, 0, 0, 0};
       }},
  };
  for (const auto& [rule, change] : cases) {
    StreamHeader header = two_objects();
    change(header);
    const auto bytes = write_header(header);
    ASSERT_FALSE(bytes) << rule;
    EXPECT_STREQ(bytes.error().rule, rule);
    EXPECT_EQ(bytes.error().code, Errc::invalid_argument);
  }
}

/// Replace the body's tail and mend size and check value.
std::vector<std::uint8_t> with_extension(std::vector<std::uint8_t> bytes, const std::vector<std::uint8_t>& extension) {
  bytes.resize(bytes.size() - 4);
  bytes.insert(bytes.end(), extension.begin(), extension.end());
  const auto body = static_cast<std::uint32_t>(bytes.size() - 12);
  for (unsigned i = 0; i < 4; ++i) bytes[8 + i] = static_cast<std::uint8_t>(body >> (8 * i));
  ByteWriter(bytes).u32(crc32(bytes));
  return bytes;
}

TEST(StreamHeader, AnInitialStateThatMovesIsRefused) {
  StreamHeader header = two_objects();
  header.objects[0].initial.velocity = {1, 0, 0};  // the bytes have no place for it: both ends would start apart
  EXPECT_STREQ(write_header(header).error().rule, "R-API-8");
}

TEST(StreamHeader, UnknownExtensionsAreSkippedBrokenOnesRefused) {
  const auto bytes = write_header(two_objects()).value();
  EXPECT_TRUE(parse_header(with_extension(bytes, {0x90, 0x01, 3, 1, 2, 3, 7, 0})));
  const auto broken = parse_header(with_extension(bytes, {5, 9, 1}));
  ASSERT_FALSE(broken);
  EXPECT_STREQ(broken.error().rule, "R-STR-16");
  EXPECT_EQ(broken.error().code, Errc::malformed);
}

TEST(StreamHeader, LimitsApplyBeforeAllocation) {
  const auto bytes = write_header(two_objects()).value();
  DecodeLimits limits;
  limits.objects = 1;
  const auto few = parse_header(bytes, limits);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, Errc::limit_exceeded);
  limits = {};
  limits.header_bytes = 10;
  EXPECT_STREQ(parse_header(bytes, limits).error().rule, "R-STR-14");
}

/// Meshes of one vertex whose states hold the largest models.
StreamHeader with_models(int meshes) {
  StreamHeader header;
  header.baseline_span = 64;
  for (int i = 0; i < meshes; ++i) {
    DeformableObject& mesh = header.meshes.emplace_back();
    mesh.name = std::to_string(i);
    mesh.profile = DeformableProfile::thesis;
    mesh.quant_bits = 12;
    mesh.models_kept = true;
    mesh.rest = {{0, 0, 0}};
  }
  return header;
}

TEST(StreamHeader, StatesAreLimitedBeforeAnythingIsBuilt) {
  EXPECT_EQ(state_bytes(with_models(226)), 226u * 1183992);
  EXPECT_TRUE(write_header(with_models(226)));
  EXPECT_STREQ(write_header(with_models(227)).error().rule, "R-STR-18");
  const auto bytes = write_header(with_models(10)).value();
  EXPECT_TRUE(parse_header(bytes, {.state_bytes = 10 * 1183992}));
  const auto refused = parse_header(bytes, {.state_bytes = 10 * 1183992 - 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::limit_exceeded);
  EXPECT_STREQ(refused.error().rule, "R-STR-18");
}

TEST(StreamHeader, VerticesAndTrianglesOfAllMeshesCount) {
  StreamHeader header;
  for (const char* name : {"a", "b"}) {
    DeformableObject& mesh = header.meshes.emplace_back();
    mesh.name = name;
    mesh.rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
  }
  const auto bytes = write_header(header).value();
  EXPECT_TRUE(parse_header(bytes, {.vertices = 6, .triangles = 2}));
  EXPECT_STREQ(parse_header(bytes, {.vertices = 5}).error().rule, "R-STR-14");
  EXPECT_STREQ(parse_header(bytes, {.triangles = 1}).error().rule, "R-STR-14");
}

TEST(StreamHeader, EveryPrefixIsTruncated) {
  const auto bytes = write_header(two_objects()).value();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto parsed = parse_header(std::span(bytes).first(size));
    ASSERT_FALSE(parsed) << size;
    EXPECT_EQ(parsed.error().code, Errc::truncated) << size;
  }
}

TEST(StreamHeader, EveryFlippedBitIsNoticed) {
  const auto bytes = write_header(two_objects()).value();
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    auto damaged = bytes;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1 << (bit % 8));
    EXPECT_FALSE(parse_header(damaged)) << "bit " << bit;
  }
}

}  // namespace
}  // namespace tactus
