// SPDX-License-Identifier: Apache-2.0
/// A scene from SI units.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// How rigid objects are coded. What is declared of it decides how a sender codes, and what clients show.
enum class RigidProfile : std::uint8_t {
  thesis,  ///< linear dead reckoning from true velocities; clients jump to an update, or smooth what they show (Interpolation)
  main,    ///< updates send look-ahead velocities, to last longer, and how clients pass over to them: what is
           ///< shown and rendered does not jump, and the bounds hold meanwhile
};

/// A box or anything like it that a client's device pushes or holds.
struct DrivenPhysics {
  double mass = 0;       ///< [kg]
  Vec3 inertia{};        ///< [kg m^2] about the axes of the object's frame
  double stiffness = 0;  ///< [N/m] of the coupling between device and proxy
  double hold = 0;       ///< [N/m] of that between device and an object that it holds; 0: it holds none
  double friction = 0;   ///< of the proxy on it
  double damping = 0;    ///< [1/s] rate at which its velocities die away by themselves
};

struct RigidOptions {
  std::uint8_t dof = Dof::all;  ///< degrees of freedom (struct Dof)
  /// Let a client predict from its own device where the object goes. In sessions alone.
  std::optional<DrivenPhysics> driven{};
};

/// What a deformable object is made of, that a client's device deforms.
struct ElasticPhysics {
  ElasticBody body{};         ///< but for its inner vertices
  std::vector<Vec3> inner{};  ///< [m] at rest, world frame
};

/// How the stream of a deformable object is coded.
struct DeformableCoding {
  DeformableProfile profile = DeformableProfile::main;
  std::uint8_t rings = 3;       ///< m: size of the area of interest around the touched triangle
  std::uint8_t quant_bits = 8;  ///< thesis: q
  bool models_kept = false;     ///< thesis: entropy models are part of the state
  double frame_period = 1;      ///< main: [ticks] from shape to shape, > 0
  bool layered = false;         ///< separate packets for the haptic and the visual layer
  /// main, with a basis: fraction of what corrections added to it that fades per second, 0..1; none: 0.98, or 0 where nearly every vertex
  /// is coded in every packet, as for a declared visual bound of 0.01 mm and less
  std::optional<double> fade{};
  /// main: sets of the parents' weights that packets may name (DeformableObject); 0: the second alone with a basis, else the first, and
  /// the first for such a bound
  std::uint8_t weight_sets = 0;
  ModeBasis basis{};             ///< main
  SpringBasis spring_basis{};    ///< main; with modes it takes the place of `basis`
  ClusterBasis cluster_basis{};  ///< main; with clusters it takes the place of both
  /// [N/m] of each vertex, infinite where it does not move; empty: not declared. What clients with delay render by (StiffnessReduction).
  std::vector<double> stiffness{};
  /// main: let a client work out from its own device how the object deforms. In sessions alone.
  std::optional<ElasticPhysics> elastic{};
};

/// What moves rigid objects that nothing touches. spec/40-rigid.md section 4
struct MotionPhysics {
  Vec3 gravity{};       ///< [m/s^2] world frame; 0: not declared
  double friction = 0;  ///< an object that slides is slowed down by this times |gravity|; 0: not declared
};

/// What went wrong, and with which object.
struct SceneFinding {
  Error error;
  std::string object;    ///< empty: no particular object
  std::string detail{};  ///< figures of this particular case; empty: describe(error) says all
  operator Error() const noexcept { return error; }
};

/// Collects a scene's objects without checking them. build() checks and takes them, and leaves the builder empty. What is not set is coded
/// as the commands of Tactus do by themselves: profile main, rigid and deformable.
///   auto scene = SceneBuilder().rigid("cube", {{0, 0, 0.05}, {}}).baselines(8).build();
class SceneBuilder {
 public:
  explicit SceneBuilder(std::uint32_t tick_rate = 1000);
  SceneBuilder(const SceneBuilder&);
  SceneBuilder(SceneBuilder&&) noexcept;
  SceneBuilder& operator=(const SceneBuilder&);
  SceneBuilder& operator=(SceneBuilder&&) noexcept;
  ~SceneBuilder();

