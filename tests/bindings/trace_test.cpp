// SPDX-License-Identifier: Apache-2.0
/// tactus_trace.h returns what the C++ library returns of a trace, and refuses what is wrong.
#include <tactus_trace.h>

#include <tactus/metrics/deformable_errors.h>
#include <tactus/metrics/errors.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/thesis/thesis.h>
#include <tactus/trace/trace_scene.h>

#include <filesystem>

#include "tests/bindings/sizes.h"
#include "tests/unit/trace_fixture.h"

namespace tactus::c_test {

template <>
inline constexpr auto init<tactus_trace_coding> =
    [](tactus_trace_coding* coding, std::size_t size) { return tactus_trace_init(TACTUS_TRACE_CODING, coding, size); };
template <>
inline constexpr auto init<tactus_errors_options> =
    [](tactus_errors_options* options, std::size_t size) { return tactus_trace_init(TACTUS_ERRORS_OPTIONS, options, size); };

namespace {

using Trace = std::unique_ptr<tactus_trace, Destroy<tactus_trace_destroy>>;
using Errors = std::unique_ptr<tactus_errors, Destroy<tactus_errors_destroy>>;

constexpr std::size_t kFrames = 60;

/// A recording with a sheet whose shape is new in every third frame and that one user touches.
Recording recording_with_sheet() {
  Recording out = make_recording(kFrames);
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  out.info.meshes.push_back({.name = "sheet", .rest = mesh, .fixed = {3}, .period = 3});
  out.frames[0].objects[0].pose.rotation = {1, 0, 0, 0};  // what a scene begins with is a rotation
  std::vector<float> shape(12);
  for (std::size_t i = 0; i < kFrames; ++i) {
    if (i % 3 == 0) shape[2] = 1e-3F * static_cast<float>(i + 1);
    out.frames[i].meshes.push_back({.updated = i % 3 == 0, .displacements = shape});
    if (i < 30) continue;
    const Vec3 device = out.frames[i].users[1].device.position;
    out.frames[i].users[1].surface_contact = SurfaceContact{0, 1, {0.5, 0.25, 0.25}, device + Vec3{0, 0, 2e-3}, {0, 0, 1}, 400};
    out.frames[i].users[1].contact.kind = ContactKind::none;
  }
  return out;
}

Trace open(const std::string& path) {
  tactus_trace* raw = nullptr;
  EXPECT_EQ(tactus_trace_open(path.c_str(), nullptr, 0, &raw, nullptr), TACTUS_OK);
  return Trace(raw);
}

bool go_on(const Trace& trace, std::int64_t& tick) {
  return tactus_trace_next(trace.get(), &tick, nullptr, 0, nullptr, 0, nullptr) == TACTUS_OK;
}

class CTrace : public ::testing::Test {
 protected:
  CTrace() { write_recording(recording, file.path()); }

