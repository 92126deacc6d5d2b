// SPDX-License-Identifier: Apache-2.0
/// Programs and libraries of different versions: structs that are shorter or longer than the other end knows.
#include <tactus_session.h>
#include <tactus_trace.h>

#include "bindings/c/sizes.h"
#include "tests/bindings/sizes.h"

namespace tactus::c_test {

/// The struct in a later version of the library.
template <class T>
struct Grown : T {
  double later = 0;
};

}  // namespace tactus::c_test

namespace tactus::c {

template <class T>
struct Versions<c_test::Grown<T>> {
  static constexpr std::array sizes{sizeof(T), sizeof(c_test::Grown<T>)};
};

}  // namespace tactus::c

namespace tactus::c_test {
namespace {

using Sized =
    ::testing::Types<tactus_rigid_bounds, tactus_deformable_bounds, tactus_load_bounds, tactus_limits, tactus_packet_info,
                     tactus_scene_info, tactus_rigid_info, tactus_deformable_info, tactus_receiver_options, tactus_scene_options,
                     tactus_deformable_options, tactus_driven_physics, tactus_elastic_physics, tactus_sender_options,
                     tactus_rigid_options, tactus_mesh_arrays, tactus_player_info, tactus_encoded, tactus_truth, tactus_event,
                     tactus_session_status, tactus_server_options, tactus_client_options, tactus_trace_info, tactus_trace_object,
                     tactus_trace_user, tactus_trace_mesh, tactus_trace_coding, tactus_errors_options, tactus_error_summary>;

/// On the heap, where a sanitizer sees what goes beyond.
std::vector<std::uint8_t> block(std::size_t size, std::uint8_t filling) {
  std::vector<std::uint8_t> out(size, filling);
  const auto stated = static_cast<std::uint32_t>(size);
  std::memcpy(out.data(), &stated, sizeof stated);
  out.shrink_to_fit();
  return out;
}

template <class T>
T* as(std::vector<std::uint8_t>& bytes) {
  return reinterpret_cast<T*>(bytes.data());
}

template <class T>
class AnOlderProgram : public ::testing::Test {};
TYPED_TEST_SUITE(AnOlderProgram, Sized);

TYPED_TEST(AnOlderProgram, HasTheDefaultsOfWhatItDoesNotKnow) {
  auto bytes = block(sizeof(TypeParam), 0x5a);
  if constexpr (requires(TypeParam & given) { given.reserved; }) as<TypeParam>(bytes)->reserved = 0;
  Grown<TypeParam> defaults{};
  defaults.later = 7;
  const auto taken = c::given_or(as<const Grown<TypeParam>>(bytes), defaults);
  ASSERT_TRUE(taken);
  EXPECT_EQ(std::memcmp(&*taken, bytes.data(), sizeof(TypeParam)), 0);
  EXPECT_EQ(taken->later, 7);
}

TYPED_TEST(AnOlderProgram, GetsAnswersAndDefaultsAsFarAsItsStructGoes) {
  auto bytes = block(sizeof(TypeParam), 0x5a);
  Grown<TypeParam> value{};
  value.later = 7;
  ASSERT_TRUE(c::check_answer(as<Grown<TypeParam>>(bytes)));
  c::answer(as<Grown<TypeParam>>(bytes), value);
  EXPECT_EQ(bytes, block(sizeof(TypeParam), 0));
  std::ranges::fill(bytes, std::uint8_t{0x5a});
  ASSERT_EQ(c::init(as<Grown<TypeParam>>(bytes), bytes.size(), value), TACTUS_OK);
  EXPECT_EQ(bytes, block(sizeof(TypeParam), 0));
}

TYPED_TEST(AnOlderProgram, HasAStructThatWasOneOfAVersion) {
  for (std::size_t size = 4; size <= 4100; ++size) {
    auto bytes = block(size, 0);
    const bool fits = size == sizeof(TypeParam) || (size >= sizeof(Grown<TypeParam>) && size <= 4096);
    EXPECT_EQ(c::given_or(as<const Grown<TypeParam>>(bytes), {}).has_value(), fits) << size;
    EXPECT_EQ(c::check_answer(as<Grown<TypeParam>>(bytes)).has_value(), fits) << size;
  }
}

template <class T>
class ANewerProgram : public ::testing::Test {};
TYPED_TEST_SUITE(ANewerProgram, Sized);

TYPED_TEST(ANewerProgram, MayOnlyLeaveUnsetWhatTheLibraryDoesNotKnow) {
  auto bytes = block(sizeof(Grown<TypeParam>), 0);
  ASSERT_TRUE(c::given_or(as<const TypeParam>(bytes), {}));
  for (std::size_t i = sizeof(TypeParam); i < bytes.size(); ++i) {
    bytes[i] = 1;
    const auto refused = c::given_or(as<const TypeParam>(bytes), {});
    ASSERT_FALSE(refused) << i;
    EXPECT_STREQ(refused.error().rule, "R-API-12");
    bytes[i] = 0;
  }
}

TYPED_TEST(ANewerProgram, ReadsZeroWhereTheLibraryKnowsNothing) {
  auto bytes = block(sizeof(Grown<TypeParam>), 0x5a);
  c::answer(as<TypeParam>(bytes), TypeParam{});
  EXPECT_EQ(bytes, block(sizeof(Grown<TypeParam>), 0));
}

/// The sizes of the first version are here as numbers: a change of one breaks programs of that version.
#if SIZE_MAX == UINT64_MAX
class CSizes : public ::testing::Test {
 protected:
  static Scene scene_with_loads() {
    auto options = filled<tactus_scene_options>();
    options.has_loads = 1;
    return make_scene(true, &options);
  }
  /// Its truth may be empty.
  static Scene sheet_alone() {
    tactus_scene_builder* raw = nullptr;
    EXPECT_EQ(tactus_scene_builder_create(nullptr, &raw, nullptr), TACTUS_OK);
    const Builder builder(raw);
    const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::uint32_t triangle[] = {0, 1, 2};
    EXPECT_EQ(tactus_scene_builder_deformable(raw, "sheet", corners, 3, triangle, 1, nullptr, nullptr), TACTUS_OK);
    tactus_scene* scene = nullptr;
    EXPECT_EQ(tactus_scene_builder_build(raw, &scene, nullptr), TACTUS_OK);
    return Scene(scene);
  }

