// SPDX-License-Identifier: Apache-2.0
/// Datagrams that are lost one after the other, and how long they leave the client without a state. spec/70-session.md section 8. Internal
/// to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tactus {

class LossBursts {
 public:
  /// A datagram came.   in   tick  highest of its packets, if it has any   pre  `now` [us] never decreases
  void heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept;
  /// Ticks from the state before to the state after two thirds of the bursts, at most; 0: most losses are single ones.
  /// in   longest  [ticks]; longer ones are outages, which no delay bridges      time O(1024)
  std::int64_t bridge(std::int64_t longest, std::uint64_t now) noexcept;

 private:
  static constexpr std::size_t kRemembered = 1024;
  struct Datagram {
    std::uint64_t number = 0, at = 0;  // at [us]
    std::optional<std::int64_t> tick;
  };
  std::uint64_t newest_old(std::uint64_t now) const noexcept;

  std::array<Datagram, kRemembered> datagrams_{};
  std::array<std::int64_t, kRemembered> spans_{};
  std::uint64_t newest_ = 0;
};

}  // namespace tactus
