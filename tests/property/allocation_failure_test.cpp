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

SceneSpec rigid_scene() {
  SceneSpec spec;
  spec.baseline_span = 3;
  spec.objects = {{"a name too long for a small string", Dof::all, {}}, {"b", Dof::translation, {}}};
  return spec;
}

/// Rigid objects and a deformable one.
SceneSpec scene(std::uint8_t choice) {
  SceneSpec spec = strip(choice);
  spec.objects = rigid_scene().objects;
  return spec;
}

SharedScene shared(SceneSpec&& spec) { return Scene::create(std::move(spec), kStripLimits).value(); }

constexpr std::array<std::uint8_t, 5> kChoices{0, 1, 2, 3, 134};  // tests/fuzz/strip.h

TEST(AllocationFailure, Scenes) {
  for (const std::uint8_t choice : kChoices) {
    EXPECT_GT(fail_each(scene(choice), [](SceneSpec&& s) { return Scene::create(std::move(s), kStripLimits); }), 3u);
    EXPECT_GT(fail_each(scene(choice), [](const SceneSpec& s) { return check_scene(s, kStripLimits); }), 1u);
    const SharedScene sound = shared(scene(choice));
    const auto bytes = write_scene(*sound).value();
    EXPECT_GT(fail_each(bytes, [](const std::vector<std::uint8_t>& b) { return parse_scene(b, kStripLimits); }), 5u);
    EXPECT_GT(fail_each(bytes, [](const std::vector<std::uint8_t>& b) { return StreamFileReader::open(b, kStripLimits); }), 5u);
    EXPECT_GT(fail_each(bytes, [](const std::vector<std::uint8_t>& b) { return Player::open(b, {.limits = kStripLimits}); }),
              10u);
    EXPECT_GT(fail_each(sound, [](const SharedScene& s) { return write_scene(*s); }), 3u);
  }
}

TEST(AllocationFailure, ScenesFromSiUnits) {
  SceneBuilder builder;
  builder.rigid("a name too long for a small string").declare_bounds({}, {});
  builder.deformable("another name too long for a small string", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  EXPECT_GT(fail_each(builder,
                      [](SceneBuilder&& b) -> Result<SharedScene> {
                        auto built = std::move(b).build();
                        if (!built) return tl::unexpected<Error>(built.error());
                        return *built;
                      }),
            5u);
}

TEST(AllocationFailure, Receivers) {
  EXPECT_GT(fail_each(shared(rigid_scene()), [](const SharedScene& s) { return Receiver::create(s); }), 5u);
  for (const std::uint8_t choice : kChoices)
    EXPECT_GT(fail_each(shared(scene(choice)), [](const SharedScene& s) { return Receiver::create(s); }), 15u);
}

TEST(AllocationFailure, Senders) {
  EXPECT_GT(fail_each(shared(rigid_scene()), [](const SharedScene& s) { return Sender::create(s); }), 5u);
  for (const std::uint8_t choice : kChoices)
    EXPECT_GT(fail_each(shared(scene(choice)), [](const SharedScene& s) { return Sender::create(s); }), 15u);
}

TEST(AllocationFailure, SurfacesForScenes) {
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
  auto writer = StreamFileWriter::create(out, *shared(rigid_scene())).value();
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
    insist([&] { return writer.add(tick, static_cast<std::uint64_t>(tick + 1), packet, tick % 2 == 0); });
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
