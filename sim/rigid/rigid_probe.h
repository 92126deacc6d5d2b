// SPDX-License-Identifier: Apache-2.0
/// Haptic rendering of rigid objects. Solids of any shape: surface_proxy.h. Boxes: virtual proxy (god object) with friction cone.
/// Thesis 2.3.4.1, figure 2.6, eq. 2.6.
///
/// The proxy stays on the face where the probe entered as long as the probe is inside: a thin box does not let the probe through,
/// and an edge does not turn the force. The proxy is kept in the box's frame and so moves with the box.
///   g      foot of the probe on the face's plane          depth = |x_d - g|
///   inside the cone  |x_p - g| <= mu depth: the proxy stays (static friction)
///   outside          it follows to the circle's rim:  x_p = g + mu depth (x_p - g) / |x_p - g|
/// A proxy that slides over the face's border loses its support. It joins the probe, which is then outside the box.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/rigid/trigger.h>
#include <tactus/sim/contact/surface_proxy.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>

namespace tactus::sim {

/// A face of a box: the one across +axis or -axis.
struct BoxFace {
  std::uint8_t axis = 0;  ///< 0, 1, 2
  bool negative = false;
};

/// Proxy of one probe against one box. Everything in the box's frame.   time O(1), about 20 ns; no allocation.
class BoxProxy {
 public:
  /// in  half  [m] half edge lengths
  BoxProxy(const Vec3& half, double friction) noexcept : half_(half), friction_(friction) {}

  /// Place the probe without history; inside the box the nearest face holds it.
  void move_to(const Vec3& probe) noexcept;
  /// Move the probe there.
  void move(const Vec3& probe) noexcept;

  bool touches() const noexcept { return face_.has_value(); }
  const std::optional<BoxFace>& face() const noexcept { return face_; }  ///< none: free
  const Vec3& position() const noexcept { return proxy_; }               ///< free: where the probe is
  Vec3 normal() const noexcept;                                          ///< of the face touched, outward

 private:
  bool enter(const Vec3& probe) noexcept;
  void slide(const Vec3& probe) noexcept;

  Vec3 half_;
  double friction_;
  Vec3 proxy_;
  std::optional<BoxFace> face_;
};

/// A probe among the scene's rigid objects. It touches one at a time: the first one met, until it lets go.
///
/// A caller that reports each object that moves (expect_attend(), attend()) pays only for those and for objects within reach. The
/// others, which are still and more than 0.1 m away, are checked again when the probe has covered a part of that distance. Forces
/// are the same, bit for bit.
class RigidProbe {
 public:
  /// Copies share the surfaces.
  RigidProbe(std::span<const SceneObject> objects, const SceneTouch& touch);
  /// From now on the caller calls attend() before each move() for every object whose pose is not what it was in the last move().
  void expect_attend() noexcept { attended_only_ = true; }
  /// Report that this object will have another pose in the next move().   in  pose  that of the last move()   time O(near
  /// objects)
  void attend(std::uint32_t object, const Pose& pose);

  /// Advance to a new device position and new poses.
  /// in   device  [m] x_d, world frame
  ///      button  down while an object is touched: a spring ties the probe to the touched point until the button comes up
  ///      poses   one per object
  /// out  the force k_o (x_p - x_d), or the lifting spring's
  /// time O(objects), about 50 ns for a box; with attend() O(near objects), and occasionally 3 ns for each of the others; no
  ///      allocation
  Touch move(const Vec3& device, bool button, std::span<const Pose> poses) noexcept;

 private:
  using Proxy = std::variant<BoxProxy, SurfaceProxy>;

  void move_to(std::uint32_t object, const Vec3& device, const Pose& pose) noexcept;
  void move_all(const Vec3& device, std::span<const Pose> poses) noexcept;
  void look_around(const Vec3& device, std::span<const Pose> poses) noexcept;
  bool move_one(std::size_t object, const Vec3& device, std::span<const Pose> poses) noexcept;
  void follow(const Vec3& device, std::span<const Pose> poses) noexcept;

  SceneTouch touch_;
  std::vector<Proxy> proxies_;
  std::optional<std::uint32_t> touched_;  // index of the object
  std::optional<Vec3> anchor_;            // of the lifting spring, in the frame of object touched_
  bool placed_ = false, attended_only_ = false;
  struct Seen {
    double reach = 0;               // [m] of the object from its centre
    std::uint64_t attended_at = 0;  // move in which attend() named it
    bool near = true;
  };
  std::vector<Seen> seen_;           // one per object
  std::vector<std::uint32_t> near_;  // ascending; every other proxy is free, at device_
  Vec3 device_, looked_from_;        // in the last move; where look_around() was
  std::uint64_t moves_ = 0;
};

}  // namespace tactus::sim
