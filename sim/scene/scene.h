// SPDX-License-Identifier: Apache-2.0
/// Scenes: what a simulation contains, read from TOML. sim/scenes/README.md lists every key. SI units throughout.
/// What a scene does not name is absent: without users no contact is computed, without a floor nothing collides with one.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/base/geometry.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/sim/msd/msd.h>
#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {

inline constexpr std::uint32_t kTickRate = 1000;  ///< [Hz] haptic rate of every scene
inline constexpr double kTick = 1e-3;             ///< [s]
inline constexpr double kLeastDeviceScale = 1e-3, kLargestDeviceScale = 1e3;

/// A rigid object: a box, or a solid of any shape.
struct SceneObject {
  std::string name;
  Vec3 size;                    ///< [m] edge lengths; of a solid, its extent along each axis
  TriMesh surface;              ///< [m] of a solid, closed, around its centre of mass; without triangles: a box
  double mass = 0;              ///< [kg]
  double friction = 0;          ///< Coulomb coefficient against the floor and other objects (the smaller of two counts)
  double damping = 1;           ///< d: velocities are multiplied by it every millisecond; 1: none
  std::uint8_t dof = Dof::all;  ///< none: a static object
  Pose pose;                    ///< at tick 0, of the centre of box or mass
  Vec3 velocity;                ///< [m/s] at tick 0, of that centre
  Vec3 angular_velocity;        ///< [rad/s] at tick 0, world frame
};

struct SceneMaterial {
  double young = 0;    ///< E [N/m^2]
  double poisson = 0;  ///< nu
  double density = 0;  ///< [kg/m^3]
};

/// An elastic body. Probes and gravity act on it; it collides with neither the floor nor other objects.
struct SceneDeformable {
  std::string name;
  TetMesh mesh;                                  ///< at rest, world frame
  std::vector<SceneMaterial> materials;          ///< one for all or one per tetrahedron
  std::vector<std::uint32_t> fixed;              ///< vertices that never move
  bool corotated = true;                         ///< else linear elasticity, for small rotations only
  double mass_damping = 0;                       ///< [1/s]
  double stiffness_damping = 0;                  ///< [s]
  double stiffness = 0;                          ///< k_s = k_c [N/m] of the coupling with each probe
  double friction = 0;                           ///< of the virtual proxies
  std::string method = "auto", solver = "auto";  ///< of time integration; auto: chosen by the scene's stiffness
  std::uint32_t rate = 1;                        ///< N: deformed every N ticks (thesis figure 4.14), 1..1000
};

/// A mass on a spring and a damper that yields along one axis (thesis 4.3.1): an infinite plane, pressed from its outer side.
/// Neither gravity nor other objects act on it.
struct SceneMsd {
  std::string name;
  MsdObject object;
  Vec3 position;             ///< [m] of the surface at rest
  unsigned axis = 2;         ///< along which it moves: 0, 1, 2
  Vec3 normal{0, 0, 1};      ///< outward normal of the surface, along that axis
  double touch_damping = 0;  ///< b_c [N s/m] of the coupling at the clients
  std::uint32_t rate = 1;    ///< N: deformed every N ticks (thesis figure 4.14), 1..1000
  std::uint8_t dof() const noexcept { return static_cast<std::uint8_t>(Dof::x << axis); }
};

/// Haptic rendering parameters of all objects of the scene (thesis 2.3.4.1, 3.2.4.1, 3.2.5.1).
struct SceneTouch {
  double stiffness = 0;       ///< k_o [N/m]
  double friction = 0;        ///< of the virtual proxy
  double lift_stiffness = 0;  ///< [N/m] spring that ties the probe to the touched point while the button is down
  double max_damping = 0;     ///< [N s/m] of the passivity controllers at the clients (sim/user/passivity.h); 0: there are none
};

/// How clients make up for the delay of what they show.
enum class CompensationMethod : std::uint8_t {
  stiffness,         ///< they render it softer (sim/client.h; thesis 4.2.3 and 4.3.3)
  stiffness_thesis,  ///< likewise, what is rigid by algorithm 1 as printed: for comparison
  simulation,        ///< they simulate it themselves, and the server corrects them (sim/prediction/prediction.h; thesis 5.2)
};

/// Clients make up for delay.
struct SceneCompensation {
  CompensationMethod method = CompensationMethod::stiffness;
  std::optional<double> filter{};  ///< lambda of StiffnessReduction; none: by what is touched
  bool is_softer() const noexcept { return method != CompensationMethod::simulation; }
};

/// What the probe of a user hangs on. The probe moves `scale` times as far as the device, and the device exerts force / scale: what is touched
/// feels as stiff as it is. Lengths and forces here are those at the probe.
struct SceneDevice {
  double scale = 1;
  double max_force = 3.3;                ///< [N] the rendered force is clipped to it
  double resolution = 0.055e-3;          ///< [m] encoder step
  std::uint32_t filter = 8;              ///< length of the moving average over positions, 1: none
  std::uint8_t axes = Dof::translation;  ///< the hand moves the probe along these only
};

enum class Grip : std::uint8_t { loose, normal, firm };

