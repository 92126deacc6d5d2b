// SPDX-License-Identifier: Apache-2.0
/// How a client's own device deforms an elastic body, shape by shape along the device's path: what both ends of a session know without a
/// packet. spec/55-elastic.md section 6. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/deformable/main_state.h>
#include <tactus/elastic/elastic_solver.h>
#include <tactus/elastic/elastic_touch.h>

namespace tactus {

class DevicePath;

/// The device of a client as its Sender and its Receiver are given it; empty: it is not known.
struct KnownDevice {
  KnownDevice() = default;
  /// in   known  null: as empty
  explicit KnownDevice(std::shared_ptr<const DevicePath> known);

  /// What it does to an object; null: the object has no body, or no device is known.   pre  scene and object outlive it.   allocates
  std::unique_ptr<FollowedShape> shape_of(const Scene& scene, const DeformableObject& object) const {
    return path && object.body ? make(scene, object, *path) : nullptr;
  }

  std::shared_ptr<const DevicePath> path;
  // A pointer, so that a program that knows no device links nothing of elastic bodies.
  std::unique_ptr<FollowedShape> (*make)(const Scene&, const DeformableObject&, const DevicePath&) = nullptr;
};

class DrivenShape final : public FollowedShape {
 public:
  /// pre  the object has a body; all outlive this.   allocates, the last 32 shapes or so
  DrivenShape(const Scene& scene, const DeformableObject& object, const DevicePath& path);

  /// time O(vertices) if the path has not changed and no shape is new; else a step (ElasticSolver) for each new shape, and for each whose
  ///      past has changed. No allocation
  bool show(const MainState& state, std::int64_t tick, std::span<Vec3i> shown) noexcept override;
  bool body_at(std::int64_t tick, std::span<Vec3i> shape) noexcept override;
  void follow(std::int64_t tick) noexcept override { advance(tick / solver_.ticks()); }

 private:
  using Position = std::optional<Vec3i>;
  /// A shape, and what the device did while it was there.
  struct Frame {
    explicit Frame(const ElasticSolver& solver) : state(solver.vertices()), positions(solver.ticks()) {}
    ElasticState state;
    bool moves = false;  // by itself
    ElasticTouch::State touch;
    std::vector<Position> positions;  // by tick
  };

  Frame& frame(std::int64_t number) noexcept { return frames_[static_cast<std::size_t>(number) % frames_.size()]; }
  bool advance(std::int64_t number) noexcept;
  void begin(std::int64_t number) noexcept;
  void forget_what_changed() noexcept;
  void step() noexcept;
  bool push() noexcept;
  bool read(std::int64_t number, std::span<Vec3i> shape) noexcept;

  const DevicePath& path_;
  ElasticSolver solver_;
  ElasticTouch touch_;
  std::vector<Frame> frames_;             // a ring, by number
  std::int64_t first_ = 0, newest_ = -1;  // numbers of the shapes since the last begin(); newest_ < first_: there was none
  bool is_broken_ = false;                // the newest is the last
  std::uint64_t revision_ = 0;            // of the path
  std::vector<Vec3> surface_;             // [m] of a shape
  std::vector<double> load_;              // [N] 3 per vertex
  std::vector<Vec3i> from_, shape_;       // on the grid: that at a state's tick; the one asked for
  std::int64_t from_number_ = -1;
};

}  // namespace tactus
