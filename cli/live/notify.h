// SPDX-License-Identifier: Apache-2.0
/// What a service reports to systemd (sd_notify(3)): that it is ready, how it does, that it lives, that it ends. Without systemd nothing.
#pragma once

#include <cstdint>
#include <string_view>

namespace tactus::cli {

class ServiceManager {
 public:
  /// Of $NOTIFY_SOCKET and $WATCHDOG_USEC.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  void ready(std::string_view status) const;  ///< in  status  one line
  void stopping() const noexcept;
  /// Twice as often as is required.   in  now  [us]   time a comparison
  void alive(std::uint64_t now) noexcept {
    if (watchdog_ > 0 && now >= next_) send_alive(now);
  }

 private:
  void send(std::string_view text) const noexcept;
  void send_alive(std::uint64_t now) noexcept;

  int socket_ = -1;
  std::uint64_t watchdog_ = 0, next_ = 0;  // [us]
};

}  // namespace tactus::cli