/// Reference frame of a waypoint, fixed when its phase begins: the user looks once, then moves. z is up in all of them.
enum class PathFrame : std::uint8_t {
  world,
  hand,         ///< origin where the last movement ended, world axes
  object,       ///< origin at the object's centre, x along that face normal of the object which points most along world x
  toward_goal,  ///< origin at the object's centre, x from there to the goal
  at_goal,      ///< origin at the goal, x as in toward_goal
};

/// One minimum-jerk movement from the end of the last one. With `turns` it circles a vertical axis at constant speed, while
/// radius and height change evenly from start to end.
struct PathPhase {
  std::string name;
  PathFrame frame = PathFrame::world;
  Vec3 to;              ///< [m]
  double duration = 0;  ///< [s]
  bool button = false;  ///< held down during the phase
  double turns = 0;     ///< whole turns before `to`, counter-clockwise seen from above; 0: a movement straight ahead
  Vec3 centre{};        ///< [m] on the axis of the turns, in the same frame as `to`
};

struct SceneUser {
  std::string name;
  Grip grip = Grip::normal;
  double duration_scale = 1;  ///< times the duration of every phase: 0.5 is twice as fast
  double tremor = 0;          ///< [m] RMS per axis of the free probe, 8-12 Hz
  double variation = 0;       ///< fraction by which hand, speed and targets vary with the seed
  double scatter = 0;         ///< [m] by which targets vary with the seed
  std::uint32_t object = 0;   ///< the object that the user looks at: index over the objects, then the msds, then the deformables
  Vec3 goal;                  ///< [m] target position of that object
  Vec3 start;                 ///< [m] of the probe
  SceneDevice device;
  std::vector<PathPhase> path;

  /// What the device reports besides its position.
  DeviceSenses senses() const noexcept {
    return {.buttons = std::ranges::any_of(path, [](const PathPhase& phase) { return phase.button; })};
  }
};

/// How far away rigid objects are sent to clients. spec/44-interest.md section 1
struct SceneInterest {
  double full = 0;   ///< [m] in full up to here, with bounds twice as wide at twice the distance
  double reach = 0;  ///< [m] not at all beyond
};

struct Scene {
  std::string name;
  std::string text;                               ///< the file itself, for the trace
  Vec3 gravity;                                   ///< [m/s^2]
  double duration = 0;                            ///< [s]
  std::optional<double> floor;                    ///< [m] height of a plane that carries the objects
  std::optional<double> world_size;               ///< [m] how far from the origin positions get, along any axis; none: 512 m
  std::optional<SceneTouch> touch;                ///< set whenever there are users
  std::optional<SceneCompensation> compensation;  ///< none: loads are neither computed nor sent
  std::optional<SceneInterest> interest;          ///< none: clients are sent all objects in full
  std::vector<SceneObject> objects;               ///< order of trace and stream
  std::vector<SceneMsd> msds;                     ///< in trace and stream after the objects, as objects of one degree of freedom
  std::vector<SceneDeformable> deformables;
  std::vector<SceneUser> users;
};

/// Location, broken rule and remedy of an error in a scene file.
///   R-SCN-1 the file cannot be read    R-SCN-2 not TOML                  R-SCN-3 unknown key       R-SCN-4 key missing
///   R-SCN-5 wrong type                 R-SCN-6 value out of range        R-SCN-7 unknown or repeated name
///   R-SCN-8 a file that the scene names cannot be used               R-SCN-9 over 4 MiB, or nested over 32 deep

/// err  R-SCN-1..9; `file` names the location in errors; other files are looked for beside it.
tl::expected<Scene, Diagnostic> parse_scene(std::string_view text, std::string_view file);
tl::expected<Scene, Diagnostic> load_scene(const std::string& path);
/// The scene that a trace carries, which a stranger may have written: it names files that come with Tactus, no paths.
/// err  R-SCN-2..9
tl::expected<Scene, Diagnostic> parse_attached_scene(std::string_view text);

/// Path of a scene: `name` itself if it is a file, else <name>.toml among the scenes that come with Tactus.   err  R-SCN-1
tl::expected<std::string, Diagnostic> find_scene(const std::string& name);

/// Of the file and the meshes that it names: equal for equal scenes, else almost certainly different; never 0.
std::uint64_t fingerprint(const Scene& scene) noexcept;

/// All hands take `factor` times their time, and the scene lasts as much longer or shorter.   pre  factor > 0
void scale_durations(Scene& scene, double factor) noexcept;
/// [m] RMS per axis, of all hands; that of their probes is `scale` times it.
void set_tremor(Scene& scene, double rms) noexcept;

/// Whether clients need the forces on its objects: they make up for delay, and something can be pushed.
bool sends_loads(const Scene& scene) noexcept;

/// The rigid objects of this scene for a sender: in order, at rest in their first poses; with loads if clients make up for delay.
/// in   driven  what a client's device may move, one per rigid object; empty: nothing
SceneBuilder scene_builder(const Scene& scene, std::span<const std::optional<DrivenPhysics>> driven = {});

}  // namespace tactus::sim
