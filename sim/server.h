// SPDX-License-Identifier: Apache-2.0
/// The server: simulates all objects, renders every user's probe against their true state, and codes that state.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/sender.h>
#include <tactus/sim/deformable/deformable_objects.h>
#include <tactus/sim/random.h>
#include <tactus/sim/rigid/rigid_objects.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/trace_scene.h>

namespace tactus::sim {

/// What is coded, and how.
struct ServerCodec {
  SenderOptions sender;
  TraceCoding coding{};   ///< of the scene's objects
  bool sessions = false;  ///< clients have sessions of their own, which code for them
  double client_model_scale =
      1;  ///< with sessions: mass and Young's modulus declared to clients, times the true ones; 0: none are declared
  DecodeLimits limits{};  ///< of who takes the scene
};

struct ServerOptions {
  std::uint64_t seed = 1;            ///< of the noise
  std::optional<ServerCodec> codec;  ///< none: nothing is sent, clients see the truth
  double mesh_noise = 0;             ///< [m] RMS per axis of white noise on every vertex of a shape that the server reports
  std::uint32_t estimate_every = 0;  ///< estimate the error of every n-th deformation, 0: of none
  int parts = 1;                     ///< of each step of rigid and deformable objects
  bool has_clients = true;           ///< without a codec: there is somebody who sees the truth
};

class Server {
 public:
  /// pre  every call on the same thread (RigidWorld).
  /// err  R-API-n, R-STR-n of SceneBuilder::build and Sender::create; invalid R-SIM-3 of MsdObjects; unsupported R-SIM-2 and others of
  ///      make_deformable_objects()
  static Result<std::unique_ptr<Server>> create(const Scene& scene, const ServerOptions& options);

  /// Write the state of this tick, before its forces act, to frame().   no allocation
  void observe() noexcept;
  /// Move every user's probe; write contacts and forces to frame(). The force rendered to a hand is the server's there, until whoever has
  /// clients that send theirs writes it.   in  devices  one per user   no allocation
  void touch(std::span<const DeviceSample> devices) noexcept;
  /// Of the force of this user's hand only a fraction acts from now on: 0 lifts it off, 1 sets it down.
  void lift(std::size_t user, double fraction) noexcept { held_[user] = fraction; }
  /// Packets of this tick for the clients; valid until the next call.   err  errors of Sender::encode   no allocation
  Result<std::span<const Packet>> encode() noexcept;
  std::span<const HeldPart> held() const noexcept;  ///< Sender::held() of them
  /// What they are made of, for the sessions.   pre  there is a codec
  Truth truth() noexcept;
  /// Apply the forces of this tick, limited to what the devices render, and advance by one tick.
  tl::expected<void, Diagnostic> step();

  TraceFrame& frame() noexcept { return frame_; }
  const TraceFrame& frame() const noexcept { return frame_; }
  const Scene& scene() const noexcept { return scene_; }
  TraceInfo info() const;  ///< of the frames
  /// Scene declaration for the clients; null without a codec.
  SharedScene stream_scene() const noexcept { return declared_; }
  RigidObjects& rigid() noexcept { return *rigid_; }
  const RigidObjects& rigid() const noexcept { return *rigid_; }
  DeformableObjects* deformables() const noexcept { return deformables_; }  ///< null: the scene has none

 private:
  Server(const Scene& scene, const ServerOptions& options);
  Result<void> add_objects(const ServerOptions& options);
  using Driven = std::vector<std::optional<DrivenPhysics>>;
  Driven driven_objects(double model_scale) const;
  MotionPhysics motion_physics() const;
  Result<void> add_codec(const ServerCodec& codec);
  void add_noise() noexcept;

  Scene scene_;
  Random noise_;
  double noise_reach_;  // [m] of a uniform distribution
  std::vector<std::unique_ptr<Simulated>> objects_;
  RigidObjects* rigid_ = nullptr;  // among objects_, like
  DeformableObjects* deformables_ = nullptr;
  SharedScene declared_;  // null: without codec
  std::optional<Sender> sender_;
  std::optional<FrameTruth> truth_;
  TraceFrame frame_;
  std::vector<double> held_;       // fraction of each user's force that acts
  std::vector<double> fractions_;  // of each user's force that the device renders, times that
};

}  // namespace tactus::sim
