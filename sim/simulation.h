// SPDX-License-Identifier: Apache-2.0
/// Hands, clients, a link and the server, one tick at a time (thesis 2.4.2.4 and 3.2: client/server with object states).
///
///   1 hand     feels the client's force of the last tick and moves; the device reports x_d                sim/user/hand.h
///   2 server   proxy on the true state: contact, force f                                                  sim/server.h
///   3 link     truth -> Sender -> packets -> Receiver -> Replica         (left out without a codec)       sim/link/link.h
///   4 client   proxy on what the replica shows, same x_d: force f_c, which the hand will feel             sim/client.h
///   5 physics  -f acts on the touched object at the proxy; state of the next tick                         sim/server.h
///
/// Rigid, one-dimensional and deformable objects go through the same steps (sim/touchable.h). A user feels the sum of their
/// forces, clipped to the device's limit.
///
/// The frame of a tick holds the states of 2, the device sample of 1 and both forces. All of it belongs to one instant, so that a
/// force recomputed from contact and pose equals the encoder's own number.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/receiver.h>
#include <tactus/sender.h>
#include <tactus/sim/deformable/deformable_objects.h>
#include <tactus/sim/link/link.h>
#include <tactus/sim/rigid/rigid_errors.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>
#include <tactus/sim/user/passivity.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/trace_scene.h>

namespace tactus::sim {

struct ChannelOptions {
  SenderOptions sender;
  ReplicaOptions replica;
  TraceCoding coding{};           ///< of the scene's objects
  DecodeLimits limits{};          ///< of clients
  double client_model_scale = 1;  ///< with a network: as ServerCodec::client_model_scale
  const Scene* own = nullptr;     ///< what clients simulate themselves, if they do; null: the scene
  bool timed = false;             ///< with a network: client_costs() are measured, about 1 us per tick and user
  NetworkMaker network{};         ///< each user has a client behind it; none: one client, and no time passes
};

struct SimulationOptions {
  std::uint64_t seed = 1;
  std::optional<Grip> grip;               ///< instead of the scene's, for every user
  std::optional<ChannelOptions> channel;  ///< none: the client sees the true poses
  double mesh_noise = 0;                  ///< [m] RMS per axis of white noise on every vertex that the server reports
  std::uint32_t estimate_every = 0;       ///< estimate the error of every n-th deformation, 0: of none
  int parts = 1;                          ///< of each step of rigid and deformable objects: 2 is half the step
};

class Simulation {
 public:
  /// pre  every call on the same thread (ODE keeps state per thread).
  /// err  invalid_argument R-API-n, R-STR-n: the options do not suit the scene (see SceneBuilder::build, Sender::create, Receiver::create);
  ///      invalid R-SIM-3 of MsdObjects; unsupported R-SIM-2 and others of make_deformable_objects()
  static Result<Simulation> create(const Scene& scene, const SimulationOptions& options = {});

  /// One tick with the scene's virtual hands. Afterwards frame() is this tick.
  /// out  the packets of this tick; valid until the next call. With a network none: each session has its own
  /// time about 16 us for one cube and user; no allocation after the first tick, in which ODE makes its arenas, and the first
  ///      deformation.
  /// err  invalid_argument R-SIM-1, R-FEM-6: the physics broke down; errors of Sender::encode and Receiver::push
  tl::expected<std::span<const Packet>, Diagnostic> step();

  /// The same with other devices in place of the hands: recorded ones (open loop), or real ones.
  /// in   devices  one per user of the scene; button 0 lifts what is touched
  /// err  as step(); invalid_argument R-API-5: wrong count, R-API-1: not finite
  tl::expected<std::span<const Packet>, Diagnostic> step(std::span<const DeviceSample> devices);

  /// The same with one user's device, and the hands of the others.   pre  user < users of the scene
  tl::expected<std::span<const Packet>, Diagnostic> step(std::size_t user, const DeviceSample& device);

  const TraceFrame& frame() const noexcept;             ///< pre  step() was called
  std::span<const HeldPart> held() const noexcept;      ///< of its truth, by the sender or server: Sender::held()
  std::span<const Pose> client_poses() const noexcept;  ///< as shown at the client in that tick, one per object
  std::span<const Pose> received_poses(std::size_t user) const noexcept;  ///< at that user's client, of shown_tick()
  const Pose& watched(std::size_t user) const noexcept;  ///< pose of the object that this user looks at, as shown
  /// The tick whose state the user's client shows: with a network one of the past, -1 before the first.
  std::int64_t shown_tick(std::size_t user) const noexcept;
  double rendered_fraction(std::size_t user) const noexcept;  ///< of the force: less than 1 while the data are old
  double round_trip(std::size_t user) const noexcept;  ///< [s] age of what is shown, as an answer to the device; 0: not known
  double stiffness(std::size_t user) const noexcept;   ///< [N/m] with which the user's force was rendered; 0: none was
  std::optional<Vec3> touched_point(
      std::size_t user) const noexcept;                   ///< [m] proxy at the user's client; none: nothing is touched
  Replica& replica() noexcept;                            ///< the client's.   pre  there is a channel without network
  std::int64_t ticks() const noexcept;                    ///< length of the scene
  TraceInfo info() const;                                 ///< for a TraceWriter of these frames
  SharedScene stream_scene() const noexcept;              ///< of the packets.   pre  there is a channel
  const DeformableObjects* deformables() const noexcept;  ///< null: the scene has none
  const RigidErrors& rigid_errors() const noexcept;       ///< of the rigid objects
  /// [J] Of all rigid objects, then of all deformable ones: kinetic and elastic energy, and gravity's since the start; after step()
  /// those of the next tick.   time O(objects), and one evaluation of the forces per deformation   no allocation if it fits
  void energies(std::vector<double>& out) noexcept;
  const TouchSummary& touched(std::size_t user) const noexcept;  ///< all ticks so far
  /// Of this tick.   pre  there is a channel with a network, and it is timed
  const ClientCosts& client_costs(std::size_t user) const noexcept;
  /// [N/m] largest stable stiffness of a coupling to a fixed point (passivity.h)
  double tolerated_stiffness(std::size_t user) const noexcept;

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

 private:
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::sim
