// SPDX-License-Identifier: Apache-2.0
/// The columns of data that the page reads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/client/replica.h>
#include <tactus/metrics/errors.h>
#include <tactus/player.h>
#include <tactus/receiver.h>
#include <tactus/sender.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_scene.h>
#include "cli/report/messages.h"

namespace tactus::cli {

// ==== columns ====
// Numbers over time, small enough for a page: each a multiple of a step, coded as the difference to the one before.

std::string base64(std::string_view bytes);

/// Zigzag LEB128 of the differences; a run of n zeros is the byte 0 and n - 1. The page reads it: read_columns.js.
class Column {
 public:
  explicit Column(double step = 1) : step_(step) {}

  void add(std::int64_t value);
  /// pre  finite   Values beyond +-2^52 steps are limited to that.
  void add_real(double value) { add(std::llround(std::fmin(std::fmax(value / step_, -0x1p52), 0x1p52))); }
  std::size_t size() const noexcept { return count_; }
  std::size_t bytes() const noexcept { return data_.size(); }
  /// The column so far; it begins anew.
  nlohmann::ordered_json take();

 private:
  void put(std::uint64_t value);
  void end_run();

  double step_;
  std::int64_t last_ = 0;
  std::uint64_t zeros_ = 0;
  std::size_t count_ = 0;
  std::string data_;
};

/// Three columns.
class VectorColumn {
 public:
  explicit VectorColumn(double step) : x_(step), y_(step), z_(step) {}
  void add(const Vec3& v) {
    x_.add_real(v.x);
    y_.add_real(v.y);
    z_.add_real(v.z);
  }
  std::size_t bytes() const noexcept { return x_.bytes() + y_.bytes() + z_.bytes(); }
  nlohmann::ordered_json take() { return {x_.take(), y_.take(), z_.take()}; }

 private:
  Column x_, y_, z_;
};

// ==== packet table ====
// Packets in their order: where they are, and why they were sent.

class PacketTable {
 public:
  void add(const PlayedPacket& packet) {
    Reason reason = Reason::request;
    for (const RigidUpdate& update : packet.updates) reason = std::max(reason, update.reason);
    ticks_.add(packet.tick);
    numbers_.add(static_cast<std::int64_t>(packet.number));
    offsets_.add(static_cast<std::int64_t>(packet.offset));
    sizes_.add(static_cast<std::int64_t>(packet.bytes));
    substreams_.add(static_cast<std::int64_t>(packet.substream));
    keys_.add(packet.key ? 1 : 0);
    reasons_.add(static_cast<std::int64_t>(reason));
    updates_.add(static_cast<std::int64_t>(packet.updates.size() + packet.loads + packet.vertices));
    last_ = packet.tick;
  }
  std::int64_t last_tick() const noexcept { return last_; }
  /// The packets so far; it begins anew.
  nlohmann::ordered_json take() {
    return {{"ticks", ticks_.take()},     {"numbers", numbers_.take()},       {"offsets", offsets_.take()},
            {"sizes", sizes_.take()},     {"substreams", substreams_.take()}, {"keys", keys_.take()},
            {"reasons", reasons_.take()}, {"updates", updates_.take()}};
  }

 private:
  Column ticks_{1}, numbers_{1}, offsets_{1}, sizes_{1}, substreams_{1}, keys_{1}, reasons_{1}, updates_{1};
  std::int64_t last_ = 0;
};

// ==== packet log ====
// The packets of a motion as a page holds them: coded from the truth, and decoded as a client does that gets them all.

class PacketLog {
 public:
  /// err  of Sender::create, Receiver::create
  static Result<PacketLog> create(const SharedScene& scene, const SenderOptions& options);
  /// err  of Sender::encode, Receiver::push
  Result<void> add(std::int64_t tick, const Truth& truth);
  /// The next packet of every substream is a key packet, to begin at.
  void request_key() noexcept { sender_.request_key(); }
  Replica& replica() noexcept { return receiver_.replica(); }
  const Scene& scene() const noexcept { return *sender_.scene(); }
  nlohmann::ordered_json hashes() const;  ///< of the substreams' states
  std::size_t bytes() const noexcept { return bytes_.size(); }
  /// The packets so far, as "stream" and "packets"; it begins anew.
  nlohmann::ordered_json take();

 private:
  PacketLog(Sender sender, Receiver receiver) : sender_(std::move(sender)), receiver_(std::move(receiver)) {}

  Sender sender_;
  Receiver receiver_;
  std::string bytes_;
  PacketTable packets_;
};

/// A scene's declaration in base64.   err  of write_scene
Result<std::string> declaration_of(const Scene& scene);

// ==== truth data ====
// The truth as the page holds it: objects and meshes as a second stream with fine bounds, users and errors as columns.

/// How far the ghost may be off the truth.
struct GhostBounds {
  RigidTriggers rigid;
  DeformableThresholds deformable;
};
/// A twentieth of the bounds that the stream declares, or of the defaults.
GhostBounds ghost_bounds(const Scene& scene);

/// The errors of all ticks are those of `tactus compare`: of what a client shows, against the trace.
class TruthData {
 public:
  /// in   first  frame of the trace;  scene  that the client shows, outlives this
  /// err  those of scene_builder(), SceneBuilder::build(), PacketLog::create()
  static Result<TruthData> create(const TraceInfo& info, const TraceFrame& first, const Scene& scene);
  /// in   shown  at the frame's tick   err  those of PacketLog::add
  Result<void> add(const TraceFrame& frame, Replica& shown);
  std::size_t bytes() const;  ///< so far, of all that the page will hold
  void request_key() noexcept { ghost_.request_key(); }
  /// What the page must know before the ticks: the ghost's scene and how close it is.   err  of declaration_of()
  Result<nlohmann::ordered_json> declare() const;
  /// The ticks so far; it begins anew.
  nlohmann::ordered_json take();

 private:
  struct User {
    Column kind{1};
    VectorColumn device{1e-5}, contact{1e-5}, server{1e-3}, rendered{1e-3}, shown{1e-3};
    bool differ = false;  // the rendered force and the server's
  };
  struct Mesh {
    Column ticks{1}, error{1e-8};
  };

  TruthData(const TraceInfo& info, const Scene& scene, const GhostBounds& bounds, PacketLog ghost);
  void add_users(const TraceFrame& frame, const std::vector<Pose>& shown);
  void add_errors(const TraceFrame& frame, const std::vector<Pose>& shown);
  void add_shapes(const TraceFrame& frame, Replica& replica);

  TraceInfo info_;
  const Scene* scene_;
  GhostBounds bounds_;
  std::optional<RigidTriggers> declared_bounds_;
  PacketLog ghost_;
  FrameTruth truth_;
  Column ticks_{1};
  std::vector<User> users_;
  std::vector<Mesh> meshes_;
  Column position_{1e-7}, rotation_{1e-6}, force_error_{1e-5}, force_bound_{1e-5};
};

}  // namespace tactus::cli