  Recording recording = recording_with_sheet();
  TempFile file;
};

TEST_F(CTrace, ReportsWhatTheTraceHolds) {
  const Trace trace = open(file.path());
  auto info = sized<tactus_trace_info>();
  ASSERT_EQ(tactus_trace_get(trace.get(), &info, nullptr), TACTUS_OK);
  EXPECT_EQ(info.tick_rate, 1000u);
  EXPECT_EQ(info.objects, 2u);
  EXPECT_EQ(info.users, 2u);
  EXPECT_EQ(info.meshes, 1u);
  EXPECT_EQ(info.has_frames, 1u);
  EXPECT_EQ(info.frames, kFrames);
  EXPECT_STREQ(info.source, "test");
  auto object = sized<tactus_trace_object>();
  ASSERT_EQ(tactus_trace_get_object(trace.get(), 1, &object, nullptr), TACTUS_OK);
  EXPECT_STREQ(object.name, recording.info.objects[1].name.c_str());
  EXPECT_EQ(object.dof, std::uint32_t{TACTUS_DOF_NONE});
  auto user = sized<tactus_trace_user>();
  ASSERT_EQ(tactus_trace_get_user(trace.get(), 0, &user, nullptr), TACTUS_OK);
  EXPECT_STREQ(user.name, "left");
  EXPECT_EQ(user.senses, 15u);
  ASSERT_EQ(tactus_trace_get_user(trace.get(), 1, &user, nullptr), TACTUS_OK);
  EXPECT_EQ(user.senses, 0u);
  auto mesh = sized<tactus_trace_mesh>();
  ASSERT_EQ(tactus_trace_get_mesh(trace.get(), 0, &mesh, nullptr), TACTUS_OK);
  EXPECT_STREQ(mesh.name, "sheet");
  EXPECT_EQ(mesh.vertices, 4u);
  EXPECT_EQ(mesh.triangles, 2u);
  EXPECT_EQ(mesh.fixed, 1u);
  EXPECT_EQ(mesh.period, 3);
  EXPECT_EQ(mesh.rest[3], 0.1);
  EXPECT_EQ(mesh.rest[10], 0.1);
  EXPECT_EQ(mesh.corners[5], 3u);
}

TEST_F(CTrace, ReturnsWhichForcesOfAUserItKnows) {
  const std::pair<RecordedForces, std::uint32_t> cases[] = {{RecordedForces::both, TACTUS_FORCE_RENDERED | TACTUS_FORCE_SERVER},
                                                            {RecordedForces::rendered, TACTUS_FORCE_RENDERED},
                                                            {RecordedForces::server, TACTUS_FORCE_SERVER}};
  for (const auto& [known, given] : cases) {
    recording.info.users[1].forces = known;
    const TempFile again;
    write_recording(recording, again.path());
    const Trace trace = open(again.path());
    auto user = sized<tactus_trace_user>();
    ASSERT_EQ(tactus_trace_get_user(trace.get(), 1, &user, nullptr), TACTUS_OK);
    EXPECT_EQ(user.forces, given);
  }
}

TEST_F(CTrace, ReadsEveryFrame) {
  const Trace trace = open(file.path());
  tactus_rigid_sample objects[2];
  tactus_user_sample users[2];
  std::int64_t tick = 0;
  for (const TraceFrame& frame : recording.frames) {
    ASSERT_EQ(tactus_trace_next(trace.get(), &tick, objects, 2, users, 2, nullptr), TACTUS_OK);
    ASSERT_EQ(tick, frame.tick);
    EXPECT_EQ(objects[0].pose.position[1], frame.objects[0].pose.position.y);
    EXPECT_EQ(objects[0].pose.rotation[0], frame.objects[0].pose.rotation.w);
    EXPECT_EQ(objects[0].velocity[2], frame.objects[0].velocity.z);
    EXPECT_EQ(users[0].contact.kind, static_cast<int>(frame.users[0].contact.kind));
    EXPECT_EQ(users[0].device.buttons, frame.users[0].device.buttons);
    EXPECT_EQ(users[0].device.time, frame.users[0].device.time);
    EXPECT_EQ(users[0].force[0], frame.users[0].force.x);
    EXPECT_EQ(users[0].server_force[2], frame.users[0].server_force.z);
    ASSERT_EQ(users[1].touches_mesh != 0, frame.users[1].surface_contact.has_value());
    tactus_shape shape;
    ASSERT_EQ(tactus_trace_shape(trace.get(), 0, &shape, nullptr), TACTUS_OK);
    ASSERT_EQ(shape.displacements != nullptr, frame.meshes[0].updated);
    if (frame.meshes[0].updated) {
      EXPECT_EQ(shape.displacements[2], frame.meshes[0].displacements[2]);
    }
    EXPECT_EQ(shape.touched != 0, frame.users[1].surface_contact.has_value());
    if (!frame.users[1].surface_contact) continue;
    EXPECT_EQ(users[1].triangle, 1u);
    EXPECT_EQ(users[1].weights[0], 0.5);
    EXPECT_EQ(users[1].mesh_stiffness, 400);
    EXPECT_EQ(shape.triangle, 1u);
    EXPECT_EQ(shape.stiffness, 400);
    EXPECT_NEAR(shape.force, 0.8, 1e-9);
  }
  EXPECT_EQ(tactus_trace_next(trace.get(), &tick, objects, 2, users, 2, nullptr), TACTUS_NOTHING);
  EXPECT_EQ(tactus_trace_next(trace.get(), &tick, objects, 2, users, 2, nullptr), TACTUS_NOTHING);
  auto end = sized<tactus_trace_info>();
  ASSERT_EQ(tactus_trace_get(trace.get(), &end, nullptr), TACTUS_OK);
  EXPECT_EQ(end.cut_short, 0u);
}

TEST_F(CTrace, BecomesASceneThatDeclaresBounds) {
  const Trace trace = open(file.path());
  auto coding = filled<tactus_trace_coding>();
  auto rigid = filled<tactus_rigid_bounds>();
  rigid.visual_position = 0.001;
  coding.rigid = &rigid;
  coding.rigid_profile = TACTUS_PROFILE_THESIS;
  coding.deformable_profile = TACTUS_PROFILE_THESIS;
  coding.baselines = 7;
  std::size_t size = 0;
  ASSERT_EQ(tactus_trace_scene(trace.get(), &coding, nullptr, 0, &size, nullptr), TACTUS_BUFFER_TOO_SMALL);
  std::vector<std::uint8_t> bytes(size);
  ASSERT_EQ(tactus_trace_scene(trace.get(), &coding, bytes.data(), size, &size, nullptr), TACTUS_OK);
  const auto scene = parse_scene(bytes, {.thesis = &thesis_component}).value().scene;
  EXPECT_FALSE(scene->is_smoothed);
  EXPECT_EQ(scene->deformables.at(0).profile, DeformableProfile::thesis);
  EXPECT_EQ(scene->baseline_span, 7);
  ASSERT_TRUE(scene->bounds && scene->bounds->rigid);
  EXPECT_EQ(scene->bounds->rigid->visual_position, 0.001);
  EXPECT_EQ(scene->deformables.at(0).name, "sheet");
  coding.baselines = 256;
  EXPECT_REFUSED("R-API-4", tactus_trace_scene, trace.get(), &coding, nullptr, 0, &size);
  coding = filled<tactus_trace_coding>();
  coding.rigid_profile = 2;
  EXPECT_REFUSED("R-API-4", tactus_trace_scene, trace.get(), &coding, nullptr, 0, &size);
  std::int64_t tick = 0;
  ASSERT_TRUE(go_on(trace, tick));
  EXPECT_REFUSED("R-API-12", tactus_trace_scene, trace.get(), nullptr, nullptr, 0, &size);  // the first frame is gone
}

/// As `tactus encode --tune clusters=N` does: found on the whole trace, which is then read from its front.
TEST_F(CTrace, ClustersAreFoundOnIt) {
  const Trace trace = open(file.path());
  auto coding = filled<tactus_trace_coding>();
  coding.clusters = 1;
  std::vector<std::uint8_t> bytes(1 << 12);
  std::size_t size = 0;
  ASSERT_EQ(tactus_trace_scene(trace.get(), &coding, bytes.data(), bytes.size(), &size, nullptr), TACTUS_OK);
  const auto scene = parse_scene(std::span(bytes).first(size)).value().scene;
  TraceReader reader = TraceReader::open(file.path()).value();
  EXPECT_EQ(scene->deformables.at(0).cluster_basis, find_clusters(reader, 1).value().at("sheet"));
  std::int64_t tick = -1;
  ASSERT_TRUE(go_on(trace, tick));
  EXPECT_EQ(tick, recording.frames[0].tick);
  const Trace again = open(file.path());
  coding.clusters = 65;
  EXPECT_REFUSED("R-API-4", tactus_trace_scene, again.get(), &coding, nullptr, 0, &size);
  coding.clusters = 1;
  std::filesystem::remove(file.path());
  EXPECT_REFUSED("R-TRC-1", tactus_trace_scene, again.get(), &coding, nullptr, 0, &size);
}

TEST_F(CTrace, ErrorsAreThoseOfTheLibrary) {
  const Trace trace = open(file.path());
  tactus_errors* raw = nullptr;
  ASSERT_EQ(tactus_errors_create(trace.get(), nullptr, &raw, nullptr), TACTUS_OK);
  const Errors errors(raw);
  ErrorMetrics rigid(recording.info, {});
  DeformableErrors sheet(recording.info.meshes[0].rest, {}, 3, 22);
  std::int64_t tick = 0;
  const std::vector<float> shown(12);
  for (const TraceFrame& frame : recording.frames) {
    ASSERT_TRUE(go_on(trace, tick));
    std::vector<Pose> poses;
    tactus_pose given[2];
    for (std::size_t i = 0; i < 2; ++i) {
      Pose pose = frame.objects[i].pose;
      pose.position.x += 1e-4 * static_cast<double>(frame.tick);
      poses.push_back(pose);
      const auto& [p, q] = pose;
      given[i] = {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
    }
    const tactus_shape shape{shown.data(), 4, 0, 0, 0, 0};
    ASSERT_EQ(tactus_errors_add(raw, trace.get(), given, 2, &shape, 1, nullptr), TACTUS_OK);
    rigid.add(frame, poses);
    if (!frame.meshes[0].updated) continue;
    std::optional<SurfaceTouch> touch;
    if (frame.users[1].surface_contact) touch = SurfaceTouch{1, 400 * 2e-3, 400};
    sheet.add(frame.meshes[0].displacements, std::span(shown), touch);
  }
  const ErrorSeries* series[] = {&rigid.position(), &rigid.rotation(), &rigid.force(), &rigid.perceived()};
  for (std::uint32_t i = 0; i < 4; ++i) {
    auto summary = sized<tactus_error_summary>();
    ASSERT_EQ(tactus_errors_get(raw, i, 9, &summary, nullptr), TACTUS_OK);
    EXPECT_EQ(summary.ticks, series[i]->ticks()) << i;
    EXPECT_EQ(summary.ticks_over, series[i]->ticks_over()) << i;
    EXPECT_EQ(summary.longest_run, series[i]->longest_run()) << i;
    EXPECT_EQ(summary.rms, series[i]->rms()) << i;
    EXPECT_EQ(summary.max, series[i]->max()) << i;
    EXPECT_EQ(summary.worst_ratio, i == TACTUS_ERROR_FORCE ? rigid.worst_haptic_ratio() : 0) << i;
  }
  EXPECT_GT(rigid.position().ticks_over(), 0u);
  auto mesh = sized<tactus_error_summary>();
  ASSERT_EQ(tactus_errors_get(raw, TACTUS_ERROR_SHAPE, 0, &mesh, nullptr), TACTUS_OK);
  EXPECT_EQ(mesh.ticks, kFrames / 3);
  EXPECT_EQ(mesh.vertices, 4 * kFrames / 3);
  EXPECT_EQ(mesh.violations, sheet.all().violations);
  EXPECT_EQ(mesh.max, sheet.all().max);
  EXPECT_EQ(mesh.rms, std::sqrt(sheet.all().mse()));
  EXPECT_NEAR(mesh.worst_ratio, sheet.worst_ratio(), 1e-9 * sheet.worst_ratio());
  EXPECT_GT(mesh.violations, 0u);
}

TEST_F(CTrace, Refuses) {
  const Trace trace = open(file.path());
  tactus_trace* other = nullptr;
  tactus_errors* errors = nullptr;
  auto info = sized<tactus_trace_info>();
  auto object = sized<tactus_trace_object>();
  auto user = sized<tactus_trace_user>();
  auto mesh = sized<tactus_trace_mesh>();
  auto summary = sized<tactus_error_summary>();
  std::int64_t tick = 0;
  float shown[12]{};
  tactus_shape shape;
  tactus_rigid_sample objects[2];
  tactus_pose poses[2]{};
  EXPECT_REFUSED("R-API-12", tactus_trace_open, nullptr, nullptr, 0, &other);
  EXPECT_REFUSED("R-API-12", tactus_trace_open, file.path().c_str(), nullptr, 0, nullptr);
  EXPECT_REFUSED("R-API-12", tactus_trace_open, nullptr, nullptr, 5, &other);
  EXPECT_REFUSED("R-TRC-1", tactus_trace_open, "/nowhere/at.mcap", nullptr, 0, &other);
  const std::uint8_t noise[4] = {1, 2, 3, 4};
  EXPECT_REFUSED("R-TRC-2", tactus_trace_open, nullptr, noise, sizeof noise, &other);
  EXPECT_REFUSED("R-API-12", tactus_trace_get, nullptr, &info);
  EXPECT_REFUSED("R-API-12", tactus_trace_get, trace.get(), nullptr);
  EXPECT_REFUSED("R-API-12", tactus_trace_get_object, trace.get(), 2, &object);
  EXPECT_REFUSED("R-API-12", tactus_trace_get_user, trace.get(), 2, &user);
  EXPECT_REFUSED("R-API-12", tactus_trace_get_mesh, trace.get(), 1, &mesh);
  EXPECT_REFUSED("R-API-12", tactus_trace_shape, trace.get(), 0, &shape);  // before the first frame
  EXPECT_REFUSED("R-API-12", tactus_trace_next, trace.get(), &tick, objects, 1, nullptr, 0);
  EXPECT_REFUSED("R-API-12", tactus_trace_next, trace.get(), &tick, nullptr, 2, nullptr, 0);
  EXPECT_REFUSED("R-API-12", tactus_trace_next, nullptr, &tick, nullptr, 0, nullptr, 0);
  auto options = filled<tactus_errors_options>();
  options.position_exp = 31;
  EXPECT_REFUSED("R-API-4", tactus_errors_create, trace.get(), &options, &errors);
  EXPECT_REFUSED("R-API-12", tactus_errors_create, nullptr, nullptr, &errors);
  ASSERT_EQ(tactus_errors_create(trace.get(), nullptr, &errors, nullptr), TACTUS_OK);
  const Errors kept(errors);
  EXPECT_REFUSED("R-API-12", tactus_errors_add, errors, trace.get(), poses, 2, nullptr, 0);  // before the first frame
  ASSERT_TRUE(go_on(trace, tick));
  EXPECT_REFUSED("R-API-5", tactus_errors_add, errors, trace.get(), poses, 1, nullptr, 0);
  EXPECT_REFUSED("R-API-12", tactus_errors_add, errors, trace.get(), nullptr, 2, nullptr, 0);
  shape = {shown, 3, 0, 0, 0, 0};
  EXPECT_REFUSED("R-API-12", tactus_errors_add, errors, trace.get(), nullptr, 0, nullptr, 1);
  EXPECT_REFUSED("R-API-5", tactus_errors_add, errors, trace.get(), nullptr, 0, &shape, 1);
  EXPECT_REFUSED("R-API-5", tactus_errors_add, errors, trace.get(), nullptr, 0, &shape, 0);
  EXPECT_EQ(tactus_errors_add(errors, trace.get(), nullptr, 0, nullptr, 0, nullptr), TACTUS_OK) << "nothing is shown";
  EXPECT_REFUSED("R-API-12", tactus_errors_get, errors, 5, 0, &summary);
  EXPECT_REFUSED("R-API-12", tactus_errors_get, errors, TACTUS_ERROR_SHAPE, 1, &summary);
  tactus_trace_destroy(nullptr);
  tactus_errors_destroy(nullptr);
}

#if SIZE_MAX == UINT64_MAX
TEST_F(CTrace, StructsMayBeOfAnotherVersion) {
  const Trace trace = open(file.path());
  const auto declare = [&](auto* coding, auto* error) {
    std::size_t size = 0;
    const tactus_status status = tactus_trace_scene(trace.get(), coding, nullptr, 0, &size, error);
    return status == TACTUS_BUFFER_TOO_SMALL ? TACTUS_OK : status;
  };
  const auto judge = [&](auto* options, auto* error) {
    tactus_errors* out = nullptr;
    const tactus_status status = tactus_errors_create(trace.get(), options, &out, error);
    tactus_errors_destroy(out);
    return status;
  };
  tactus_errors* raw = nullptr;
  ASSERT_EQ(tactus_errors_create(trace.get(), nullptr, &raw, nullptr), TACTUS_OK);
  const Errors errors(raw);
  for (const SizedCall& call : std::vector<SizedCall>{
           {"trace_info",
            40,
            Direction::answer,
            {},
            taking<tactus_trace_info>([&](auto*i, auto*e) { return tactus_trace_get(trace.get(), i, e); }),
            {48}},
           {"trace_object", 16, Direction::answer, {}, taking<tactus_trace_object>([&](auto*i, auto*e) {
              return tactus_trace_get_object(trace.get(), 0, i, e);
            })},
           {"trace_user",
            16,
            Direction::answer,
            {},
            taking<tactus_trace_user>([&](auto*i, auto*e) { return tactus_trace_get_user(trace.get(), 0, i, e); }),
            {24}},
           {"trace_mesh",
            32,
            Direction::answer,
            {},
            taking<tactus_trace_mesh>([&](auto*i, auto*e) { return tactus_trace_get_mesh(trace.get(), 0, i, e); }),
            {48}},
           {"trace_coding",
            40,
            Direction::option,
            initialised<tactus_trace_coding>(),
            taking<tactus_trace_coding>(declare),
            {48}},
           {"errors_options", 32, Direction::option, initialised<tactus_errors_options>(), taking<tactus_errors_options>(judge)},
           {"error_summary",
            56,
            Direction::answer,
            {},
            taking<tactus_error_summary>([&](auto*s, auto*e) { return tactus_errors_get(raw, 0, 0, s, e); }),
            {72}}})
    check_sizes(call);
}
#endif

TEST_F(CTrace, ACutFileIsReadAsFarAsItGoes) {
  const Bytes whole = file.bytes();
  std::size_t opened = 0, cut = 0;
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    const TempFile piece;
    std::ofstream(piece.path(), std::ios::binary)
        .write(reinterpret_cast<const char*>(whole.data()), static_cast<std::streamsize>(size));
    const auto expected = TraceReader::open(piece.path());
    tactus_trace* raw = nullptr;
    tactus_error error{};
    const tactus_status status = tactus_trace_open(piece.path().c_str(), nullptr, 0, &raw, &error);
    const Trace trace(raw);
    if (!expected) {
      EXPECT_STREQ(error.rule, expected.error().rule) << size;
      continue;
    }
    if (status != TACTUS_OK) continue;  // the first frame is broken
    ++opened;
    std::int64_t tick = 0;
    while (go_on(trace, tick)) {
    }
    auto info = sized<tactus_trace_info>();
    ASSERT_EQ(tactus_trace_get(raw, &info, nullptr), TACTUS_OK);
    cut += info.cut_short;
  }
  EXPECT_GT(opened, 0u);
  EXPECT_GT(cut, 0u);
}

}  // namespace
}  // namespace tactus::c_test
