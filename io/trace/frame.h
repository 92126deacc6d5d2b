// SPDX-License-Identifier: Apache-2.0
/// The true state at one tick, in SI units, uncompressed. A trace is a sequence of frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/device_sample.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/rigid/contact.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/bounds.h>

namespace tactus {

/// What a trace's channels describe. A quantity that the scene lacks has no channel.
struct TraceObject {
  std::string name;
  std::uint8_t dof = Dof::all;
};

/// A deformable object: its surface before anything acted on it.
struct TraceDeformable {
  std::string name;
  TriMesh rest;                        ///< [m] world frame
  std::vector<std::uint32_t> fixed{};  ///< vertices that can never move, ascending
  double period = 1;                   ///< nominal frame period [ticks], > 0
};

struct TraceUser {
  std::string name;
  DeviceSenses senses{};  ///< of the user's device; a quantity that it does not sense has no channel
  friend bool operator==(const TraceUser&, const TraceUser&) = default;
};

/// Error bounds of the stream that a replica was decoded from, and the data that tell where they hold.
struct TraceBounds {
  StreamBounds stream;
  std::uint8_t position_exp = GridExponents{}.position;  ///< grid of positions: 2^-position_exp m
  std::vector<std::uint8_t> rings{};                     ///< per mesh: size of the area of interest
};

struct TraceInfo {
  std::uint32_t tick_rate = 1000;  ///< ticks per second
  std::vector<TraceObject> objects;
  std::vector<TraceUser> users;  ///< empty: a recording without touch
  std::string source;            ///< "sim push-1dof seed 1", "import cube-tosses.csv"
  std::string scene;             ///< scene file (TOML) attached to the trace; may be empty
  std::vector<TraceDeformable> meshes{};
  std::optional<TraceBounds> bounds{};  ///< of a replica whose stream tells them
};

/// Contact of one user's probe with the surface of a deformable object.
struct SurfaceContact {
  std::uint32_t mesh = 0;                  ///< into TraceInfo::meshes
  std::uint32_t triangle = 0;              ///< touched
  std::array<double, 3> weights{1, 0, 0};  ///< of the triangle's corners at the touched point, >= 0, sum 1
  Vec3 proxy;                              ///< [m] world frame
  Vec3 normal{0, 0, 1};                    ///< of the touched surface, world frame, outward, unit length
  double stiffness = 0;                    ///< [N/m] of the coupling between proxy and device, > 0
};

/// One user at one tick.
struct UserSample {
  DeviceSample device;
  Contact contact;    ///< contact.device is device.position
  Vec3 force;         ///< [N] rendered at the client, what the hand felt
  Vec3 server_force;  ///< [N] rendered at the server from the true state, same device sample
  std::optional<SurfaceContact> surface_contact{};
};

/// Shape of one mesh. Deformations may be computed less often than every tick; in between the last shape holds.
struct DeformableSample {
  bool updated = false;              ///< the shape is new at this tick
  std::vector<float> displacements;  ///< [m] x y z of vertex 0 first, from the rest shape, world frame
};

struct TraceFrame {
  std::int64_t tick = 0;
  std::vector<RigidSample> objects;        ///< order of TraceInfo::objects
  std::vector<UserSample> users;           ///< order of TraceInfo::users
  std::vector<DeformableSample> meshes{};  ///< order of TraceInfo::meshes
  /// Objects that may differ from the tick before, ascending; none: any of them may. Set by sources that know. Valid only if the
  /// frame directly follows that of the tick before. Code that changes `objects` afterwards resets it.
  std::optional<std::vector<std::uint32_t>> changed{};
};

/// Which ticks were seen. A recording skips ticks where its samples are sparser than ticks, or pause; time continues there.
class TickSpan {
 public:
  /// pre  `tick` is larger than the last
  void add(std::int64_t tick) noexcept {
    if (count_++ == 0) first_ = tick;
    last_ = tick;
  }
  std::uint64_t count() const noexcept { return count_; }
  /// [ticks] from the first to the last, both included
  std::uint64_t length() const noexcept { return count_ == 0 ? 0 : static_cast<std::uint64_t>(last_ - first_) + 1; }
  std::uint64_t left_out() const noexcept { return length() - count_; }

 private:
  std::uint64_t count_ = 0;
  std::int64_t first_ = 0, last_ = 0;
};

}  // namespace tactus
