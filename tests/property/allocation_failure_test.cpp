// SPDX-License-Identifier: Apache-2.0
/// Each call of operator new fails once, in everything that is set up: an error (limit_exceeded, R-API-11), no exception, no leak, and
/// what was there before works on.
#include <gtest/gtest.h>

#include <array>
#include <ostream>
#include <streambuf>
#include <utility>
#include <vector>

#include <tactus/tactus.h>
#include "tests/fuzz/strip.h"
#include "tests/property/allocated.h"
#include "tests/property/fail_each.h"

namespace tactus {
namespace {

using testing::fail_allocation;
using testing::fail_each;

StreamHeader rigid_scene() {
  StreamHeader header;
  header.baseline_span = 3;
  header.objects = {{"a name too long for a small string", Dof::all, {}}, {"b", Dof::translation, {}}};
  return header;
}

/// Rigid objects and a mesh.
StreamHeader scene(std::uint8_t choice) {
  StreamHeader header = strip(choice);
  header.objects = rigid_scene().objects;
  return header;
}

constexpr std::array<std::uint8_t, 5> kChoices{0, 1, 2, 3, 134};  // tests/fuzz/strip.h

TEST(AllocationFailure, Headers) {
  for (const std::uint8_t choice : kChoices) {
    const StreamHeader header = scene(choice);
    const auto bytes = write_header(header).value();
    EXPECT_GT(fail_each(bytes, [](const std::vector<std::uint8_t>& b) { return parse_header(b); }), 5u);
    EXPECT_GT(fail_each(bytes, [](const std::vector<std::uint8_t>& b) { return StreamFileReader::open(b); }), 5u);
    EXPECT_GT(fail_each(header, [](const StreamHeader& h) { return write_header(h); }), 3u);
  }
}

TEST(AllocationFailure, DecodersAndReplica) {
  EXPECT_GT(fail_each(rigid_scene(), [](StreamHeader&& h) { return RigidDecoder::create(std::move(h)); }), 3u);
  EXPECT_GT(fail_each(rigid_scene(), [](const StreamHeader& h) { return Replica::create(h); }), 3u);
  for (const std::uint8_t choice : kChoices)
    EXPECT_GT(fail_each(scene(choice), [](StreamHeader&& h) { return DeformableDecoder::create(std::move(h), 0); }), 10u);
}

TEST(AllocationFailure, Encoders) {
  EXPECT_GT(fail_each(rigid_scene(), [](StreamHeader&& h) { return RigidEncoder::create(std::move(h)); }), 3u);
  for (const std::uint8_t choice : kChoices)
    EXPECT_GT(fail_each(scene(choice), [](StreamHeader&& h) { return DeformableEncoder::create(std::move(h), 0); }), 10u);
}

TEST(AllocationFailure, MeshesForHeaders) {
  TriMesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  EXPECT_GT(fail_each(triangle, [](const TriMesh& m) { return make_deformable_object("m", m, 22); }), 1u);
  EXPECT_GT(fail_each(std::vector<double>(9, 1.0), [](const std::vector<double>& v) { return make_mode_basis(v, 1); }), 1u);
  EXPECT_GT(fail_each(triangle,
                      [](const TriMesh& m) -> Result<void> {
                        if (const auto sound = check(m); !sound) return tl::unexpected(sound.error().error);
                        return {};
                      }),
            0u);
}

/// Keeps what is written, in memory that is there from the start.
class Sink : public std::streambuf {
 public:
  Sink() { bytes_.reserve(1 << 16); }
  const std::vector<char>& bytes() const { return bytes_; }

 private:
  int_type overflow(int_type c) override {
    bytes_.push_back(traits_type::to_char_type(c));
    return c;
  }
  std::vector<char> bytes_;
};

/// Writes a file of 20 packets; each call that fails is made again.   in  failing  number of the allocation that fails in each call
std::vector<char> written_file(std::uint64_t failing) {
  Sink sink;
  std::ostream out(&sink);
  auto writer = StreamFileWriter::create(out, rigid_scene()).value();
  const auto insist = [failing](auto call) {
    fail_allocation(failing);
    const Result<void> done = call();
    fail_allocation(0);
    if (done) return;
    EXPECT_STREQ(done.error().rule, "R-API-11");
    EXPECT_TRUE(call());
  };
  for (std::int64_t tick = 0; tick < 20; ++tick) {
    const std::vector<std::uint8_t> packet(static_cast<std::size_t>(10 * tick), std::uint8_t{7});
    insist([&] { return writer.add(tick, packet, tick % 2 == 0); });
  }
  insist([&] { return writer.finish(); });
  return sink.bytes();
}

TEST(AllocationFailure, FilesAreTheSameAfterAnotherTry) {
  const std::vector<char> whole = written_file(0);
  for (std::uint64_t failing = 1; failing < 4; ++failing) EXPECT_EQ(written_file(failing), whole) << "allocation " << failing;
}

}  // namespace
}  // namespace tactus
