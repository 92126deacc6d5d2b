// SPDX-License-Identifier: Apache-2.0
/// A link between server and client, and a network that loses nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/packet/packet.h>
#include <tactus/receiver.h>
#include <tactus/sender.h>
#include <tactus/session/device_signal.h>
#include <tactus/sim/random.h>

namespace tactus::sim {

// ==== network ====
// A network between the server and one client per user, as the simulation sees it. Which one it is, and what it is made of, is decided
// where the simulation is created: without one nothing of sessions is linked.

class Network {
 public:
  virtual ~Network() = default;

  /// What clients and server send and hear until this tick, then the devices at the clients.
  /// in   devices, contacts  one per participant
  virtual Result<void> to_server(std::int64_t tick, std::span<const DeviceSample> devices,
                                 std::span<const std::optional<DeviceContact>> contacts) = 0;
  /// The devices as the server knows them; one that it has not heard of yet is where it was at first. Valid until the next call.
  virtual std::span<const DeviceSample> heard() const noexcept = 0;
  /// The truth of the tick goes; what takes no time arrives.
  virtual Result<void> to_clients(std::int64_t tick, const Truth& truth) = 0;
  virtual std::span<const HeldPart> held() const noexcept { return {}; }  ///< SessionServer::held()

  /// What a user's client has to show now.
  struct View {
    Receiver* receiver = nullptr;
    std::int64_t tick = -1;     ///< -1: nothing has come yet
    double force_fraction = 1;  ///< of a force that may be rendered: less than 1 while the data are old
    std::uint32_t delay = 0;    ///< [ticks] age of what is shown, as an answer to the own device; 0 while it is not known
  };
  virtual View view(std::size_t user) noexcept = 0;
};

/// Makes a network for so many users.
using NetworkMaker = std::function<Result<std::unique_ptr<Network>>(SharedScene, std::size_t users, const SenderOptions&)>;

// ==== perfect link ====
// The network between a client and the server: this one takes no time and loses nothing.

class PerfectLink {
 public:
  /// Device samples as the server receives them.
  std::span<const DeviceSample> to_server(std::span<const DeviceSample> devices) const noexcept { return devices; }
  /// Packets as the client receives them.
  std::span<const Packet> to_client(std::span<const Packet> packets) const noexcept { return packets; }
};

// ==== link ====
// One direction of a network that delays, loses, doubles, reorders and holds back datagrams: a pure function of seed and sends.
// No socket and no clock: virtual time, a proxy on loopback and two ends in network namespaces use the same code.
//
// A datagram meets, in this order:  outage -> loss -> queue of the bottleneck -> delay -> duplication.
// Each cause draws from a random stream of its own, as often whether it is switched on or not: adding duplicates leaves the losses
// where they were. Datagrams that are due at the same time arrive in the order of sending.

using Microseconds = std::int64_t;

/// Delay from `time` on, until the next entry.
struct DelayChange {
  Microseconds time = 0;
  Microseconds delay = 0;
};

struct Outage {
  Microseconds begin = 0;
  Microseconds end = 0;  ///< first moment after it
};

/// All parts add up; those at their defaults do nothing.
struct LinkOptions {
  std::uint64_t seed = 1;
  Microseconds delay = 0;   ///< of every datagram
  Microseconds jitter = 0;  ///< uniform within 0 and this, drawn for each datagram: they are reordered

  /// Gamma-distributed delay that keeps its value for a whole piece, so that datagrams of a piece keep their order (thesis 4.2.4.3).
  Microseconds gamma_mean = 0;
  Microseconds gamma_deviation = 0;
  Microseconds gamma_piece = 1'000'000;  ///< at least 1 ms

  std::vector<DelayChange> recorded{};  ///< a measured delay over time, starting at 0; the last entry says when it begins anew

  double loss = 0;        ///< fraction of datagrams
  double burst = 1;       ///< [datagrams] mean length of a row of losses (Gilbert-Elliott); 1: independent of each other
  double duplicates = 0;  ///< fraction of datagrams that arrive twice, each copy with a jitter of its own
  double held_back = 0;   ///< fraction of datagrams that come later than others sent after them, by
  Microseconds held_back_by = 0;
  double rate = 0;                ///< [bit/s] of the bottleneck, IP and UDP headers included; 0: no limit
  std::size_t queue = 65536;      ///< [bytes] before the bottleneck; what does not fit is lost
  std::vector<Outage> outages{};  ///< nothing sent in these times arrives
};

struct LinkCounters {
  std::uint64_t sent = 0, arrived = 0;              ///< copies count as arrived
  std::uint64_t lost = 0, cut = 0, overflowed = 0;  ///< by chance, by outages, by the queue
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;  ///< arrived after one that was sent later
};

class Link {
 public:
  /// A datagram at the far end. The bytes are valid until the next call.
  struct Arrival {
    Microseconds time = 0;
    std::span<const std::uint8_t> bytes;
  };

  /// err  invalid_argument R-LNK-1: a time is negative or over an hour, a piece is shorter than 1 ms, a fraction is not within 0 and 1, a
  ///      burst is shorter than 1 or than the fraction of losses asks for, the rate is not finite, or recorded delays and outages are
  ///      not in order
  static Result<Link> create(const LinkOptions& options);
  /// `now` is time 0 of a link with these options, whose counters begin anew; what is on its way arrives when it would have, and is not counted.
  /// err  as create()
  Result<void> restart(const LinkOptions& options, Microseconds now);

  /// pre  `now` never decreases.   time O(log of datagrams on their way); allocates only to hold more of them than ever before.
  void send(Microseconds now, std::span<const std::uint8_t> datagram);
  /// The next datagram that arrives until `now`, or none.
  std::optional<Arrival> poll(Microseconds now) noexcept;
  /// When the next one arrives; none is on its way: nothing.
  std::optional<Microseconds> next() const noexcept;
  const LinkCounters& counters() const noexcept { return counters_; }

 private:
  struct InFlight {
    Microseconds due = 0;
    std::uint64_t order = 0;   // of the heap: ties go by it
    std::uint64_t number = 0;  // of the datagram, from 1; 0: it was sent before the link began anew
    std::uint32_t slot = 0;    // of its bytes
  };
  explicit Link(const LinkOptions& options);
  bool is_cut(Microseconds now) const noexcept;
  bool draw_loss() noexcept;
  /// When the datagram leaves the bottleneck; nothing when the queue is full.
  std::optional<Microseconds> leave_queue(Microseconds now, std::size_t size) noexcept;
  Microseconds slow_delay(Microseconds now) noexcept;
  void put(Microseconds due, std::span<const std::uint8_t> datagram);

  LinkOptions options_;
  Random loss_, jitter_, gamma_, duplicate_, held_;
  bool in_burst_ = false;
  Microseconds free_at_ = 0;  // when the bottleneck has sent all that waits
  std::int64_t piece_ = -1;   // whose delay is known
  Microseconds piece_delay_ = 0;
  std::vector<InFlight> heap_;
  std::vector<std::vector<std::uint8_t>> slots_;
  std::vector<std::uint32_t> free_slots_;
  std::uint64_t order_ = 0, newest_arrived_ = 0;
  LinkCounters counters_;
};

}  // namespace tactus::sim
