// SPDX-License-Identifier: Apache-2.0
/// A network between the server and one client per user, as the simulation sees it. Which one it is, and what it is made of, is decided
/// where the simulation is created: without one nothing of sessions is linked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/receiver.h>
#include <tactus/sender.h>
#include <tactus/signal/device_signal.h>

namespace tactus::sim {

class Network {
 public:
  virtual ~Network() = default;

  /// What clients and server say and hear until this tick, then the devices at the clients.
  /// in   devices, contacts  one per participant
  virtual Result<void> to_server(std::int64_t tick, std::span<const DeviceSample> devices,
                                 std::span<const std::optional<DeviceContact>> contacts) = 0;
  /// The devices as the server knows them; one that it has not heard of yet is where it was at first. Valid until the next call.
  virtual std::span<const DeviceSample> heard() const noexcept = 0;
  /// The truth of the tick goes; what takes no time arrives.
  virtual Result<void> to_clients(std::int64_t tick, const Truth& truth) = 0;

  /// What a user's client has to show now.
  struct View {
    Receiver* receiver = nullptr;
    std::int64_t tick = -1;   ///< -1: nothing has come yet
    double force_share = 1;   ///< of a force that may be rendered: less than 1 while the data are old
    std::uint32_t delay = 0;  ///< [ticks] age of what is shown, as an answer to the own device; 0 while it is not known
  };
  virtual View view(std::size_t user) noexcept = 0;
};

/// Makes a network for so many users.
using NetworkMaker = std::function<Result<std::unique_ptr<Network>>(SharedScene, std::size_t users, const SenderOptions&)>;

}  // namespace tactus::sim
