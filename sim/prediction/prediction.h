// SPDX-License-Identifier: Apache-2.0
/// A client's own simulation: what its user touches gives way at once, not after a round trip (client-side prediction; thesis 5.2).
///
/// The scene runs at the client as it does at the server, under the device of the client's own user; the pushes of the others on rigid
/// objects come with the loads (load/load_state.h). So its state is what the server's will be when the device's sample of now has
/// got there. What the server tells is R old, as an answer to the device, and is compared with the own state of R ago:
///
///   rigid objects  e = server's pose - own pose of R ago, with all that was corrected since. In each tick the own pose follows by the
///                  share T_s / 0.1 s of e: no force jumps. Less than 0.1 mm and 2 mrad are the codec's, and left alone.
///                  What cannot move stays where the scene has it.
///   others         shown = own shape + mean of (server's shape - own shape of R ago), over 0.02 s: elastic objects keep no error
///
/// The user feels what is shown. The own simulation takes the device, not the force of the client, so that nothing but the hand goes round
/// the loop with the delay in it. Nothing of this is coded, sent or bounded: bounds are those of the server's state.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/sim/prediction/past_poses.h>
#include <tactus/sim/prediction/past_shapes.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/server.h>

namespace tactus::sim {

class Prediction {
 public:
  static constexpr std::uint32_t kMostDelay = 1000;  ///< [ticks] older states of the server correct as if they were so old

  /// in   scene  what is simulated: the server's, as far as it is known
  ///      user   whose device it is
  /// err  of Server::create
  /// space 64 kB for each rigid object that can move, 1 s of shapes for each that yields
  static Result<std::unique_ptr<Prediction>> create(const Scene& scene, std::size_t user);

  using Shape = std::span<const std::array<std::int32_t, 3>>;  ///< V x 3
  /// What the server's state at the client is in this tick. What is not told stays.   no allocation
  /// in   tick  of the server
  void hear(std::uint32_t object, const Pose& pose, std::int64_t tick) noexcept;
  /// The newest shape of a deformable object.   in  displacements  [2^-position_exp m]
  void hear(std::size_t mesh, Shape displacements, unsigned position_exp, std::int64_t tick) noexcept;
  /// What other users push a rigid object with [N], in every tick.
  void push(std::uint32_t object, const Vec3& force) noexcept { pushes_[object] = force; }

  /// Correct the state of this tick by what was heard.   in  delay  [ticks] R; 0: not known, the state is that of the server
  /// no allocation
  void correct(std::uint32_t delay) noexcept;
  std::span<const Pose> heard() const noexcept { return heard_; }  ///< poses, as they were told
  std::span<const Pose> poses() const noexcept { return poses_; }  ///< of this tick, one per rigid and one-dimensional object
  /// The shape of a deformable object that is new in this tick [2^-PastShapes::kExp m]; none: empty.
  Shape new_shape(std::size_t mesh) const noexcept { return meshes_[mesh].is_new ? meshes_[mesh].past.shown() : Shape(); }
  /// Advance by one tick. Where the physics breaks down, or memory runs out, the state is from then on that of the server.
  void step(const DeviceSample& device) noexcept;

 private:
  struct Yielding {
    std::int64_t period;   // [ticks] from one place of the surface to the next
    std::int64_t age = 0;  // [ticks] of the place that was heard
    Vec3 offset{};         // [m] mean of server's - own
  };
  struct Mesh {
    PastShapes past;
    double period;  // [ticks]
    bool is_new = false;
  };
  Prediction(const Scene& scene, std::unique_ptr<Server> own);
  void show_own() noexcept;
  void follow() noexcept;
  void tell_heard() noexcept;
  void correct_rigid(std::uint32_t object, std::int64_t then) noexcept;
  void correct_yielding(std::size_t object, std::int64_t then) noexcept;
  void correct_shape(std::size_t number, std::int64_t then) noexcept;
  void move(std::uint32_t object, const Vec3& by, const Vec3& turn_by) noexcept;
  Pose without_corrections(std::size_t object) const noexcept;

  std::size_t rigid_;  // objects; those that follow are one-dimensional
  std::unique_ptr<Server> own_;
  std::vector<Pose> heard_, poses_;
  std::vector<PastPoses> pasts_;    // one per object; of rigid ones without the corrections
  std::vector<std::uint8_t> free_;  // Dof per rigid object
  std::vector<Vec3> pushes_;        // [N] likewise
  std::vector<Pose> corrections_;   // likewise, sum
  std::vector<Yielding> yielding_;  // one per one-dimensional object
  std::vector<Mesh> meshes_;
  bool has_heard_ = false, is_broken_ = false;
};

}  // namespace tactus::sim
