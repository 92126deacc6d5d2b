// SPDX-License-Identifier: Apache-2.0
/// A client: receives the server's packets and renders their state to its users, visually and haptically.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/client/stiffness_reduction.h>
#include <tactus/receiver.h>
#include <tactus/session/device_signal.h>
#include <tactus/sim/deformable/deformable_probes.h>
#include <tactus/sim/msd/msd_objects.h>
#include <tactus/sim/prediction/prediction.h>
#include <tactus/sim/rigid/rigid_objects.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/server.h>
#include <tactus/sim/touchable.h>
#include <tactus/sim/user/passivity.h>

namespace tactus::sim {

// ==== compensation ====
// What a client makes of the delay of what it shows: it renders what its users touch softer, as much as keeps their forces right
// (thesis algorithm 1 for rigid objects, 4.52 to 4.56 for those that yield). codec/client/stiffness_reduction.h

/// [N] What all users but this one push an object with.   in  load  of Receiver::load
Vec3 others_push(std::span<const GridForce> load, std::size_t user, unsigned force_exp) noexcept;

/// Of all users of one client.
class Compensation {
 public:
  /// pre  scene.compensation, and the scene outlives this.
  /// err  R-API-4: its filter
  static Result<Compensation> create(const Scene& scene);

  /// The user's device in this tick, before what it touches.   no allocation
  void move(std::size_t user, const DeviceSample& device) noexcept { reductions_[user].move(device.position); }
  /// What the object that a user touches is shown as.
  struct Shown {
    const DeformableObject* deformable = nullptr;  ///< as declared, of touch.surface; none: its stiffness is not declared
    std::span<const GridForce> load{};             ///< Receiver::load, of touch.contact.object
    unsigned force_exp = 0;
    Pose pose;
    bool moves = false;
  };
  /// The force [N] to render in place of that of a touch.
  /// in   delay  [ticks] of what is shown
  /// no allocation
  Vec3 soften(std::size_t user, const Touch& touch, const Vec3& device, const Shown& shown, std::uint32_t delay) noexcept;
  /// The user touches nothing in this tick.
  void release(std::size_t user) noexcept { reductions_[user].release(); }
  /// [N/m] rendered in the last soften() of the user.
  double stiffness(std::size_t user) const noexcept { return stiffness_[user]; }

 private:
  explicit Compensation(const Scene& scene) : scene_(&scene), stiffness_(scene.users.size()) {}
  double reduced(std::size_t user, const Touch& touch, const Vec3& stretch, const Shown& shown, std::uint32_t delay) noexcept;

  const Scene* scene_;
  std::vector<StiffnessReduction> reductions_;  // one per user
  std::vector<double> stiffness_;               // [N/m] one per user
};

// ==== client ====

/// The client end of a simulation: with all users of the scene, or with one, behind a network.
class Client {
 public:
  /// in   server    outlives the client; without a codec the client sees its truth
  ///      replica   how the client shows what it received
  /// err  errors of Receiver::create
  static Result<std::unique_ptr<Client>> create(Server& server, const ReplicaOptions& replica);
  /// The client of one user, which shows what a network gives it, and makes up for its delay if the scene asks.
  /// in   own  what the client knows of the scene, if it simulates it: the objects and users of the server's
  /// pre  the server has a codec, and outlives the client.   err  of Compensation::create, Prediction::create
  static Result<std::unique_ptr<Client>> create_remote(Server& server, std::size_t user, const Scene& own);

