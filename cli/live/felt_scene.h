// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <tactus/sim/simulation.h>
#include "cli/live/device_choice.h"
#include "cli/live/felt.h"

namespace tactus::cli {

/// A scene, simulated here, that one of its users touches by the device; the others have virtual hands.
class FeltScene final : public Felt {
 public:
  /// in   scene, device  outlive it
  FeltScene(const sim::Scene& scene, std::size_t user, std::uint64_t seed, const ChosenDevice& device);

  Outcome begin() override;
  TraceInfo info() const override { return simulation_->info(); }
  std::size_t user() const noexcept override { return user_; }
  tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) override;

 private:
  void show() noexcept;

  const sim::Scene& scene_;
  std::size_t user_;
  std::uint64_t seed_;
  VirtualDevice* hand_;
  Vec3 origin_{};  // [m] of the device's frame in the world
  std::optional<sim::Simulation> simulation_;
};

}  // namespace tactus::cli
