// SPDX-License-Identifier: Apache-2.0
/// A client's own simulation: what its user touches gives way at once, not after a round trip (client-side prediction; thesis 5.2).
///
/// The scene runs at the client as it does at the server, under the device of the client's own user; the pushes of the others on rigid
/// objects come with the loads (load/load_state.h). So its state is what the server's will be when the device's sample of now has
/// got there. What the server sends is R old, as an answer to the device, and is compared with the own state of R ago:
///
///   rigid objects  e = server's pose - own pose of R ago, with all that was corrected since. In each tick the own pose follows by the
///                  fraction T_s / 0.1 s of e: no force jumps. Less than 0.1 mm and 2 mrad are the codec's, and left alone.
///                  What cannot move stays where the scene has it.
///   others         shown = own shape + mean of (server's shape - own shape of R ago), over 0.02 s: elastic objects keep no error
///
/// The user feels what is shown. The own simulation takes the device, not the force of the client, so that nothing but the hand goes round
/// the loop with the delay in it. Nothing of this is coded, sent or bounded: bounds are those of the server's state.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/server.h>

namespace tactus::sim {

// ==== past poses ====
// Where an object was in the last ticks. One that does not move takes no time.

class PastPoses {
 public:
  /// in   first  pose at all ticks before the first add()
  ///      ticks  how many poses are kept
  PastPoses(const Pose& first, std::size_t ticks) : entries_(std::max<std::size_t>(1, ticks)) {
    entries_[0] = {INT64_MIN, first};
  }

  /// The pose of a tick, later than all before; nothing if it is the last one.   time O(1), no allocation
  void add(std::int64_t tick, const Pose& pose) noexcept {
    const Pose& last = back(0).pose;
    if (pose.position == last.position && pose.rotation == last.rotation) return;
    next_ = (next_ + 1) % entries_.size();
    count_ = std::min(count_ + 1, entries_.size());
    entries_[next_] = {tick, pose};
  }
  /// The pose at a tick, or the oldest that is kept.   time O(log ticks)
  const Pose& at(std::int64_t tick) const noexcept {
    std::size_t newer = 0, older = count_ - 1;  // back(older) is not later than the tick, or the oldest
    while (newer < older) {
      const std::size_t middle = (newer + older) / 2;
      if (back(middle).tick <= tick) older = middle;
      else newer = middle + 1;
    }
    return back(older).pose;
  }

 private:
  struct Entry {
    std::int64_t tick = 0;
    Pose pose;
  };
  const Entry& back(std::size_t i) const noexcept { return entries_[(next_ + entries_.size() - i) % entries_.size()]; }

  std::vector<Entry> entries_;  // ring
  std::size_t next_ = 0;        // the newest
  std::size_t count_ = 1;
};

// ==== past shapes ====
// Shapes of a client's own simulation of a deformable object, and what the server's shapes say of them.

class PastShapes {
 public:
  using Displacement = std::array<std::int32_t, 3>;
  static constexpr unsigned kExp = 20;  ///< shapes are shown in steps of 2^-kExp m

  /// in   ticks   how far back shapes are kept
  ///      period  [ticks] from shape to shape
  PastShapes(std::size_t vertices, double ticks, double period);

  /// A new shape of the own simulation.   in  displacements  V x 3 [m]   time O(V), no allocation
  void add(std::int64_t tick, std::span<const float> displacements) noexcept;
  /// The server's newest shape, until compare().   in  displacements  [2^-position_exp m]   time O(V), no allocation
  void hear(std::span<const Displacement> displacements, unsigned position_exp, double age) noexcept;
  /// [ticks] age of a shape that was heard and not compared; none: negative
  double heard_age() const noexcept { return age_; }
  /// Compare what was heard with the own shape of that tick, between those before and after it; forget it.
  /// in   fraction  of the difference that is taken over
  /// time O(V), no allocation
  void compare(double tick, double fraction) noexcept;
  /// The own newest shape and what the server's add to it.   time O(V), no allocation
  void show() noexcept;
  /// Instead: what was heard, as it is.
  void show_heard() noexcept;
  std::span<const Displacement> shown() const noexcept { return shown_; }
  std::int64_t newest() const noexcept { return ticks_[next_]; }  ///< tick of the own newest shape

 private:
  const float* back(std::size_t i) const noexcept {
    return shapes_.data() + ((next_ + ticks_.size() - i) % ticks_.size()) * size_;
  }
  std::int64_t tick_back(std::size_t i) const noexcept { return ticks_[(next_ + ticks_.size() - i) % ticks_.size()]; }

  std::size_t size_;                 // 3 V
  double period_;                    // [ticks]
  std::vector<std::int64_t> ticks_;  // of the own shapes
  std::vector<float> shapes_;        // [m] ring
  std::size_t next_ = 0;             // the newest
  std::vector<float> offset_;        // [m] mean of server's - own
  std::vector<float> heard_;         // [m]
  std::vector<Displacement> shown_;
  double age_ = -1;
};

// ==== prediction ====

class Prediction {
 public:
  static constexpr std::uint32_t kMostDelay = 1000;  ///< [ticks] older states of the server correct as if they were so old

  /// in   scene  what is simulated: the server's, as far as it is known
  ///      user   whose device it is
  /// err  of Server::create
  /// space 64 kB for each rigid object that can move, 1 s of shapes for each that yields
  static Result<std::unique_ptr<Prediction>> create(const Scene& scene, std::size_t user);

  using Shape = std::span<const std::array<std::int32_t, 3>>;  ///< V x 3
  /// What the server's state at the client is in this tick. What is not sent stays.   no allocation
  /// in   tick  of the server
  void hear(std::uint32_t object, const Pose& pose, std::int64_t tick) noexcept;
  /// The newest shape of a deformable object.   in  displacements  [2^-position_exp m]
  void hear(std::size_t mesh, Shape displacements, unsigned position_exp, std::int64_t tick) noexcept;
  /// What other users push a rigid object with [N], in every tick.
  void push(std::uint32_t object, const Vec3& force) noexcept { pushes_[object] = force; }

  /// Correct the state of this tick by what was heard.   in  delay  [ticks] R; 0: not known, the state is that of the server
  /// no allocation
  void correct(std::uint32_t delay) noexcept;
  std::span<const Pose> heard() const noexcept { return heard_; }  ///< poses, as they were received
  std::span<const Pose> poses() const noexcept { return poses_; }  ///< of this tick, one per rigid and one-dimensional object
  /// The shape of a deformable object that is new in this tick [2^-PastShapes::kExp m]; none: empty.
  Shape new_shape(std::size_t mesh) const noexcept { return meshes_[mesh].is_new ? meshes_[mesh].past.shown() : Shape(); }
  /// Advance by one tick. Where the physics breaks down, or memory runs out, the state is from then on that of the server.
  void step(const DeviceSample& device) noexcept;

 private:
  struct Yielding {
    std::int64_t period;   // [ticks] from one position of the surface to the next
    std::int64_t age = 0;  // [ticks] of the position that was heard
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
  void show_heard() noexcept;
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