  const Scene scene = scene_with_loads();
};

TEST_F(CSizes, OfBounds) {
  tactus_scene_builder* raw = nullptr;
  ASSERT_EQ(tactus_scene_builder_create(nullptr, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  const tactus_scene* of = scene.get();
  for (const SizedCall& call : std::vector<SizedCall>{
           {"rigid_bounds", 80, Direction::option, initialised<tactus_rigid_bounds>(),
            taking<tactus_rigid_bounds>(
                [&](auto*b, auto*e) { return tactus_scene_builder_declare_bounds(raw, b, nullptr, nullptr, e); })},
           {"deformable_bounds", 40, Direction::option, initialised<tactus_deformable_bounds>(),
            taking<tactus_deformable_bounds>(
                [&](auto*b, auto*e) { return tactus_scene_builder_declare_bounds(raw, nullptr, b, nullptr, e); })},
           {"load_bounds", 24, Direction::option, initialised<tactus_load_bounds>(),
            taking<tactus_load_bounds>(
                [&](auto*b, auto*e) { return tactus_scene_builder_declare_bounds(raw, nullptr, nullptr, b, e); })},
           {"rigid_bounds stated", 80, Direction::answer, {}, taking<tactus_rigid_bounds>([&](auto*b, auto*e) {
              return tactus_scene_get_bounds(of, b, 0, nullptr, nullptr, e);
            })},
           {"deformable_bounds stated", 40, Direction::answer, {}, taking<tactus_deformable_bounds>([&](auto*b, auto*e) {
              return tactus_scene_get_bounds(of, nullptr, 0, b, nullptr, e);
            })},
           {"load_bounds stated", 24, Direction::answer, {}, taking<tactus_load_bounds>([&](auto*b, auto*e) {
              return tactus_scene_get_bounds(of, nullptr, 0, nullptr, b, e);
            })}})
    check_sizes(call);
}

TEST_F(CSizes, OfADecoder) {
  const tactus_scene* of = scene.get();
  std::size_t size = 0;
  ASSERT_EQ(tactus_scene_write(of, nullptr, 0, &size, nullptr), TACTUS_BUFFER_TOO_SMALL);
  std::vector<std::uint8_t> declaration(size);
  ASSERT_EQ(tactus_scene_write(of, declaration.data(), size, &size, nullptr), TACTUS_OK);
  const auto parse = [&](auto* limits, auto* error) {
    tactus_scene* out = nullptr;
    const tactus_status status = tactus_scene_parse(declaration.data(), size, limits, &out, nullptr, error);
    tactus_scene_destroy(out);
    return status;
  };
  const auto receive = [&](auto* options, auto* error) {
    tactus_receiver* out = nullptr;
    const tactus_status status = tactus_receiver_create(of, options, &out, error);
    tactus_receiver_destroy(out);
    return status;
  };
  for (const SizedCall& call :
       std::vector<SizedCall>{{"limits", 40, Direction::option, initialised<tactus_limits>(), taking<tactus_limits>(parse)},
                              {"receiver_options", 40, Direction::option, initialised<tactus_receiver_options>(),
                               taking<tactus_receiver_options>(receive)},
                              {"scene_info",
                               48,
                               Direction::answer,
                               {},
                               taking<tactus_scene_info>([&](auto*i, auto*e) { return tactus_scene_get(of, i, e); }),
                               {64}},
                              {"rigid_info", 72, Direction::answer, {}, taking<tactus_rigid_info>([&](auto*i, auto*e) {
                                 return tactus_scene_get_rigid(of, 1, i, e);
                               })},
                              {"deformable_info", 56, Direction::answer, {}, taking<tactus_deformable_info>([&](auto*i, auto*e) {
                                 return tactus_scene_get_deformable(of, 0, i, e);
                               })}})
    check_sizes(call);
}

TEST_F(CSizes, OfAnEncoder) {
  const Scene plain = make_scene(true);
  const auto build = [](auto* options, auto* error) {
    tactus_scene_builder* out = nullptr;
    const tactus_status status = tactus_scene_builder_create(options, &out, error);
    tactus_scene_builder_destroy(out);
    return status;
  };
  const auto deform = [](auto* options, auto* error) {
    tactus_scene_builder* out = nullptr;
    EXPECT_EQ(tactus_scene_builder_create(nullptr, &out, nullptr), TACTUS_OK);
    const Builder builder(out);
    const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::uint32_t triangle[] = {0, 1, 2};
    return tactus_scene_builder_deformable(out, "sheet", corners, 3, triangle, 1, options, error);
  };
  const auto add_rigid = [](auto change) {
    return [change](auto* given, auto* error) {
      tactus_scene_builder* out = nullptr;
      EXPECT_EQ(tactus_scene_builder_create(nullptr, &out, nullptr), TACTUS_OK);
      const Builder builder(out);
      auto options = filled<tactus_rigid_options>();
      return tactus_scene_builder_rigid(out, "cube", change(options, given), error);
    };
  };
  const auto drive = add_rigid([](tactus_rigid_options& o, const tactus_driven_physics* physics) {
    o.driven = physics;
    return &o;
  });
  const auto deform_elastic = [&](auto* physics, auto* error) {
    auto options = filled<tactus_deformable_options>();
    options.elastic = physics;
    return deform(&options, error);
  };
  const auto send = [&](auto* options, auto* error) {
    tactus_sender* out = nullptr;
    const tactus_status status = tactus_sender_create(plain.get(), options, &out, error);
    tactus_sender_destroy(out);
    return status;
  };
  const std::vector<std::uint8_t> file = make_stream();
  const auto open = [&] {
    tactus_player* out = nullptr;
    EXPECT_EQ(tactus_player_open(file.data(), file.size(), nullptr, &out, nullptr), TACTUS_OK);
    return Player(out);
  };
  const auto info_of = [&](auto* info, auto* error) { return tactus_player_play(open().get(), INT64_MAX, info, error); };
  const Player player = open();
  const Sender idle = make_sender(sheet_alone());
  std::int64_t next = 0;
  const auto encode_nothing = [&](auto* given, auto* error) {
    auto encoded = sized<tactus_encoded>();
    return tactus_sender_encode(idle.get(), next++, given, &encoded, error);
  };
  for (const SizedCall& call : std::vector<SizedCall>{
           {"scene_options",
            88,
            Direction::option,
            initialised<tactus_scene_options>(),
            taking<tactus_scene_options>(build),
            {104, 120}},
           {"deformable_options",
            112,
            Direction::option,
            initialised<tactus_deformable_options>(),
            taking<tactus_deformable_options>(deform),
            {120}},
           {"rigid_options", 72, Direction::option, initialised<tactus_rigid_options>(),
            taking<tactus_rigid_options>(add_rigid([](auto&, const tactus_rigid_options*given) { return given; }))},
           {"encoded", 40, Direction::answer, {}, taking<tactus_encoded>([&](auto*out, auto*e) {
              auto nothing = sized<tactus_truth>();
              return tactus_sender_encode(idle.get(), next++, &nothing, out, e);
            })},
           {"player_info", 24, Direction::answer, {}, taking<tactus_player_info>([&](auto*i, auto*e) {
              return tactus_player_get(player.get(), i, e);
            })},
           {"mesh_arrays", 48, Direction::option, {}, taking<tactus_mesh_arrays>([&](auto*a, auto*e) {
              return tactus_scene_get_mesh(plain.get(), 0, a, e);
            })},
           {"driven_physics", 72, Direction::option, initialised<tactus_driven_physics>(), taking<tactus_driven_physics>(drive)},
           {"elastic_physics",
            128,
            Direction::option,
            initialised<tactus_elastic_physics>(),
            taking<tactus_elastic_physics>(deform_elastic),
            {136}},
           {"sender_options", 64, Direction::option, initialised<tactus_sender_options>(), taking<tactus_sender_options>(send)},
           {"truth", 72, Direction::option, initialised<tactus_truth>(), taking<tactus_truth>(encode_nothing), {88, 96}},
           {"packet_info", 56, Direction::answer, {}, taking<tactus_packet_info>(info_of)}})
    check_sizes(call);
}

TEST_F(CSizes, OfASession) {
  const tactus_scene* of = scene.get();
  const auto serve = [&](auto* options, auto* error) {
    tactus_server* out = nullptr;
    const tactus_status status = tactus_server_create(of, options, 1, 0, &out, error);
    tactus_server_destroy(out);
    return status;
  };
  const auto join = [](auto* options, auto* error) {
    tactus_client* out = nullptr;
    const tactus_status status = tactus_client_create(options, &out, error);
    tactus_client_destroy(out);
    return status;
  };
  tactus_client* client = nullptr;
  ASSERT_EQ(tactus_client_create(nullptr, &client, nullptr), TACTUS_OK);
  const auto leave = [&](auto* event, auto* error) {
    EXPECT_EQ(tactus_client_open(client, 0, 1, nullptr), TACTUS_OK);
    EXPECT_EQ(tactus_client_close(client, nullptr), TACTUS_OK);
    return tactus_client_poll_event(client, event, error);
  };
  for (const SizedCall& call : std::vector<SizedCall>{
           {"server_options",
            48,
            Direction::option,
            initialised<tactus_server_options>(),
            taking<tactus_server_options>(serve),
            {56}},
           {"client_options",
            64,
            Direction::option,
            initialised<tactus_client_options>(),
            taking<tactus_client_options>(join),
            {80}},
           {"event", 24, Direction::answer, {}, taking<tactus_event>(leave)},
           {"session_status",
            232,
            Direction::answer,
            {},
            taking<tactus_session_status>([&](auto*s, auto*e) { return tactus_client_status(client, 0, s, e); }),
            {256, 368}}})
    check_sizes(call);
  tactus_client_destroy(client);
}
#endif

}  // namespace
}  // namespace tactus::c_test
