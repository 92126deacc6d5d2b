// SPDX-License-Identifier: Apache-2.0
/// The server's end of sessions with many clients: a function of datagrams and time. spec/70-session.md.
///
/// It knows neither sockets nor clocks. The program calls one of handle_datagram(), handle_timeout(), submit() and the like, and then
///   while (auto d = server.poll_datagram(now)) send d->bytes to d->peer;
///   while (auto e = server.poll_event()) tell the user;
///   wait for a datagram, the next tick, or server.next_timeout(), whichever comes first.
/// Take all datagrams before the next submit(): what still waits then is left out, and counted as Traffic::packets_held.
/// A scene for sessions keeps baselines, SceneBuilder::baselines(64): with one alone a packet is a key packet unless the one before it is
/// acknowledged already. Its tick rate is that of submit(): bounds hold at the ticks that were submitted.
/// Times are microseconds of any clock of the program that never steps back. examples/session.cpp is a whole program with both ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/sender.h>
#include <tactus/session/session_options.h>

namespace tactus {

/// How a client does.
struct ClientStatus {
  std::uint16_t client = 0;
  std::uint64_t peer = 0;
  SessionState state = SessionState::closed;
  Role role = Role::observer;
  std::uint8_t seat = 0, wanted_seat = 0;  ///< from 1; 0: none, any
  std::uint64_t heard = 0;                 ///< [us] when its newest datagram came
  std::optional<RoundTrip> round_trip;
  double loss = 0;             ///< fraction of the last 256 datagrams to the client
  double bound_scale = 1;      ///< factor of the bounds now
  BoundScaling bound_scaling;  ///< since it joined
  Traffic traffic;
};

struct ServerEvent {
  enum class Kind : std::uint8_t {
    joined,         ///< and gets the declaration
    live,           ///< holds it
    left,           ///< for `reason`
    moved,          ///< its address is another one: ClientStatus::peer
    bounds_scaled,  ///< its bounds are multiplied by `bound_scale` from now on
    refused,        ///< joins, for `reason`; `client` is nobody
  };
  Kind kind = Kind::joined;
  std::uint16_t client = 0;
  LeaveReason reason = LeaveReason::bye;
  double bound_scale = 1;
};

/// Threads: one at a time. No call that handles a datagram allocates but those that bring a client live; none throws.
/// More clients than a thread can serve: several servers of the same scene and options, each on a thread of its own with its part of the
/// addresses, that submit the same truth. What a client is sent depends on no other client once each server has one, so nothing is locked:
/// each tick begins when the world has made the truth, and the world waits until all servers have submitted it. Each needs its own entropy.
class SessionServer {
 public:
  /// in   entropy  64 bits from the system, that nobody else can guess. Epochs are drawn from them so that who has one could
  ///               compute the next: without the seal, clients of one server trust each other
  /// err  as Sender::create; invalid_argument R-API-4: no client, or more than 65535
  static Result<SessionServer> create(SharedScene scene, const SessionServerOptions& options, std::uint64_t entropy,
                                      std::uint64_t now);

  /// in   peer  who sent it: the transport's name for an address, never 0
  /// err  the datagram is dropped, and nothing has changed but the traffic: checksum R-SES-1; those of R-SES rules
  Result<void> handle_datagram(std::uint64_t now, std::uint64_t peer, std::span<const std::uint8_t> datagram) noexcept;
  void handle_timeout(std::uint64_t now) noexcept;
  /// Code a tick for every live client. Ticks are times of the scene: whoever misses some leaves out numbers, or makes them at once; who
  /// pauses for more than 100 ms may go on with the next number.
  /// time SharedTruth::read once, and 0.5 us per live client; what clients have in common is computed once (reports/scale). What rests
  ///      costs nothing
  /// A bad object does not stop the others: held().
  /// err  as Sender::encode, the first; all clients that can are served
  Result<void> submit(std::uint64_t now, std::int64_t tick, const Truth& truth) noexcept;
  /// As Sender::held(), of the last submit() that found a live client.   out  valid until the next call
  std::span<const HeldPart> held() const noexcept;
  /// [us] The clock signalled to clients: by it tick n is at create() or replace_scene() + n ticks. Before the first tick that of the program.
  std::uint64_t clock(std::uint64_t now) const noexcept;
  /// Another scene: clients get a new epoch, and show the old one until they hold the new. Ticks begin anew.   err  as create()
  Result<void> replace_scene(SharedScene scene, std::uint64_t now);
  /// What a participant plays, from 1; 0: nothing; kOnlyLooksOn: nothing, as it may not. It is signalled. Who comes
  /// back with the token of its session has the seat that it had.
  void seat(std::uint16_t client, std::uint8_t seat) noexcept;
  /// Take leave of a client, or of all.
  void close(std::uint16_t client, LeaveReason reason) noexcept;
  void close() noexcept;

  struct Transmit {
    std::uint64_t peer = 0;
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
  };
  std::optional<Transmit> poll_datagram(std::uint64_t now) noexcept;
  std::optional<ServerEvent> poll_event() noexcept;

  /// What a client needs before it goes live, or what one that has begun anew needs no more: to be made, or freed, on any thread while the
  /// server goes on.
  class Work {
   public:
    void run() noexcept;  ///< once
    Work(Work&&) noexcept;
    Work& operator=(Work&&) noexcept;
    ~Work();

   private:
    friend class SessionServer;
    struct Impl;
    explicit Work(std::unique_ptr<Impl> impl) noexcept;
    std::unique_ptr<Impl> impl_;
  };
  /// With SessionServerOptions::works_elsewhere, after each call as poll_datagram(); nothing: nothing is to be done.   time O(clients)
  std::optional<Work> poll_work() noexcept;
  /// The client goes live; from the next tick on it gets packets, as if it had reported so now. All that was polled comes back, in any order.
  /// out  it, if it holds what is to be freed, as the client has left: destroy it where that may take its time
  /// err  limit_exceeded R-API-11 memory: it is polled again once the client asks again
  Result<std::optional<Work>> take(std::uint64_t now, Work work) noexcept;

  /// When handle_timeout() should be called; nothing: never.   time O(clients)
  std::optional<std::uint64_t> next_timeout() const noexcept;

  /// The device of a live participant; nothing: it was not heard yet, or the client is an observer. In a driven scene it is the device in the
  /// tick after that of the last submit(), as the client will know it: ask once before each submit(), and give that position as Contact::device.
  std::optional<DeviceSample> device(std::uint16_t client, std::uint64_t now) noexcept;
  /// Hash of the state of its device scene.   pre  a live participant
  std::uint64_t device_hash(std::uint16_t client) const noexcept;
  bool has_peer(std::uint64_t peer) const noexcept;  ///< there is something to be sent to it yet.   time O(clients)
  std::uint16_t clients() const noexcept;            ///< most of them; client < clients()
  ClientStatus status(std::uint16_t client) const noexcept;
  /// Hash of a substream's state as the client has it when it has got all packets.   pre  live
  std::uint64_t state_hash(std::uint16_t client, std::size_t substream) const noexcept;

  SessionServer(SessionServer&&) noexcept;
  SessionServer& operator=(SessionServer&&) noexcept;
  ~SessionServer();

 private:
  struct Impl;
  explicit SessionServer(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
