// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_builder.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unordered_set>
#include <utility>

#include <tactus/base/quantise.h>
#include <tactus/base/rule.h>
#include <tactus/mesh/elastic_elements.h>
#include <tactus/scene/mesh_support.h>
#include <tactus/scene/scene_rules.h>

namespace tactus {
namespace {

constexpr double kExtrapolation = 2;   // [s]
constexpr double kFade = 0.98;         // per second
constexpr double kNearlyExact = 1e-5;  // [m] visual bound at which nearly every vertex is coded in every packet

bool has_basis(const DeformableCoding& coding) noexcept {
  return !coding.basis.steps.empty() || coding.spring_basis.modes > 0 || coding.cluster_basis.count > 0;
}

/// What was left open. Where nearly every vertex is coded in every packet, what fades is sent again, and vertices follow their parents
/// closely.
void choose(DeformableCoding& coding, bool is_nearly_exact) noexcept {
  if (!coding.fade) coding.fade = is_nearly_exact ? 0 : kFade;
  if (coding.weight_sets == 0) coding.weight_sets = has_basis(coding) && !is_nearly_exact ? 2 : 1;
}

/// The fraction that fades per frame, from that per second.
std::uint16_t fade_of(const DeformableCoding& coding, std::uint32_t tick_rate) noexcept {
  if (!has_basis(coding)) return 0;
  const double left = std::pow(1 - *coding.fade, coding.frame_period / tick_rate);
  return static_cast<std::uint16_t>(std::min(65535.0, std::floor(65536 * (1 - left) + 0.5)));
}

/// pre  nothing is left open
Result<void> apply(DeformableCoding& coding, std::uint32_t tick_rate, DeformableObject& object) {
  object.profile = coding.profile;
  object.rings = coding.rings;
  object.quant_bits = coding.quant_bits;
  object.models_kept = coding.models_kept;
  object.layered = coding.layered;
  object.frame_period = static_cast<std::uint32_t>(
      std::clamp(std::floor(256 * coding.frame_period + 0.5), 1.0, double{DeformableObject::kMaxFramePeriod}));
  if (coding.profile == DeformableProfile::main) {
    if (!(*coding.fade >= 0 && *coding.fade <= 1)) return fail(Errc::invalid_argument, "R-API-4");
    object.fade = fade_of(coding, tick_rate);
    object.weight_sets = coding.weight_sets;
    object.basis = std::move(coding.basis);
    object.spring_basis = std::move(coding.spring_basis);
    object.cluster_basis = std::move(coding.cluster_basis);
  }
  for (const double stiffness : coding.stiffness) {
    TACTUS_TRY(const std::uint8_t level, stiffness_level(stiffness));
    object.stiffness.push_back(level);
  }
  return {};
}

/// err  invalid_argument R-API-4 a constant is not finite, negative, or beyond the grid
Result<std::optional<MotionConstants>> constants_of(const MotionPhysics& physics, const GridExponents& grid) {
  const double unit = std::ldexp(1.0, -grid.velocity), most = unit * MotionConstants::kMost;
  const double deceleration = physics.friction * norm(physics.gravity);
  const bool fits = std::isfinite(deceleration) && physics.friction >= 0 && deceleration <= most &&
                    std::max({std::abs(physics.gravity.x), std::abs(physics.gravity.y), std::abs(physics.gravity.z)}) <= most;
  if (!fits) return fail(Errc::invalid_argument, "R-API-4");
  const auto units = [unit](double v) { return static_cast<std::int32_t>(std::floor(v / unit + 0.5)); };
  const MotionConstants out{{units(physics.gravity.x), units(physics.gravity.y), units(physics.gravity.z)}, units(deceleration)};
  if (out == MotionConstants{}) return std::nullopt;
  return out;
}

/// err  invalid_argument R-API-4 a distance is not positive or beyond the grid, or `reach` is below `full`
Result<std::optional<Interest>> interest_of(const std::optional<std::array<double, 2>>& distances, unsigned position_exp) {
  if (!distances) return std::nullopt;
  const auto [full, reach] = *distances;
  const double unit = std::ldexp(1.0, -static_cast<int>(position_exp));
  if (!(full >= unit && full <= reach && reach <= unit * Interest::kMost)) return fail(Errc::invalid_argument, "R-API-4");
  return Interest{static_cast<std::uint32_t>(full / unit), static_cast<std::uint32_t>(reach / unit)};
}

/// Nothing: a constant cannot be declared.
std::optional<DrivenConstants::Body> body_of(const DrivenPhysics& physics, std::uint32_t tick_rate) noexcept {
  constexpr double kMost = DrivenConstants::Body::kMost, kMost16 = 65535;
  bool fits = true;
  const auto units = [&fits](double value, double least, double most) {
    const double rounded = std::floor(value + 0.5);
    const bool is_in = rounded >= least && rounded <= most;
    fits = fits && is_in;
    return is_in ? static_cast<std::uint32_t>(rounded) : 0u;
  };
  DrivenConstants::Body out{.coupling = units(std::ldexp(physics.stiffness / physics.mass, 8), 1, kMost),
                            .hold = units(std::ldexp(physics.hold / physics.mass, 8), 0, kMost)};
  const std::array inertia{physics.inertia.x, physics.inertia.y, physics.inertia.z};
  for (std::size_t i = 0; i < 3; ++i) out.inertia[i] = units(std::ldexp(inertia[i] / physics.mass, 30), 1, kMost);
  out.friction = static_cast<std::uint16_t>(units(std::ldexp(physics.friction, 8), 0, kMost16));
  out.damping = static_cast<std::uint16_t>(units(std::ldexp(physics.damping / tick_rate, 20), 0, kMost16));
  return fits ? std::optional(out) : std::nullopt;
}

/// err  invalid_argument R-API-1, 2 an inner vertex
Result<ElasticBody> on_grid(ElasticPhysics physics, unsigned position_exp) {
  constexpr double kLimit = 2147483647.0;
  for (const Vec3& p : physics.inner) {
    if (!is_finite(p)) return fail(Errc::invalid_argument, "R-API-1");
    Vec3i& out = physics.body.inner.emplace_back();
    if (!quantise(p.x, position_exp, kLimit, out[0]) || !quantise(p.y, position_exp, kLimit, out[1]) ||
        !quantise(p.z, position_exp, kLimit, out[2]))
      return fail(Errc::invalid_argument, "R-API-2");
  }
  return std::move(physics.body);
}

/// Not those of people who type 4 for 4 %.
template <class Bounds>
bool are_fractions(const Bounds& bounds) noexcept {
  const auto fits = [](double p) { return p >= 0 && p <= 1; };  // false for NaN
  return fits(bounds.rigid.weber_fraction) && fits(bounds.rigid.perceptual_fraction) &&
         fits(bounds.deformables.weber_fraction.value_or(0)) && fits(bounds.loads.weber_fraction);
}

/// A number for people.
std::string figure(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// [m] how far from the origin positions get.
double reach_of(unsigned position_exp) noexcept { return std::ldexp(1.0, 31 - static_cast<int>(position_exp)); }

constexpr unsigned kCoarsestGrid = 8;  // R-STR-7
constexpr double kSteps = 8;           // of the grid in a bound: as of a sender's

/// The finest grid of positions that reaches so far; nothing: none does.
std::optional<GridExponents> grid_for(double metres, GridExponents grid) noexcept {
  if (!(metres > 0 && metres < reach_of(kCoarsestGrid))) return std::nullopt;
  while (metres >= reach_of(grid.position)) --grid.position;
  grid.velocity = std::min(grid.velocity, grid.position);
  return grid;
}

/// The finest bound of a distance [m] that is declared; 0: none.
double finest_bound(const RigidTriggers& rigid, const DeformableThresholds& mesh, bool has_rigid, bool has_meshes) noexcept {
  double out = has_rigid ? rigid.visual_position : 0;
  if (has_rigid && rigid.haptic == HapticRule::fixed) out = std::min(out, rigid.fixed_position);
  if (has_meshes && mesh.visual > 0) out = out > 0 ? std::min(out, mesh.visual) : mesh.visual;
  return out;
}

/// The grid is too coarse for the bound: why, and how large the world may be.
std::string too_large(double metres, double bound) {
  unsigned finest = 0;  // grid that the bound needs
  while (finest < 30 && std::ldexp(kSteps, -static_cast<int>(finest)) > bound) ++finest;
  return "a world of " + figure(metres) + " m and a bound of " + figure(1e3 * bound) +
         " mm do not go together: such a bound wants " + figure(kSteps) + " steps of the position grid, which then reaches " +
         figure(reach_of(finest)) + " m";
}

/// Why constants_of() refuses it.
std::string too_strong(const MotionPhysics& physics, const GridExponents& grid) {
  return "gravity of " + figure(norm(physics.gravity)) + " m/s^2, and friction that slows down by " +
         figure(physics.friction * norm(physics.gravity)) + " m/s^2: each is from 0 to " +
         figure(std::ldexp(MotionConstants::kMost, -grid.velocity)) + " m/s^2";
}

std::string beyond(unsigned position_exp) {
  return "positions of this scene reach " + figure(reach_of(position_exp)) + " m from the origin along each axis";
}

struct Counts {
  std::size_t objects, vertices = 0, triangles = 0;
};

Counts counts_of(const SceneSpec& spec) noexcept {
  Counts out{spec.objects.size() + spec.deformables.size()};
  for (const DeformableObject& object : spec.deformables)
    out.vertices += object.rest.size(), out.triangles += object.triangles.size();
  return out;
}

/// A scene is beyond the limits.
std::string too_many(const Counts& of, const DecodeLimits& limits) {
  std::string out;
  const auto part = [&out](std::size_t count, std::uint32_t most, const char* what) {
    if (count > most)
      out += (out.empty() ? "" : ", ") + std::to_string(count) + what + " where " + std::to_string(most) + " are allowed";
  };
  part(of.objects, limits.objects, " objects");
  part(of.vertices, limits.vertices, " vertices");
  part(of.triangles, limits.triangles, " triangles");
  return out;
}

}  // namespace

SceneBuilder::SceneBuilder(std::uint32_t tick_rate) { spec_.tick_rate = tick_rate; }
SceneBuilder::SceneBuilder(const SceneBuilder&) = default;
SceneBuilder::SceneBuilder(SceneBuilder&&) noexcept = default;
SceneBuilder& SceneBuilder::operator=(const SceneBuilder&) = default;
SceneBuilder& SceneBuilder::operator=(SceneBuilder&&) noexcept = default;
SceneBuilder::~SceneBuilder() = default;

SceneBuilder& SceneBuilder::rigid(std::string name, const Pose& initial, const RigidOptions& options) {
  rigid_.push_back({std::move(name), initial, options});
  return *this;
}

/// Parts of build() that deformable objects alone need.
struct SceneBuilder::MeshParts {
  const MeshSupport* support;
  Result<DeformableObject> (*make)(Deformable& of, const SceneSpec& spec, bool is_nearly_exact);
};

const SceneBuilder::MeshParts& SceneBuilder::mesh_parts() noexcept {
  static constexpr MeshParts parts{
      &linked_mesh_support, [](Deformable& of, const SceneSpec& spec, bool is_nearly_exact) -> Result<DeformableObject> {
        choose(of.coding, is_nearly_exact);
        TACTUS_TRY(DeformableObject object, make_deformable_object(of.name, of.surface, spec.grid.position));
        TACTUS_CHECK(apply(of.coding, spec.tick_rate, object));
        if (of.coding.elastic) {
          TACTUS_TRY(object.body, on_grid(std::move(*of.coding.elastic), spec.grid.position));
        }
        return object;
      }};
  return parts;
}

SceneBuilder& SceneBuilder::deformable(std::string name, TriMesh surface, DeformableCoding coding) {
  meshes_ = &mesh_parts();
  deformables_.push_back({std::move(name), std::move(surface), std::move(coding)});
  return *this;
}

SceneBuilder& SceneBuilder::grid(const GridExponents& exponents) {
  spec_.grid = exponents;
  return *this;
}

SceneBuilder& SceneBuilder::world_size(double metres) {
  world_size_ = metres;
  return *this;
}

SceneBuilder& SceneBuilder::extrapolate(double seconds) {
  extrapolation_ = seconds;
  return *this;
}

SceneBuilder& SceneBuilder::baselines(std::uint8_t count) {
  spec_.baseline_span = count;
  return *this;
}

SceneBuilder& SceneBuilder::rigid_profile(RigidProfile profile) {
  rigid_profile_ = profile;
  return *this;
}

SceneBuilder& SceneBuilder::loads(const LoadSpec& loads) {
  spec_.loads = loads;
  return *this;
}

SceneBuilder& SceneBuilder::motion(const MotionPhysics& physics) {
  motion_ = physics;
  return *this;
}

SceneBuilder& SceneBuilder::interest(double full, double reach) {
  interest_ = {full, reach};
  return *this;
}

bool SceneBuilder::can_drive(const DrivenPhysics& physics, std::uint32_t tick_rate) noexcept {
  return body_of(physics, tick_rate).has_value();
}

bool SceneBuilder::can_compute(const ElasticPhysics& physics, std::size_t vertices) {
  return elastic_work(physics.body, vertices + physics.inner.size()) <= DecodeLimits().elastic_work;
}

bool SceneBuilder::steps_stably(const ElasticPhysics& physics, std::span<const Vec3> surface, double step) {
  std::vector<Vec3> rest(surface.begin(), surface.end());
  rest.insert(rest.end(), physics.inner.begin(), physics.inner.end());
  return is_stable(physics.body, rest, step);
}

SceneBuilder& SceneBuilder::declare_bounds(const RigidTriggers& rigid, const DeformableThresholds& deformables,
                                           const LoadThresholds& loads) {
  declared_bounds_ = {rigid, deformables, loads};
  return *this;
}

tl::expected<SharedScene, SceneFinding> SceneBuilder::build(const DecodeLimits& limits) try {
  const auto refuse = [](const Error& error, std::string object, std::string detail = {}) {
    return tl::make_unexpected(SceneFinding{error, std::move(object), std::move(detail)});
  };
  SceneBuilder taken = std::exchange(*this, SceneBuilder(spec_.tick_rate));
  SceneSpec& spec = taken.spec_;
  const double ticks = std::floor(taken.extrapolation_.value_or(kExtrapolation) * spec.tick_rate + 0.5);
  if (!(ticks >= 0)) return refuse({Errc::invalid_argument, RuleName("R-API-4"), 0}, {});
  spec.max_extrapolation = static_cast<std::uint16_t>(std::clamp(ticks, 1.0, 65535.0));
  if (const RuleName rule = broken_parameter_rule(spec)) return refuse({Errc::invalid, rule, 0}, {});  // before the grid is used
  if (taken.world_size_) {
    const double metres = *taken.world_size_;
    const auto grid = grid_for(metres, spec.grid);
    if (!grid)
      return refuse({Errc::invalid_argument, RuleName("R-API-4"), 0}, {},
                    "a world of " + figure(metres) + " m: it is above 0 m and below " + figure(reach_of(kCoarsestGrid)) + " m");
    spec.grid = *grid;
    const bool moves = std::ranges::any_of(taken.rigid_, [](const Rigid& object) { return object.options.dof != Dof::none; });
    const double bound = taken.declared_bounds_ ? finest_bound(taken.declared_bounds_->rigid, taken.declared_bounds_->deformables,
                                                               moves, !taken.deformables_.empty())
                                                : 0;
    if (bound > 0 && bound < std::ldexp(kSteps, -static_cast<int>(spec.grid.position)))
      return refuse({Errc::invalid_argument, RuleName("R-API-4"), 0}, {}, too_large(metres, bound));
  }
  const auto constants = constants_of(taken.motion_, spec.grid);
  if (!constants) return refuse(constants.error(), {}, too_strong(taken.motion_, spec.grid));
  const auto interest = interest_of(taken.interest_, spec.grid.position);
  if (!interest) return refuse(interest.error(), {});
  std::unordered_set<std::string> names;
  for (Rigid& object : taken.rigid_) {
    const auto initial = to_grid(object.initial, spec.grid.position);
    if (!initial) {
      const bool is_far = initial.error().rule == std::string_view("R-API-2");
      return refuse(initial.error(), object.name, is_far ? beyond(spec.grid.position) : std::string());
    }
    spec.objects.push_back({std::move(object.name), object.options.dof, *initial});
    const RigidObject& made = spec.objects.back();
    if (const RuleName rule = broken_object_rule(made)) return refuse({Errc::invalid, rule, 0}, made.name);
    if (!names.insert(made.name).second) return refuse({Errc::invalid, RuleName("R-STR-11"), 0}, made.name);
    if (object.options.driven) {
      const auto body = body_of(*object.options.driven, spec.tick_rate);
      if (!body) return refuse({Errc::invalid_argument, RuleName("R-API-4"), 0}, made.name);
      if (!spec.driven) spec.driven.emplace();
      spec.driven->bodies.resize(spec.objects.size());
      spec.driven->bodies.back() = *body;
    }
    if (made.dof == Dof::none) continue;
    spec.motion = *constants;
    spec.interest = *interest;
    spec.is_smoothed = taken.rigid_profile_ == RigidProfile::main;
  }
  if (taken.declared_bounds_ && !are_fractions(*taken.declared_bounds_))
    return refuse({Errc::invalid_argument, RuleName("R-API-4"), 0}, {});
  if (spec.driven) spec.driven->bodies.resize(spec.objects.size());
  const bool is_nearly_exact = taken.declared_bounds_ && taken.declared_bounds_->deformables.visual <= kNearlyExact;
  for (Deformable& of : taken.deformables_) {
    auto object = taken.meshes_->make(of, spec, is_nearly_exact);
    if (!object) return refuse(object.error(), of.name);
    if (object->profile == DeformableProfile::thesis && limits.thesis == nullptr)
      return refuse({Errc::unsupported, RuleName("R-DEF-2"), 0}, of.name);
    if (!is_name(of.name) || !names.insert(of.name).second) return refuse({Errc::invalid, RuleName("R-STR-11"), 0}, of.name);
    if (const RuleName rule = taken.meshes_->support->broken_rule(*object)) return refuse({Errc::invalid, rule, 0}, of.name);
    spec.deformables.push_back(std::move(*object));
  }
  if (taken.declared_bounds_)
    spec.bounds =
        bounds_of(spec, taken.declared_bounds_->rigid, taken.declared_bounds_->deformables, taken.declared_bounds_->loads);
  const Counts counts = counts_of(spec);
  auto scene = Scene::create(std::move(spec), taken.meshes_ ? taken.meshes_->support : nullptr, limits);
  if (scene) return *scene;
  const bool is_too_large = scene.error().rule == std::string_view("R-STR-14");
  return refuse(scene.error(), {}, is_too_large ? too_many(counts, limits) : std::string());
} catch (const std::bad_alloc&) {
  return tl::make_unexpected(SceneFinding{out_of_memory().value(), {}});
}

Result<SharedScene> device_scene(const SceneSpec& scene) {
  constexpr double kReach = 0.1;  // [s]: a device that is not heard of stands still then
  auto built = SceneBuilder(scene.tick_rate)
                   .rigid("device")
                   .rigid_profile(RigidProfile::thesis)
                   .grid(scene.grid)
                   .extrapolate(kReach)
                   .baselines(64)
                   .build();
  if (!built) return tl::unexpected(built.error().error);
  return *built;
}

}  // namespace tactus
