// SPDX-License-Identifier: Apache-2.0
/// One client at the server. spec/70-session.md sections 3, 6 and 9. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/session/congestion.h>
#include <tactus/session/exchange.h>
#include <tactus/session/session_server.h>
#include <tactus/session/timing.h>

namespace tactus {

/// What all clients get.
struct ServedScene {
  SharedScene scene, device;
  std::shared_ptr<SharedTruth> truth;
  std::shared_ptr<const std::vector<std::uint8_t>> declaration;
  std::uint64_t hash = 0;   ///< of the declaration
  std::uint64_t start = 0;  ///< [us] at tick 0
  std::uint64_t world = 0;
  std::optional<std::int64_t>
      shift{};  ///< [us] the program's clock less the one that is signalled to clients; none before the first tick
  SenderOptions sender;

  /// Within the limits of a client.
  bool fits(const Join& message) const noexcept {
    return state_bytes(*scene) <= message.state_limit && declaration->size() <= message.header_limit;
  }
};

/// What brings a client live: made on any thread.
struct ClientParts {
  std::uint16_t client = 0;
  std::uint64_t epoch = 0;
  SharedScene scene, device;  // device: null if it is an observer
  std::shared_ptr<SharedTruth> truth;
  SenderOptions options;
  bool repaired = false;
  std::shared_ptr<DevicePath> path;  // null: the device drives nothing
  std::optional<Sender> sender;
  std::optional<Receiver> receiver;

  Result<void> make();  ///< err  as Sender::create, Receiver::create
};

class ServerConnection {
 public:
  /// in   pieces_at  [us] when the next piece may go to any client: all have it in common, and it outlives them
  ServerConnection(std::uint16_t client, const SessionServerOptions& options, std::uint64_t& pieces_at) noexcept;

  std::uint16_t client() const noexcept { return client_; }
  std::uint64_t peer() const noexcept { return peer_; }  ///< 0: none
  std::uint64_t nonce() const noexcept { return join_.nonce; }
  std::uint64_t token() const noexcept { return token_; }
  const Join& join() const noexcept { return join_; }
  SessionState state() const noexcept { return state_; }
  bool is_free() const noexcept { return state_ == SessionState::closed && leaves_ == 0; }
  const Welcome& welcome() const noexcept { return welcome_; }

  void open(std::uint64_t peer, const Join& message, const ServedScene& served, std::uint64_t epoch, std::uint64_t now) noexcept;
  void move(std::uint64_t peer) noexcept { peer_ = peer; }
  void seat(std::uint8_t seat) noexcept;
  void shift(std::int64_t shift) noexcept { served_.shift = shift; }
  bool is_outdated() const noexcept { return outdated_; }
  /// A new scene waits until the client has spoken in the epoch that it was welcomed to: no other welcome can reach it before.
  void outdate() noexcept { outdated_ = true; }
  bool needs_epoch() const noexcept { return outdated_ && validated_ && state_ != SessionState::closed; }
  bool is_validated() const noexcept { return validated_; }
  /// A new scene.   pre  open
  void begin_epoch(const ServedScene& served, std::uint64_t epoch, std::uint64_t now) noexcept;
  /// Go, if the state permits it. Unless the client has left or may not be there at all, a leave is sent to it.
  bool leave(SessionEvent event, LeaveReason reason) noexcept;

  bool is_mine(std::span<const std::uint8_t> datagram) const noexcept;
  Result<void> handle_datagram(std::uint64_t now, std::span<const std::uint8_t> datagram) noexcept;  ///< pre  is_mine()
  bool has_left() const noexcept { return left_.has_value(); }
  LeaveReason leave_reason() const noexcept { return *left_; }
  bool is_at_fault() const noexcept;  ///< it breaks rules again and again
  bool is_silent(std::uint64_t now) const noexcept;

  bool wants_parts() const noexcept { return parts_ == Parts::wanted; }
  ClientParts ask_parts() noexcept;  ///< pre  wants_parts()
  /// The client goes live.   out  false: it is closed, or has begun anew
  bool take(std::uint64_t now, ClientParts& parts);
  void refuse_parts() noexcept { parts_ = Parts::none; }
  std::optional<Sender> take_old() noexcept { return std::exchange(old_, std::nullopt); }  ///< of an epoch before

  /// in   hashes  objects whose states may be hashed in this tick, for all clients: it takes 50 ns each.   pre  live
  Result<void> submit(std::uint64_t now, std::int64_t tick, const Truth& truth, std::size_t& hashes) noexcept;
  double bound_scale() const noexcept { return congestion_.bound_scale(); }
  std::optional<std::span<const std::uint8_t>> poll(std::uint64_t now) noexcept;
  std::optional<std::uint64_t> next_timeout() const noexcept;

