// SPDX-License-Identifier: Apache-2.0
/// The client's end of a session: a function of datagrams and time. spec/70-session.md. For how to drive it, see session_server.h
/// and examples/session.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/receiver.h>
#include <tactus/session/device_signal.h>
#include <tactus/session/session_options.h>

namespace tactus {

/// How the session does.
struct SessionStatus {
  SessionState state = SessionState::closed;
  std::uint16_t client = 0;
  std::uint8_t seat = 0;                        ///< what a participant plays, from 1; 0: nothing; kOnlyLooksOn
  std::uint64_t world = 0;                      ///< what the server simulates; 0: not declared
  std::uint64_t token = 0;                      ///< with which another client goes on with this session; 0: none yet
  std::uint64_t declaration = 0, received = 0;  ///< [bytes] of the scene declaration, in all and so far
  std::uint64_t start = 0;                      ///< [us] the server's clock at tick 0
  std::optional<RoundTrip> round_trip;
  std::optional<std::int64_t> clock_offset;  ///< [us] the server's clock less the client's
  std::int64_t playout_delay = 0;            ///< [us] behind the fastest packet
  double loss = 0;                           ///< fraction of the last 256 datagrams to the server
  Traffic traffic;
};

struct ClientEvent {
  enum class Kind : std::uint8_t {
    welcomed,  ///< the declaration is on its way
    live,      ///< it is here: receiver() is a new one
    closed,    ///< for `reason`
  };
  Kind kind = Kind::welcomed;
  LeaveReason reason = LeaveReason::bye;
};

/// Threads: one at a time. No call that handles a datagram allocates but those that bring the declaration; none throws.
class SessionClient {
 public:
  /// err  as Sender::create: R-API-4 a bound of the device
  static Result<SessionClient> create(const SessionClientOptions& options);

  /// Join. Without an answer the client joins again by itself: its address may be another one, or the server may have begun anew.
  /// in   nonce  64 bits from the system;  token  of a session that ended without the server's knowledge; 0: none     pre  closed
  void open(std::uint64_t now, std::uint64_t nonce, std::uint64_t token = 0) noexcept;
  void close() noexcept;

  /// err  the datagram is dropped, and nothing has changed but the traffic: checksum R-SES-1; those of R-SES rules
  Result<void> handle_datagram(std::uint64_t now, std::span<const std::uint8_t> datagram) noexcept;
  void handle_timeout(std::uint64_t now) noexcept;
  /// The device now: at most one sample per tick counts. Nothing happens unless the session is live and the client participates.
  /// err  R-API-1, 2, 3: a sample that breaks one counts as the last good one, at rest; others as Sender::encode
  Result<void> submit(std::uint64_t now, const DeviceSample& sample, const std::optional<DeviceContact>& contact) noexcept;

  /// In a scene with interest: where the user looks from [m, world frame], apart from the device of a participant. Objects far from both are sent
  /// less exactly or not at all (Replica::lod()). Say so before open(): an observer is sent all until it has. What is not finite, or beyond 8000 km, does not count.
  void set_viewpoint(const Vec3& viewpoint) noexcept;

  std::optional<std::span<const std::uint8_t>> poll_datagram(std::uint64_t now) noexcept;  ///< valid until the next call
  std::optional<ClientEvent> poll_event() noexcept;
  std::optional<std::uint64_t> next_timeout() const noexcept;  ///< [us] nothing: never

  /// What receiver() shows at shown_tick(): Receiver::pose() and Receiver::displacements().   pre  shown_tick() was not -1
  Pose pose(std::uint32_t object, std::int64_t tick) noexcept { return receiver()->pose(object, tick); }
  std::span<const float> displacements(std::size_t object, std::int64_t tick) noexcept {
    return receiver()->displacements(object, tick);
  }

  /// Of the newest scene whose declaration is complete; null: there is none yet. It shows ticks of the past: show shown_tick().
  Receiver* receiver() noexcept;
  /// The tick to show; it never falls within an epoch. -1: none yet.
  std::int64_t shown_tick(std::uint64_t now) noexcept;
  /// [us] How old the tick that shown_tick() returned last is as an answer to the own device: R of thesis chapter 4, playout included.
  /// Nothing: not known yet.
  std::optional<std::uint64_t> round_trip_shown(std::uint64_t now) const noexcept;
  /// Fraction of a force that may be rendered: without news none.   out  0 to 1
  double force_fraction(std::uint64_t now) noexcept;
  SessionStatus status() const noexcept;
  std::uint64_t unanswered(std::uint64_t now) const noexcept;  ///< [us] for how long an answer of the server is missing

  SessionClient(SessionClient&&) noexcept;
  SessionClient& operator=(SessionClient&&) noexcept;
  ~SessionClient();

 private:
  struct Impl;
  explicit SessionClient(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
