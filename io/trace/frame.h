// SPDX-License-Identifier: Apache-2.0
/// The true state at one tick, in SI units, uncompressed. A trace is a sequence of frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene_objects.h>
#include <tactus/trace/device_reports.h>

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

/// Which of a user's forces a trace knows. Servers do not receive what was rendered to a hand, nor clients what the server rendered.
enum class RecordedForces : std::uint8_t {
  both,
  rendered,  ///< UserSample::server_force is 0
  server,    ///< UserSample::force is the server's
};

struct TraceUser {
  std::string name;
  DeviceSenses senses{};   ///< of the user's device; a quantity that it does not sense has no channel
  bool has_servo = false;  ///< a device was captured: how each of its ticks went
  /// What the input reports of the device mean (HID 1.11, section 6.2.2); none: they are not in the trace.
  std::optional<std::vector<std::uint8_t>> report_descriptor{};
  RecordedForces forces = RecordedForces::both;
  friend bool operator==(const TraceUser&, const TraceUser&) = default;
};

/// Error bounds of the stream that a replica was decoded from, and the data that show where they hold.
struct TraceBounds {
  StreamBounds stream;
  std::uint8_t position_exp = GridExponents{}.position;  ///< grid of positions: 2^-position_exp m
  std::vector<std::uint8_t> rings{};                     ///< per mesh: size of the area of interest
};

/// Circumstances of a capture. Text of the user and of the device, UTF-8.
struct TraceCapture {
  std::int64_t started = 0;         ///< [ns] since 1970-01-01 UTC, of tick 0, >= 0
  std::string device{}, backend{};  ///< model and serial number; "falcon"
  std::string scheduling{};         ///< what real-time privileges the loop had
  std::string subject{}, remarks{};
  friend bool operator==(const TraceCapture&, const TraceCapture&) = default;
};

struct TraceInfo {
  std::uint32_t tick_rate = 1000;  ///< ticks per second
  std::vector<TraceObject> objects;
  std::vector<TraceUser> users;  ///< empty: a recording without touch
  std::string source;            ///< "sim push-1dof seed 1", "import cube-tosses.csv"
  std::string scene;             ///< scene file (TOML) attached to the trace; may be empty
  std::vector<TraceDeformable> meshes{};
  std::optional<TraceBounds> bounds{};    ///< of a replica whose stream declares them
  bool shows_past = false;                ///< a client behind a network: what it shows at a tick is of an earlier one
  std::optional<TraceCapture> capture{};  ///< a device was captured: ticks may have markers
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

/// How a tick of a captured device went.
struct ServoSample {
  std::int64_t lateness = 0;  ///< [ns] the tick began so long after its time, >= 0
  std::int64_t age = 0;       ///< [ns] of the device's sample when the tick began, >= 0
  std::uint32_t missed = 0;   ///< ticks left out before this one, because one before took too long
  std::uint32_t guard = 0;    ///< what was done to the force: bit i is device::GuardAction i
  friend bool operator==(const ServoSample&, const ServoSample&) = default;
};

/// One user at one tick.
struct UserSample {
  DeviceSample device;
  Contact contact;    ///< contact.device is device.position
  Vec3 force;         ///< [N] rendered at the client, to the hand (RecordedForces)
  Vec3 server_force;  ///< [N] rendered at the server from the true state, same device sample
  std::optional<SurfaceContact> surface_contact{};
  ServoSample servo{};      ///< only with TraceUser::has_servo
  DeviceReports reports{};  ///< that came since the tick before; only with TraceUser::report_descriptor
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
  std::int64_t shown = 0;  ///< tick whose objects and meshes these are, never falls; only with TraceInfo::shows_past
  std::string marker{};    ///< what the experimenter marked at this tick, UTF-8; empty: nothing; only with TraceInfo::capture
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
  std::int64_t last() const noexcept { return last_; }  ///< 0 before the first
  /// [ticks] from the first to the last, both included
  std::uint64_t length() const noexcept { return count_ == 0 ? 0 : static_cast<std::uint64_t>(last_ - first_) + 1; }
  std::uint64_t left_out() const noexcept { return length() - count_; }

 private:
  std::uint64_t count_ = 0;
  std::int64_t first_ = 0, last_ = 0;
};

}  // namespace tactus
