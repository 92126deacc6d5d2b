// SPDX-License-Identifier: Apache-2.0
/// The proxy of a device on the surface of an elastic body: the point of the surface that is nearest to a device that went through it, as
/// near as friction lets it. spec/55-elastic.md section 4, thesis 2.3.4.1. Internal to the library.
/// binary64 in the written order: both ends must agree on every bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

class ElasticTouch {
 public:
  /// What the proxy keeps from tick to tick.
  struct State {
    bool touches = false;
    std::optional<std::uint32_t> triangle;
    std::array<double, 3> weights{};  ///< of its corners
    std::optional<Vec3> last;         ///< [m] the device at the tick before
    friend bool operator==(const State&, const State&) = default;
  };
  /// A push on the body.
  struct Push {
    std::uint32_t triangle = 0;
    std::array<double, 3> weights{};
    Vec3 force;  ///< [N]
  };

  /// pre  `object` outlives this and has a body.   allocates
  explicit ElasticTouch(const DeformableObject& object);

  /// Move the device. With `anew` one that is free is also held against the nearest triangle of all.
  /// in   position     [m]
  ///      vertices  [m] of the object, where they are now
  /// time 0.1 us, anew 15 ns per triangle; no allocation
  std::optional<Push> move(const Vec3& position, bool anew, std::span<const Vec3> vertices, State& state) const noexcept;

 private:
  struct Foot {
    std::uint32_t triangle = 0;
    std::array<double, 3> weights{};
    Vec3 point;
    double distance2 = 0;
  };
  Foot foot(const Vec3& position, std::uint32_t triangle, std::span<const Vec3> vertices) const noexcept;
  Foot nearest(const Vec3& position, std::span<const Vec3> vertices) const noexcept;
  Foot descend(const Vec3& position, std::uint32_t triangle, std::span<const Vec3> vertices) const noexcept;
  bool meets(std::uint32_t triangle, const Foot& foot) const noexcept;
  bool is_inside(const Vec3& position, const Foot& foot, std::span<const Vec3> vertices) const noexcept;
  Foot met(const Vec3& position, const Foot& foot, std::span<const Vec3> vertices, const State& state) const noexcept;
  Foot hold(const Vec3& position, std::span<const Vec3> vertices, const State& state) const noexcept;

  const DeformableObject& object_;
  ListOfLists<std::uint32_t> triangles_of_;  // by vertex, ascending
};

}  // namespace tactus
