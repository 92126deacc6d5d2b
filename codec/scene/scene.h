// SPDX-License-Identifier: Apache-2.0
/// The scene declaration: everything that both ends know before the first packet. spec/20-scene.md.
///
/// A SceneSpec is plain data that the caller fills in. A Scene is checked, immutable, and shared by sender, receiver, file and
/// threads. SceneBuilder makes one from SI units (scene_builder.h), parse_scene() from bytes (scene_syntax.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

/// Fixed-point grids: a value v [SI] is the integer round(v * 2^exp).
///   field             quantity                unit        default   step at the default
///   position          position                m           22        0.24 um, range +-512 m
///   velocity          linear velocity         m/s         17        7.6 um/s
///   rotation          quarter-angle vector    1           20        0.95e-6 (3.8e-6 rad); |v| = tan(angle / 4)
///   angular_velocity  angular velocity        rad/s       12        0.24 mrad/s
struct GridExponents {
  std::uint8_t position = 22;  ///< of positions up to 512 m from the origin: SceneBuilder::world_size() of larger worlds
  std::uint8_t velocity = 17;
  std::uint8_t rotation = 20;
  std::uint8_t angular_velocity = 12;
  friend bool operator==(const GridExponents&, const GridExponents&) = default;
};

/// What is sent of the forces on rigid objects. spec/45-load.md
struct LoadSpec {
  static constexpr std::uint8_t kMostUsers = 64, kMostExponent = 20;
  std::uint8_t force_exp = 10;  ///< forces are multiples of 2^-force_exp N, 0..20
  std::uint8_t users = 1;       ///< whose forces are sent, 0..64
  friend bool operator==(const LoadSpec&, const LoadSpec&) = default;
};

/// What predicts the motion of rigid objects beside their velocities. At least one constant is not 0. spec/40-rigid.md section 4
struct MotionConstants {
  static constexpr std::int32_t kMost = 1 << 28;
  std::array<std::int32_t, 3> gravity{};  ///< x 2^-velocity m/s^2, world frame; each within +-kMost
  std::int32_t slide_deceleration = 0;    ///< x 2^-velocity m/s^2, 0..kMost: of an object that slides to rest
  friend bool operator==(const MotionConstants&, const MotionConstants&) = default;
};

/// What predicts an object that the client's own device moves. spec/42-driven.md section 2
struct DrivenConstants {
  /// Of one rigid object. All 0: no device drives it.
  struct Body {
    static constexpr std::uint32_t kMost = 1u << 30;
    std::uint32_t coupling = 0;              ///< stiffness between device and proxy over the object's mass, x 2^-8 s^-2; 1..kMost
    std::uint32_t hold = 0;                  ///< the same while the device holds the object; 0: it never does; ..kMost
    std::array<std::uint32_t, 3> inertia{};  ///< moments about the axes of its frame over its mass, x 2^-30 m^2; 1..kMost
    std::uint16_t friction = 0;              ///< of the proxy on it, x 2^-8
    std::uint16_t damping = 0;               ///< fraction of its velocities that it loses per tick, x 2^-20
    friend bool operator==(const Body&, const Body&) = default;
  };
  std::vector<Body>
      bodies;  ///< one per rigid object; those of static objects are 0, that of a moving one is not for at least one
  friend bool operator==(const DrivenConstants&, const DrivenConstants&) = default;
};

/// Within which distances rigid objects are sent to a client. spec/44-interest.md section 2
struct Interest {
  static constexpr std::uint32_t kMost = 0x7fffffff;
  std::uint32_t full = 1;   ///< x 2^-position m: so far away in full; at twice the distance bounds are twice as wide
  std::uint32_t reach = 1;  ///< x 2^-position m, full..kMost: not at all beyond
  friend bool operator==(const Interest&, const Interest&) = default;
};

struct SceneSpec {
  std::uint32_t tick_rate = 1000;  ///< ticks per second, 1 .. 1 000 000
  GridExponents grid;
  std::uint16_t max_extrapolation = 2000;     ///< ticks; an object without updates stops moving after so long
  std::uint8_t baseline_span = 1;             ///< how many of the newest states a receiver keeps as baselines, 1..64
  bool is_smoothed = false;                   ///< updates of rigid objects signal how clients smooth their errors (rigid/curve.h)
  std::vector<RigidObject> objects;           ///< order is the wire order
  std::vector<DeformableObject> deformables;  ///< a stream without any spends no byte on them
  std::optional<LoadSpec> loads;              ///< of the objects that can move; none: a stream spends no byte on them
  std::optional<MotionConstants> motion;      ///< of the objects that can move; none: their velocities alone predict them
  std::optional<DrivenConstants> driven;      ///< of objects that a client's device moves; none: it predicts nothing
  std::optional<Interest> interest;           ///< of clients in rigid objects; none: they are sent all, in full
  std::optional<StreamBounds> bounds;         ///< error bounds that the sender guarantees; none: not declared
};

