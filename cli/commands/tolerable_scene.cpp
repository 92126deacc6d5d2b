// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/tolerable_scene.h"

#include <filesystem>
#include <system_error>
#include <utility>

namespace tactus::cli {

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
  TolerableScene out(name, std::move(*scene), std::move(*simulation));
  for (const sim::SceneDeformable& object : out.scene_.deformables) {
    auto map = sim::stiffness_map(object);
    if (!map) return refuse(name, object.name, map.error());
    out.maps_.push_back(std::move(*map));
  }
  return out;
}

tl::expected<const TraceFrame*, Failure> TolerableScene::next() {
  const auto stepped = simulation_.step();
  if (!stepped) return refuse(name_, stepped.error().error);
  return &simulation_.frame();
}

double TolerableScene::follows(const DelayTolerance::Pair& pair, const UserSample& user) const noexcept {
  if (pair.is_mesh) {
    const SurfaceContact& at = *user.surface_contact;
    return at.stiffness / (at.stiffness + maps_[at.mesh].at(at.triangle, at.weights));
  }
  if (user.contact.object < scene_.objects.size()) return 1;
  const double object = scene_.msds[user.contact.object - scene_.objects.size()].object.stiffness;
  return user.contact.stiffness / (user.contact.stiffness + object);
}

}  // namespace tactus::cli
