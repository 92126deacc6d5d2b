// SPDX-License-Identifier: Apache-2.0
/// Every conformance vector, damaged in every small way: an error with a rule or a decodable stream, nothing else. Check values are
/// also repaired after the damage, so that it reaches the code behind them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/tactus.h>
#include <tactus/thesis/thesis.h>
#include "tests/fuzz/sections.h"
#include "tests/property/allocated.h"
#include "tests/property/earned.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr DecodeLimits kWithThesis{.thesis = &thesis_component};

/// Files up to a size are damaged at every byte, larger ones at so many. Receivers of deformable objects take longer to set up; streams
/// for clients are many, and much like others to a receiver.
struct Offsets {
  std::size_t every_byte_of = 4096, sample = 400;
};
constexpr Offsets kOfDeformables{256, 20}, kOfClients{128, 40};

Bytes read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return Bytes{std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> vectors() {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(TACTUS_VECTORS)) {
    if (entry.path().extension() == ".tct") out.push_back(entry.path());
  }
  std::ranges::sort(out);
  return out;
}

bool has_rule(const Error& error) { return error.code <= Errc::state && std::string_view(error.rule).starts_with("R-"); }

/// The declaration announces deformable objects.
bool has_deformables(std::span<const std::uint8_t> file) {
  constexpr std::size_t kFlags = 6;
  return file.size() > kFlags && (file[kFlags] & 1) != 0;
}

/// Of all substreams.
std::uint64_t state_hash(const Receiver& receiver) {
  Fnv1a hash;
  for (std::size_t i = 0; i <= receiver.scene()->deformables.size() + (receiver.scene()->loads ? 1 : 0); ++i)
    hash.add64(receiver.state_hash(i));
  return hash.value();
}

/// Null, or what went wrong with this packet.
const char* survive_packet(Receiver& receiver, const FilePacket& packet) {
  const std::uint64_t before = state_hash(receiver);
  const auto decoded = receiver.push(packet.number, packet.bytes);
  if (decoded) return nullptr;
  if (!has_rule(decoded.error())) return "a refused packet without a rule";
  return state_hash(receiver) == before ? nullptr : "a refused packet changes the state";
}

/// Null, or what went wrong with this file. Fails are texts and not EXPECTs, which would take most of the time.
const char* survive(std::span<const std::uint8_t> bytes) {
  const auto exact = std::make_unique_for_overwrite<std::uint8_t[]>(bytes.size());
  std::ranges::copy(bytes, exact.get());
  const std::uint64_t start = testing::allocated_bytes();
  auto reader = StreamFileReader::open({exact.get(), bytes.size()}, kWithThesis);
  if (!reader) {
    if (testing::allocated_bytes() - start > testing::earned_by_refused(bytes.size(), has_deformables(bytes)))
      return "a refused declaration allocates too much";
    return has_rule(reader.error()) ? nullptr : "a refused declaration without a rule";
  }
  auto receiver = Receiver::create(reader->scene());
  if (!receiver) return "a declaration is accepted by the reader, not by the receiver";
  const std::uint64_t ready = testing::allocated_bytes();
  if (ready - start > testing::earned(bytes.size(), *reader->scene())) return "set-up allocates too much";
  reader->seek(1000);
  reader->seek(0);
  for (;;) {
    const auto packet = reader->next();
    if (testing::allocated_bytes() != ready) return "reading allocates";
    if (!packet) return has_rule(packet.error()) ? nullptr : "a refused record without a rule";
    if (!*packet) return nullptr;
    const char* wrong = survive_packet(*receiver, **packet);
    if (testing::allocated_bytes() != ready) return "decoding allocates";
    if (wrong) return wrong;
  }
}

Bytes repaired(Bytes file) {
  testing::repair(file);
  return file;
}

std::vector<std::size_t> offsets(std::size_t size, std::uint64_t seed, const Offsets& which) {
  std::vector<std::size_t> out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = i;
  if (size <= which.every_byte_of) return out;
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < which.sample; ++i) std::swap(out[i], out[i + random() % (size - i)]);
  out.resize(which.sample);
  return out;
}

