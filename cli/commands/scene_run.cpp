// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/scene_run.h"
#include "cli/commands/input.h"

#include <fmt/format.h>
#include <filesystem>
#include <system_error>
#include <utility>

#include <tactus/base/shown.h>
#include <tactus/client/stiffness_reduction.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::cli {

// ==== replay ====

tl::expected<TraceReader, Failure> open_replay(const std::string& path, Visibility progress) {
  auto reader = open_trace(path, progress);
  if (!reader) return tl::unexpected(reader.error());
  const TraceInfo& info = reader->info();
  if (info.users.empty()) return refuse(shown_path(path) + ": nobody is in this trace", "Give a trace with a user.");
  if (info.tick_rate != sim::kTickRate)
    return refuse(fmt::format("{}: {} ticks per second, not {}", shown_path(path), info.tick_rate, sim::kTickRate),
                  fmt::format("`tactus resample --rate {}` makes one that fits.", sim::kTickRate));
  return std::move(*reader);
}

std::vector<DeviceSample> recorded_devices(const TraceReader& recording, const TraceFrame& frame) {
  std::vector<DeviceSample> devices;
  for (std::size_t i = 0; i < frame.users.size(); ++i) {
    DeviceSample& device = devices.emplace_back(frame.users[i].device);
    if (!recording.info().users[i].senses.buttons) device.buttons = frame.users[i].contact.kind == ContactKind::spring ? 1 : 0;
  }
  return devices;
}

// ==== tolerable scene ====

bool TolerableScene::is_meant(const std::string& argument) {
  if (argument.ends_with(".toml")) return true;
  std::error_code ignored;
  return !std::filesystem::exists(argument, ignored) && sim::find_scene(argument).has_value();
}

tl::expected<TolerableScene, Failure> TolerableScene::create(const std::string& name, std::uint64_t seed) {
  const auto path = sim::find_scene(name);
  if (!path) return refuse(path.error());
  auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  if (scene->users.empty()) return refuse(name + ": nobody is in this scene", "Give one with a user.");
  auto simulation = sim::Simulation::create(*scene, {.seed = seed, .grip = {}, .channel = {}});
  if (!simulation) return refuse(name, simulation.error());
  auto kept = std::make_unique<sim::Scene>(std::move(*scene));
  std::vector<sim::StiffnessMap> maps;
  for (const sim::SceneDeformable& object : kept->deformables) {
    auto map = sim::stiffness_map(object);
    if (!map) return refuse(name + ": " + object.name, map.error());
    maps.push_back(std::move(*map));
  }
  return TolerableScene(name, std::move(kept), std::move(*simulation), std::move(maps));
}

tl::expected<const TraceFrame*, Failure> TolerableScene::next() {
  const auto stepped = simulation_.step();
  if (!stepped) return refuse(name_, stepped.error().error);
  return &simulation_.frame();
}

double TolerableScene::follows(const DelayTolerance::Pair& pair, const UserSample& user) const noexcept {
  if (pair.is_mesh) {
    const SurfaceContact& at = *user.surface_contact;
    return followed_fraction(maps_[at.mesh].at(at.triangle, at.weights), at.stiffness);
  }
  const std::size_t rigid = scene_->objects.size();
  if (user.contact.object < rigid) return 1;
  return followed_fraction(scene_->msds[user.contact.object - rigid].object.stiffness, user.contact.stiffness);
}

}  // namespace tactus::cli
