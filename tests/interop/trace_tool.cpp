// SPDX-License-Identifier: Apache-2.0
/// Our end of the interoperability test.
///   trace_tool write FILE   a trace whose numbers trace_interop.mjs can compute by itself
///   trace_tool csv FILE     any trace as CSV on standard output
#include <cstdio>
#include <iostream>
#include <string_view>

#include <tactus/trace/csv.h>
#include <tactus/trace/csv_plan.h>
#include <tactus/trace/trace_file.h>

namespace {

using namespace tactus;

constexpr std::int64_t kTicks = 2500;
constexpr std::uint32_t kTickRate = 1000;
constexpr std::int64_t kDeformationTicks = 10;  // between new shapes of the mesh

/// Exact in binary, different for every tick and slot.
double number(std::int64_t tick, std::size_t slot) {
  return static_cast<double>(tick * 1031 + static_cast<std::int64_t>(slot) * 7 - 5000) / 64;
}

/// Of unit length, exact in decimals, no two components of one axis alike.
Quat turn(std::int64_t tick) {
  constexpr Quat kTurns[] = {{1, 0, 0, 0}, {0.5, -0.5, 0.5, 0.5}, {0, 0.6, 0, -0.8}, {-0.1, 0.7, 0.5, 0.5}, {0.28, 0, -0.96, 0}};
  return kTurns[tick % 5];
}

TraceFrame make_frame(std::int64_t tick) {
  TraceFrame frame{tick, std::vector<RigidSample>(2), std::vector<UserSample>(1)};
  for (std::size_t k = 0; k < kObjectColumns.size(); ++k) kObjectColumns[k].field(frame.objects[0]) = number(tick, k);
  for (std::size_t k = 0; k < 7; ++k) kObjectColumns[k].field(frame.objects[1]) = number(0, 100 + k);  // static: pose only
  frame.objects[0].pose.rotation = turn(tick);
  frame.objects[1].pose.rotation = turn(1);
  const bool touches = tick % 3 == 1;
  const auto fill = [&](const auto& columns, std::size_t slot) {
    for (const auto& column : columns) column.field(frame.users[0]) = number(tick, slot++);
  };
  fill(kDeviceColumns, 200);
  fill(kForceColumns, 203);
  fill(kServerForceColumns, 206);
  if (touches) fill(kTouchColumns, 209);
  frame.users[0].contact.device = frame.users[0].device.position;
  frame.users[0].contact.kind = touches ? ContactKind::spring : ContactKind::none;
  if (touches) frame.users[0].contact.stiffness = 630;
  frame.users[0].device.orientation = turn(tick + 2);
  fill(kDeviceVelocityColumns, 230);
  frame.users[0].device.buttons = static_cast<std::uint32_t>(tick / 4 % 4);
  frame.users[0].device.time = 1'000'003 * tick;
  const auto at = [&](std::size_t slot) { return Vec3{number(tick, slot), number(tick, slot + 1), number(tick, slot + 2)}; };
  if (tick % 4 == 2) frame.users[0].surface_contact = {0, 3, {0.5, 0.375, 0.125}, at(300), at(303), 20};
  DeformableSample shape{tick % kDeformationTicks == 3, std::vector<float>(12)};
  for (std::size_t k = 0; k < 12; ++k) shape.displacements[k] = static_cast<float>(number(tick, 400 + k));
  frame.meshes.push_back(std::move(shape));
  return frame;
}

/// A tetrahedron.
TriMesh make_mesh() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}}; }

Result<void> write(const char* path) {
  TACTUS_TRY(auto writer, TraceWriter::create(path, {kTickRate,
                                                     {{"cube", Dof::all}, {"floor", Dof::none}},
                                                     {{"hand", {true, true, true, true}}},
                                                     "interop",
                                                     "# scene\n",
                                                     {{"blob", make_mesh()}}}));
  for (std::int64_t tick = 0; tick < kTicks; ++tick) TACTUS_CHECK(writer.write(make_frame(tick)));
  return writer.finish();
}

Result<void> print_csv(const char* path) {
  TACTUS_TRY(auto reader, TraceReader::open(path));
  const auto rows = export_csv(reader, std::cout);
  return rows ? Result<void>() : tl::unexpected<Error>(rows.error());
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view command = argc == 3 ? argv[1] : "";
  if (command != "write" && command != "csv") {
    std::fputs("usage: trace_tool write|csv FILE\n", stderr);
    return 2;
  }
  const auto done = command == "write" ? write(argv[2]) : print_csv(argv[2]);
  if (!done) std::fprintf(stderr, "%s: %s %s\n", argv[2], errc_name(done.error().code), done.error().rule);
  return done ? 0 : 1;
}