  /// err  errors of Receiver::push   no allocation
  Result<void> receive(std::span<const Packet> packets) noexcept;
  /// Show the tick of this frame: the state received up to it, or the truth.   no allocation
  /// in   truth  says which shapes are new; without a codec, the state shown
  /// pre  called for every tick: a shape, and without a codec a pose, is read only when it is new; without a codec truth.changed is set
  void show(const TraceFrame& truth) noexcept;
  /// Show a tick of what came over a network. A shape is read once in each of its frames; one that rests is not read.   no allocation
  /// in   tick  never falls, as long as the receiver is the same
  void show(Receiver& receiver, std::int64_t tick) noexcept;
  /// Move every user's probe on the shown state.   in  devices  one per user   no allocation
  void touch(std::span<const DeviceSample> devices) noexcept;
  /// How a force is rendered.
  struct Rendering {
    double fraction = 1;      ///< of it
    std::uint32_t delay = 0;  ///< [ticks] of what is shown; 0: there is none to make up for
  };
  /// A network shows nothing any more: the receiver of the last show() is gone, or not to be read. What was shown stays.
  void show_nothing() noexcept { shown_by_ = nullptr; }
  /// Move one user's probe, and render its force.   pre  the receiver of the last show() lives, or show_nothing() was called
  /// no allocation, but by physics of its own (CompensationMethod::simulation) in its first ticks; it takes one call per tick
  void touch(std::size_t user, const DeviceSample& device, const Rendering& how) noexcept;
  /// What the user's device touched in the last touch(), if anything.
  const std::optional<DeviceContact>& contact(std::size_t user) const noexcept { return contacts_[user]; }

  /// Measure costs() from now on.
  void measure() noexcept { measures_ = true; }
  const ClientCosts& costs() const noexcept { return costs_; }  ///< of the last tick that was shown to a user

  /// [N/m] of the spring that rendered a user's force in the last touch(); 0: of none.
  double stiffness(std::size_t user) const noexcept { return stiffness_[user]; }
  const Vec3& rendered_force(std::size_t user) const noexcept { return rendered_[user]; }  ///< [N] rendered in the last touch()
  std::span<const Pose> poses() const noexcept { return poses_; }  ///< as shown, one per object of the trace
  /// What it received for the tick that it shows: the same, unless it simulates itself.
  std::span<const Pose> received() const noexcept { return prediction_ ? prediction_->heard() : poses_; }
  const Pose& watched(std::size_t user) const noexcept;         ///< pose of the object that this user looks at
  Replica& replica() noexcept { return receiver_->replica(); }  ///< pre  there is a codec

 private:
  Client(Server& server, std::optional<Receiver> receiver);
  void show_pose(std::uint32_t object, const Pose& pose) noexcept;
  void predict(std::size_t user, std::uint32_t delay) noexcept;
  std::span<const GridForce> load(std::uint32_t object) const noexcept;
  void show_shape(Receiver& receiver, std::int64_t tick, std::size_t mesh) noexcept;
  void show_poses(Receiver& receiver, std::int64_t tick) noexcept;
  Vec3 soften(std::size_t user, const Touch& touch, const Vec3& device, std::uint32_t delay) noexcept;
  template <class Work>
  auto measured(ClientCosts::Cost& cost, Work&& work) noexcept;

  const Scene& scene_;
  std::optional<Receiver> receiver_;  // none: the truth is shown, or what a network gives
  std::vector<Pose> poses_;
  std::vector<Pose> mesh_poses_;  // of deformable objects, for users who look at one
  struct ShownMesh {
    double period = 1;        // [ticks] from frame to frame
    std::int64_t frame = -1;  // shown last
  };
  std::vector<ShownMesh> shown_;        // behind a network
  const Receiver* shown_by_ = nullptr;  // likewise, and what tick of it
  std::int64_t shown_tick_ = -1;
  std::vector<bool> moves_;                     // objects that were shown elsewhere in the tick before
  std::optional<Compensation> compensation_{};  // of the delay: at most one of them
  std::unique_ptr<Prediction> prediction_{};
  std::vector<PassivityController> ports_;  // one per user, if the scene asks
  RigidView rigid_;
  std::optional<MsdView> msds_;
  std::optional<DeformableView> deformables_;
  std::vector<Touchable*> objects_;  // these, and those that the server lends
  std::vector<Vec3> rendered_;       // [N] one per user
  std::vector<std::optional<DeviceContact>> contacts_;
  std::vector<double> stiffness_;  // [N/m]
  bool measures_ = false;
  ClientCosts costs_;
};

}  // namespace tactus::sim