  /// in   initial  pose at rest until the first update
  SceneBuilder& rigid(std::string name, const Pose& initial = {}, const RigidOptions& options = {});
  /// in   surface  V vertices [m] at rest, world frame
  SceneBuilder& deformable(std::string name, TriMesh surface, DeformableCoding coding = {});
  /// The grids as they are; those of GridExponents by themselves, whose positions reach +-512 m.
  SceneBuilder& grid(const GridExponents& exponents);
  /// How far from the origin positions get, along any axis [m]. build() takes the finest grid of positions that reaches so far, and none finer
  /// than grid() says; it refuses a world that is too large for the bounds of declare_bounds(), with both figures.
  SceneBuilder& world_size(double metres);
  /// An object without updates stops moving after so long [s].
  SceneBuilder& extrapolate(double seconds);
  /// How many states a receiver keeps as baselines, 1..64. Losing fewer packets than that in a row interrupts nothing.
  SceneBuilder& baselines(std::uint8_t count);
  SceneBuilder& rigid_profile(RigidProfile profile);
  /// Send the forces on all objects that can move: of their surroundings, and of so many users.
  SceneBuilder& loads(const LoadSpec& loads);
  /// Let updates choose among predictors that know these constants. Both 0: none does.
  SceneBuilder& motion(const MotionPhysics& physics);
  /// Whether these constants can be declared: the coupling over the mass up to 4.2e6 s^-2, radii of inertia of 31 um to 1 m.
  static bool can_drive(const DrivenPhysics& physics, std::uint32_t tick_rate) noexcept;
  /// Whether every client accepts a body with so many vertices on its surface: about 10 000 in all if it is thin, 1300 of a cube.
  static bool can_compute(const ElasticPhysics& physics, std::size_t vertices);
  /// Whether velocity Verlet is stable in the body's sub-steps, with steps of `step` [s] (R-ELA-5); true of the other methods.
  /// in   surface  [m] its vertices at rest.   pre  the body breaks no other rule
  static bool steps_stably(const ElasticPhysics& physics, std::span<const Vec3> surface, double step);
  /// Send to clients by distance [m]: rigid objects within `full` of where a client looks from in full, with bounds twice as wide at
  /// twice the distance, and not at all of those beyond `reach`. For worlds that are larger than what one sees of them.
  SceneBuilder& interest(double full, double reach);
  /// Declare the bounds that hold at a client that gets every packet.
  SceneBuilder& declare_bounds(const RigidTriggers& rigid, const DeformableThresholds& deformables,
                               const LoadThresholds& loads = {});

  /// err  invalid_argument R-API-1..4, R-API-10 a pose, surface, stiffness or world does not fit its grid; those of
  ///      Scene::create
  /// in   limits  those of the receivers, which must be given the same: larger than usual for a scene of more than 4096 objects, say
  tl::expected<SharedScene, SceneFinding> build(const DecodeLimits& limits = {});

 private:
  struct Rigid {
    std::string name;
    Pose initial;
    RigidOptions options;
  };
  struct Deformable {
    std::string name;
    TriMesh surface;
    DeformableCoding coding;
  };

  SceneSpec spec_;
  std::optional<double> extrapolation_;  // [s]
  std::optional<double> world_size_;     // [m]
  MotionPhysics motion_;
  std::optional<std::array<double, 2>> interest_;  // full and reach [m]
  RigidProfile rigid_profile_ = RigidProfile::main;
  std::vector<Rigid> rigid_;
  std::vector<Deformable> deformables_;
  struct MeshParts;
  static const MeshParts& mesh_parts() noexcept;
  const MeshParts* meshes_ = nullptr;  // what deformable() needs: a program that never calls it does not link that
  struct DeclaredBounds {
    RigidTriggers rigid;
    DeformableThresholds deformables;
    LoadThresholds loads;
  };
  std::optional<DeclaredBounds> declared_bounds_;
};

/// The scene of a device that moves in `scene`, one rigid object; its orientation is coded, too. spec/65-signal.md section 2
Result<SharedScene> device_scene(const SceneSpec& scene);

}  // namespace tactus