struct ThesisComponent;

/// Limits checked by a decoder before it allocates, and the optional part that it has. Memory grows with the bytes received of the declaration and with
/// state_bytes(), never with announced counts. A mesh of 2^20 vertices without a basis fits with a baseline_span of up to 19.
struct DecodeLimits {
  std::uint32_t objects = 4096;
  std::uint32_t header_bytes = 1u << 26;
  std::uint32_t packet_bytes = 1u << 26;
  std::uint32_t vertices = 1u << 20;        ///< of all deformable objects
  std::uint32_t triangles = 1u << 21;       ///< of all deformable objects
  std::uint64_t state_bytes = 1ull << 28;   ///< of all states that the stream's decoders keep
  std::uint64_t basis_work = 1ull << 22;    ///< of all bases to compute: 57 000 vertices with 48 modes, or 5 of 700
  std::uint64_t elastic_work = 1ull << 30;  ///< of all elastic bodies: thin ones of 10 000 vertices, or a cube of 1300
  const ThesisComponent* thesis = nullptr;  ///< thesis/thesis.h; without it what belongs to component thesis is unsupported
};

struct MeshSupport;
struct VertexHierarchy;

/// A checked scene, its spring bases computed. Never changes after it is made, so that threads may share it.
class Scene : public SceneSpec {
 public:
  /// time 1 us per vertex; 80 ms more for a basis of 48 modes of 700 vertices, 160 ms of 50 000
  /// err  invalid, limit_exceeded, with the R-STR or R-DEF rule that the declaration breaks; unsupported R-DEF-2
  static Result<std::shared_ptr<const Scene>> create(SceneSpec spec, const DecodeLimits& limits = {});

  /// Whether both ends of a session know the path of a device: it drives objects or deforms elastic bodies.
  bool has_paths() const noexcept { return has_paths_; }

  /// Place of a rigid object, or of a deformable one, among those of its kind; nothing: none has this name.   time O(objects)
  std::optional<std::uint32_t> find(std::string_view name) const noexcept;

  /// Rigid objects that can move, ascending: the only ones that packets name.
  std::span<const std::uint32_t> moving() const noexcept { return {moving_.data(), moving_.size()}; }

  /// Order and parents of the vertices of a deformable object of profile main, for all who code it.   pre  it is one of this scene
  const std::shared_ptr<const VertexHierarchy>& hierarchy(const DeformableObject& object) const noexcept {
    return hierarchies_[static_cast<std::size_t>(&object - deformables.data())];
  }

  /// What its deformable objects need; null: it has none. Internal to the library.
  const MeshSupport* mesh_support() const noexcept { return mesh_support_; }
  /// DecodeLimits::thesis that it was made with. Internal to the library.
  const ThesisComponent* thesis() const noexcept { return thesis_; }

  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

 private:
  friend class SceneBuilder;
  static Result<std::shared_ptr<const Scene>> create(SceneSpec&& spec, const MeshSupport* meshes, const DecodeLimits& limits);
  Scene(SceneSpec&& spec, const MeshSupport* meshes, const ThesisComponent* thesis);

  const MeshSupport* mesh_support_;
  const ThesisComponent* thesis_;
  std::vector<std::uint32_t> moving_;
  std::vector<std::shared_ptr<const VertexHierarchy>> hierarchies_;  // by deformable object; null: profile thesis
  bool has_paths_ = false;
};

using SharedScene = std::shared_ptr<const Scene>;

/// The rule that a declaration breaks, if any.   err  as Scene::create
Result<void> check_scene(const SceneSpec& spec, const DecodeLimits& limits = {});
Result<void> check_scene(const Scene& scene, const DecodeLimits& limits);  ///< the same, with what the scene has linked

/// Memory of the states that the decoders of all substreams keep [bytes]. spec/20-scene.md section 9
std::uint64_t state_bytes(const SceneSpec& spec) noexcept;

/// Work that computing the bases takes, in units of about 0.3 us. spec/50-deformable.md section 1.5
std::uint64_t basis_work(const SceneSpec& spec) noexcept;

/// Work that factoring the matrices of all elastic bodies takes, in units of about 0.5 ns. spec/55-elastic.md section 1.3
std::uint64_t elastic_work(const SceneSpec& spec);

/// Bounds of a stream whose sender uses these thresholds. Deformable objects of profile thesis only aim at theirs.
StreamBounds bounds_of(const SceneSpec& spec, const RigidTriggers& rigid, const DeformableThresholds& deformables,
                       const LoadThresholds& loads);

}  // namespace tactus