class EveryVector : public ::testing::TestWithParam<const char*> {
 protected:
  template <class Damage>
  void each_offset(Damage damage) {
    std::size_t files = 0;
    for (const fs::path& path : vectors()) {
      if (path.parent_path().filename() != GetParam()) continue;
      ++files;
      const Bytes file = read_file(path);
      const bool is_of_client = path.parent_path().filename() == "client" || path.parent_path().filename() == "thesis";
      const Offsets rigid = is_of_client ? kOfClients : Offsets{};
      for (const std::size_t at : offsets(file.size(), files, has_deformables(file) ? kOfDeformables : rigid)) {
        const char* wrong = damage(file, at);
        ASSERT_EQ(wrong, nullptr) << path << " byte " << at << ": " << wrong;
      }
    }
    EXPECT_GT(files, 10u);
  }
};

TEST_P(EveryVector, EveryPrefix) {
  each_offset([](const Bytes& file, std::size_t at) { return survive(std::span(file).first(at)); });
}

TEST_P(EveryVector, EveryBitFlipped) {
  each_offset([](const Bytes& file, std::size_t at) -> const char* {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes damaged = file;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 1u << bit);
      if (const char* wrong = survive(damaged)) return wrong;
      if (const char* wrong = survive(repaired(damaged))) return wrong;
    }
    return nullptr;
  });
}

TEST_P(EveryVector, EveryByteZeroOrOnes) {
  each_offset([](const Bytes& file, std::size_t at) -> const char* {
    for (const std::uint8_t value : {std::uint8_t{0x00}, std::uint8_t{0xff}}) {
      Bytes damaged = file;
      damaged[at] = value;
      if (const char* wrong = survive(repaired(damaged))) return wrong;
    }
    return nullptr;
  });
}

TEST_P(EveryVector, OneByteMore) {
  for (const fs::path& path : vectors()) {
    if (path.parent_path().filename() != GetParam()) continue;
    for (const std::uint8_t value : {std::uint8_t{0x00}, std::uint8_t{0x01}, std::uint8_t{0xff}}) {
      Bytes longer = read_file(path);
      longer.push_back(value);
      const char* wrong = survive(longer);
      EXPECT_EQ(wrong, nullptr) << path << ": " << wrong;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Hostile, EveryVector,
                         ::testing::Values("scene", "file", "packet", "range", "rigid", "client", "deformable", "thesis"),
                         [](const auto& stem) { return std::string(stem.param); });

TEST(Hostile, TheCounterCounts) {
  const std::uint64_t before = testing::allocated_bytes();
  ::operator delete(::operator new(1000));  // called by name: a new expression may be optimised away
  EXPECT_EQ(testing::allocated_bytes() - before, 1000u);
}

TEST(Hostile, LimitsAreKept) {
  SceneSpec spec;
  spec.objects = {{"a", Dof::all, {}}, {"b", Dof::all, {}}};
  const SharedScene scene = Scene::create(std::move(spec)).value();
  const Bytes bytes = write_scene(*scene).value();
  EXPECT_STREQ(parse_scene(bytes, {.objects = 1}).error().rule, "R-STR-14");
  EXPECT_STREQ(parse_scene(bytes, {.header_bytes = 20}).error().rule, "R-STR-14");
  EXPECT_STREQ(Receiver::create(scene, {.replica = {}, .limits = {.objects = 1}}).error().rule, "R-STR-14");
  EXPECT_STREQ(Receiver::create(scene, {.replica = {}, .limits = {.state_bytes = 300}}).error().rule, "R-STR-18");
  auto receiver = Receiver::create(scene, {.replica = {}, .limits = {.packet_bytes = 8}}).value();
  const auto too_long = receiver.push(1, Bytes(9, 1));
  ASSERT_FALSE(too_long);
  EXPECT_EQ(too_long.error().code, Errc::limit_exceeded);
  EXPECT_STREQ(too_long.error().rule, "R-PKT-1");
}

}  // namespace
}  // namespace tactus
