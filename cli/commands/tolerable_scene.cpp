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
  auto kept = std::make_unique<sim::Scene>(std::move(*scene));
  auto local = sim::LocalStiffness::create(*kept);
  if (!local) return refuse(name, local.error());
  return TolerableScene(name, std::move(kept), std::move(*simulation), std::move(*local));
}

tl::expected<const TraceFrame*, Failure> TolerableScene::next() {
  const auto stepped = simulation_.step();
  if (!stepped) return refuse(name_, stepped.error().error);
  return &simulation_.frame();
}

double TolerableScene::follows(const DelayTolerance::Pair& pair, const UserSample& user) const noexcept {
  if (pair.is_mesh) return sim::share_followed(local_.at(*user.surface_contact), user.surface_contact->stiffness);
  const auto yields = local_.at(user.contact);
  return yields ? sim::share_followed(*yields, user.contact.stiffness) : 1;
}

}  // namespace tactus::cli
