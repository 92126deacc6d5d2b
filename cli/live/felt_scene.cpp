// SPDX-License-Identifier: Apache-2.0
#include "cli/live/felt_scene.h"

#include <utility>

namespace tactus::cli {

FeltScene::FeltScene(const sim::Scene& scene, std::size_t user, std::uint64_t seed, const ChosenDevice& device)
    : scene_(scene), user_(user), seed_(seed), hand_(device.hand), origin_(device.in_world ? Vec3{} : scene.users[user].start) {}

Outcome FeltScene::begin() {
  auto simulation = sim::Simulation::create(scene_, {.seed = seed_, .grip = {}, .channel = {}});
  if (!simulation) return refuse(scene_.name, simulation.error());
  simulation_.emplace(std::move(*simulation));
  show();
  return {};
}

tl::expected<Vec3, Failure> FeltScene::step(const device::ServoTick& tick, TraceFrame& frame) {
  DeviceSample sample = tick.reading.sample;
  sample.position = sample.position + origin_;
  if (const auto stepped = simulation_->step(user_, sample); !stepped) return refuse(stepped.error());
  frame = simulation_->frame();
  show();
  return frame.users[user_].force;
}

void FeltScene::show() noexcept {
  if (hand_ != nullptr) hand_->watch(simulation_->watched(user_));
}

}  // namespace tactus::cli
