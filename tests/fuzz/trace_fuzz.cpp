// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a trace file: an error or frames, never a crash, and never a number that is not one.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <tactus/trace/trace_file.h>
#include "tests/fuzz/require.h"

namespace {

constexpr int kMaxFrames = 10'000;  // a mutated chunk may hold many small ones

void check(const tactus::TraceInfo& info, const tactus::TraceFrame& frame) {
  require(frame.objects.size() == info.objects.size() && frame.users.size() == info.users.size());
  require(frame.meshes.size() == info.meshes.size());
  for (const auto& object : frame.objects) {
    require(is_finite(object.pose.position) && is_finite(object.pose.rotation));
    require(is_finite(object.velocity) && is_finite(object.angular_velocity));
  }
  for (const auto& user : frame.users) {
    require(is_valid(user.device) && is_finite(user.contact.device) && is_finite(user.force) && is_finite(user.server_force));
    require(user.contact.kind == tactus::ContactKind::none || user.contact.object < info.objects.size());
    if (!user.surface_contact) continue;
    require(user.surface_contact->mesh < info.meshes.size());
    require(user.surface_contact->triangle < info.meshes[user.surface_contact->mesh].rest.triangles.size());
  }
  for (std::size_t i = 0; i < info.meshes.size(); ++i) {
    const auto& displacements = frame.meshes[i].displacements;
    require(displacements.size() == 3 * info.meshes[i].rest.vertices.size());
    require(std::all_of(displacements.begin(), displacements.end(), [](float value) { return std::isfinite(value); }));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto reader = tactus::TraceReader::open_memory({data, size});
  if (!reader) return 0;
  tactus::TraceFrame frame;
  std::int64_t last_tick = -1;
  for (int i = 0; i < kMaxFrames; ++i) {
    const auto more = reader->next(frame);
    if (!more || !*more) break;
    require(frame.tick > last_tick);
    last_tick = frame.tick;
    check(reader->info(), frame);
  }
  return 0;
}