  std::optional<DeviceSample> device(std::uint64_t now) noexcept;
  ClientStatus status() const noexcept;
  std::uint64_t state_hash(std::size_t substream) const noexcept { return exchange_->sender->state_hash(substream); }
  std::uint64_t device_hash() const noexcept { return exchange_->receiver->state_hash(0); }  ///< pre  a live participant

 private:
  struct KnownHash {
    std::size_t substream = 0;
    std::uint64_t number = 0;
    std::uint32_t hash = 0;
  };
  Result<void> handle(const Part& part, std::uint64_t now) noexcept;
  Result<void> go_live(std::uint64_t now) noexcept;
  ClientParts parts() const noexcept;
  void measured(std::int64_t sample, std::uint64_t now) noexcept;
  void compare(const HashPart& received) noexcept;
  void note_hash(const Packet& packet, std::size_t& hashes) noexcept;
  void take(const ReportPart& report, std::uint64_t now) noexcept;
  void look() noexcept;
  std::optional<DeviceSample> driving_device(std::uint64_t now) noexcept;
  bool signal_baselines(DatagramWriter& writer, std::uint64_t number) noexcept;
  bool wants_mapping(std::uint64_t now) const noexcept { return mapping_ && mapping_->waits() && now >= mapping_at_; }
  bool wants_seat(std::uint64_t now) const noexcept { return seat_waits_ && now >= seat_at_; }
  std::optional<std::uint64_t> piece_due() const noexcept;
  bool wants_welcome(std::uint64_t now) const noexcept;
  std::uint64_t clock_to_send(std::uint64_t now) const noexcept;
  void add_piece(DatagramWriter& writer, std::uint64_t number, std::uint64_t now) noexcept;
  void add_seat(DatagramWriter& writer, std::uint64_t number, std::uint64_t now) noexcept;

  bool repairs() const noexcept;
  bool is_held(std::uint64_t now) noexcept;

  std::uint16_t client_;
  LossPolicy loss_;
  SessionState state_ = SessionState::closed;
  LeaveReason leaving_ = LeaveReason::bye;
  unsigned leaves_ = 0;  // that are still to be sent
  unsigned faults_ = 0;
  std::uint8_t seat_ = 0;
  bool held_ = false;       // the last tick was not sent
  bool validated_ = false;  // it knows the epoch: the address is its own
  bool trusts_;             // the transport has validated it before
  bool works_elsewhere_;
  enum class Parts : std::uint8_t { none, wanted, asked };
  Parts parts_ = Parts::none;
  std::optional<Sender> old_;  // to be freed elsewhere
  bool outdated_ = false;      // there is a newer scene
  bool repeats_welcome_ = false;
  bool signals_baselines_ = false;                // the client does not know yet that they are the acknowledged ones
  bool seat_waits_ = false;                       // for an acknowledgement
  std::optional<LeaveReason> left_;               // sent by the client
  std::uint64_t silence_, headers_, piece_time_;  // [us], [bytes] around a datagram, [us] of a piece at the rate
  double max_bound_scale_;
  std::uint64_t peer_ = 0, token_ = 0;
  Join join_;
  Welcome welcome_;
  ServedScene served_;
  std::optional<Exchange> exchange_;
  DatagramWriter writer_{Direction::down};  // of what is outside of the exchange
  std::uint64_t most_rate_;                 // [bit/s], 0: no limit
  TokenBucket bucket_;
  LineRate line_;
  Congestion congestion_;
  std::uint64_t welcome_at_ = 0, clock_at_ = 0, piece_at_ = 0;  // [us] when the next may go
  std::uint64_t& pieces_at_;                                    // [us] when one may go to any client
  std::array<KnownHash, 32> hashes_{};
  std::size_t next_hash_ = 0;
  std::uint64_t wrong_states_ = 0;
  std::optional<PlayoutClock> device_clock_;
  std::optional<DeviceTickMapping> mapping_;  // if the device may drive objects
  std::int64_t next_tick_ = 0;                // of submit()
  std::uint64_t mapping_at_ = 0;              // [us] when its changes go again
  ButtonsPart buttons_;
  std::uint64_t playout_ = 0;                    // [us] that the client reported last
  std::optional<Vec3> view_;                     // [m] where it looks from, by its report
  std::uint64_t baselines_number_ = 0;           // of the first datagram with the part
  std::uint64_t seat_at_ = 0, seat_number_ = 0;  // [us] when it goes again; of the first datagram with it, 0: none yet
};

}  // namespace tactus
