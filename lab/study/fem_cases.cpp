// SPDX-License-Identifier: Apache-2.0
#include "lab/study/fem_cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/sim/random.h>

namespace tactus::sim::study {
namespace {

constexpr double kCell = 0.01;       // [m]
constexpr double kMassDamping = 20;  // [1/s]
constexpr double kGrown = 10;        // times the energy at the start
constexpr double kRounding = 1e-20;  // of Young's modulus times volume: energy below this is rounding
constexpr int kModes = 12;
constexpr Material kSoft{.young = 1e4, .poisson = 0.45, .density = 10'000};  // of the thesis's membrane

struct Cells {
  std::uint32_t x, y;
};
Cells cells(Extent extent) { return extent == Extent::full ? Cells{4, 5} : Cells{2, 2}; }

std::vector<std::uint32_t> corners(Cells n) {
  const std::uint32_t row = n.x + 1, layer = row * (n.y + 1);
  return {0, n.x, layer - row, layer - 1, layer, layer + n.x, 2 * layer - row, 2 * layer - 1};
}

FemCase slab(std::string name, Extent extent, const Material& material) {
  const Cells n = cells(extent);
  FemCase out{.name = std::move(name), .mesh = make_slab(n.x, n.y, 1, kCell), .options = {}, .start = {}};
  out.options.materials = {material};
  out.options.fixed = corners(n);
  out.options.mass_damping = kMassDamping;
  const auto size = static_cast<Eigen::Index>(3 * out.mesh.vertices.size());
  out.start = {Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
  if (extent == Extent::brief) out.steps /= 5;
  return out;
}

/// Put every vertex where `position` wants it; the model keeps the fixed ones.
template <class Position>
void move(FemCase& fem_case, Position&& position) {
  for (std::size_t i = 0; i < fem_case.mesh.vertices.size(); ++i) {
    const Vec3& rest = fem_case.mesh.vertices[i];
    const Vec3 moved = position(rest) - rest;
    fem_case.start.u.segment<3>(static_cast<Eigen::Index>(3 * i)) << moved.x, moved.y, moved.z;
  }
}

void shake(FemCase& fem_case, double amplitude) {
  Random random(5);
  move(fem_case, [&](const Vec3& x) {
    const auto any = [&] { return random.uniform(-amplitude, amplitude); };
    return x + Vec3{any(), any(), any()};
  });
}

/// A second object, not touching the first.
TetMesh two_parts(Cells n) {
  TetMesh out = make_slab(n.x, n.y, 1, kCell);
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  const TetMesh other = make_slab(1, 1, 1, kCell);
  for (const Vec3& x : other.vertices) out.vertices.push_back(x + Vec3{0, 0, 5 * kCell});
  for (Tet tet : other.tets) {
    for (std::uint32_t& corner : tet) corner += first;
    out.tets.push_back(tet);
  }
  return out;
}

/// A regular tetrahedron and, on its base, one so flat that its dihedral angle is 0.1 degrees.
FemCase sliver() {
  const double a = kCell, inradius = a / std::sqrt(12.0), flat = inradius * std::tan(0.1 * std::numbers::pi / 180);
  FemCase out{.name = "sliver, dihedral 0.1 deg", .mesh = {}, .options = {}, .start = {}};
  const double h = a * std::sqrt(3.0) / 2;
  const Vec3 middle{a / 2, inradius, 0};
  out.mesh.vertices = {
      {0, 0, 0}, {a, 0, 0}, {a / 2, h, 0}, middle + Vec3{0, 0, a * std::sqrt(2.0 / 3)}, middle - Vec3{0, 0, flat}};
  out.mesh.tets = {{0, 1, 2, 3}, {0, 2, 1, 4}};
  out.options.materials = {kSoft};
  out.options.fixed = {0, 1, 2};
  out.options.mass_damping = kMassDamping;
  out.start = {Eigen::VectorXd::Zero(15), Eigen::VectorXd::Zero(15)};
  shake(out, 1e-4);
  return out;
}

void add_materials(std::vector<FemCase>& out, Extent extent) {
  const auto add = [&](const std::string& name, const Material& material, double step) {
    FemCase one = shaken_slab(extent, material, 1e-3);
    one.name = name;
    one.options.mass_damping = kMassDamping;
    one.step = step;
    out.push_back(std::move(one));
  };
  for (const auto& [name, young] :
       {std::pair{"E 100 Pa", 1e2}, {"E 10 kPa", 1e4}, {"E 1 MPa", 1e6}, {"E 100 MPa", 1e8}, {"E 10 GPa", 1e10}})
    add(name, {young, kSoft.poisson, kSoft.density}, 1e-3);
  for (const auto& [name, nu] :
       {std::pair{"nu 0", 0.0}, {"nu 0.3", 0.3}, {"nu 0.49", 0.49}, {"nu 0.499", 0.499}, {"nu 0.4999", 0.4999}, {"nu 0.5", 0.5}})
    add(name, {kSoft.young, nu, kSoft.density}, 1e-3);
  for (const auto& [name, step] :
       {std::pair{"h 1 us", 1e-6}, {"h 10 us", 1e-5}, {"h 0.1 ms", 1e-4}, {"h 10 ms", 1e-2}, {"h 0.1 s", 0.1}})
    add(name, kSoft, step);
  FemCase uneven = shaken_slab(extent, kSoft, 1e-3);
  uneven.name = "density 100 and 1e6";
  uneven.options.mass_damping = kMassDamping;
  uneven.options.materials.clear();
  for (std::size_t i = 0; i < uneven.mesh.tets.size(); ++i)
    uneven.options.materials.push_back({kSoft.young, kSoft.poisson, i < uneven.mesh.tets.size() / 2 ? 1e2 : 1e6});
  out.push_back(std::move(uneven));
  out.push_back(sliver());
}

void add_starts(std::vector<FemCase>& out, Extent extent) {
  const auto add = [&](const char* name, auto position) {
    FemCase one = slab(name, extent, kSoft);
    move(one, position);
    out.push_back(std::move(one));
  };
  const Cells n = cells(extent);
  const Vec3 size{n.x * kCell, n.y * kCell, kCell};
  add("start upside down", [&](const Vec3& x) { return Vec3{x.x, x.y, size.z - x.z}; });
  add("start mirrored", [&](const Vec3& x) { return Vec3{size.x - x.x, x.y, x.z}; });
  add("start in a plane", [&](const Vec3& x) { return Vec3{x.x, x.y, size.z / 2}; });
  add("start on a line", [&](const Vec3& x) { return Vec3{x.x, size.y / 2, size.z / 2}; });
  add("start in a point", [&](const Vec3&) { return 0.5 * size; });
  Random random(7);
  add("start at random", [&](const Vec3&) {
    return Vec3{random.uniform(0, size.x), random.uniform(0, size.y), random.uniform(0, size.z)};
  });
  // Twisted about the long axis, from nothing at one end to half a turn at the other.
  add("twisted by 180 deg", [&](const Vec3& x) {
    const double angle = std::numbers::pi * x.y / size.y, dx = x.x - size.x / 2, dz = x.z - size.z / 2;
    return Vec3{size.x / 2 + dx * std::cos(angle) - dz * std::sin(angle), x.y,
                size.z / 2 + dx * std::sin(angle) + dz * std::cos(angle)};
  });
}

void add_motions(std::vector<FemCase>& out, Extent extent) {
  for (const auto& [name, speed] : {std::pair{"impulse 10 m/s", 10.0}, {"impulse 1000 m/s", 1000.0}}) {
    FemCase one = slab(name, extent, kSoft);
    for (Eigen::Index i = 2; i < one.start.v.size(); i += 3) one.start.v[i] = speed;
    out.push_back(std::move(one));
  }
  FemCase turned = slab("free, turned by 180 deg", extent, kSoft);
  turned.options.fixed.clear();
  move(turned, [](const Vec3& x) { return Vec3{-x.x, -x.y, x.z}; });
  out.push_back(std::move(turned));
  FemCase free = slab("nothing fixed", extent, kSoft);
  free.options.fixed.clear();
  shake(free, 1e-3);
  out.push_back(std::move(free));
  FemCase fixed = slab("everything fixed", extent, kSoft);
  for (std::uint32_t i = 0; i < fixed.mesh.vertices.size(); ++i) fixed.options.fixed.push_back(i);
  std::sort(fixed.options.fixed.begin(), fixed.options.fixed.end());
  fixed.options.fixed.erase(std::unique(fixed.options.fixed.begin(), fixed.options.fixed.end()), fixed.options.fixed.end());
  out.push_back(std::move(fixed));
  FemCase parts = slab("two parts, one of them free", extent, kSoft);
  parts.mesh = two_parts(cells(extent));
  parts.start.u.setZero(static_cast<Eigen::Index>(3 * parts.mesh.vertices.size()));
  parts.start.v = parts.start.u;
  shake(parts, 1e-3);
  out.push_back(std::move(parts));
  for (const auto& [name, young] : {std::pair{"free, 20 rad/s, E 1 MPa", 1e6}, {"free, 20 rad/s, E 100 MPa", 1e8}}) {
    FemCase spinning = slab(name, extent, {young, 0.3, 1000});
    spinning.options.fixed.clear();
    spinning.options.mass_damping = 0;
    const Vec3 middle{cells(extent).x * kCell / 2, cells(extent).y * kCell / 2, kCell / 2};
    for (std::size_t i = 0; i < spinning.mesh.vertices.size(); ++i) {
      const Vec3 speed = cross(Vec3{12, 0, 16}, spinning.mesh.vertices[i] - middle);
      spinning.start.v.segment<3>(static_cast<Eigen::Index>(3 * i)) << speed.x, speed.y, speed.z;
    }
    out.push_back(std::move(spinning));
  }
  // 1 Pa is 1 g / (mm s^2).
  FemCase small = slab("in mm and g", extent, {kSoft.young, kSoft.poisson, 1e-6 * kSoft.density});
  for (Vec3& x : small.mesh.vertices) x = 1000 * x;
  shake(small, 1);
  out.push_back(std::move(small));
}

double energy(FemModel& model, const FemState& state) {
  return model.energy(state.u) + 0.5 * state.v.cwiseAbs2().dot(model.lumped_mass());
}

double size_of(const TetMesh& mesh) {
  double out = 0;
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) out += volume(mesh, i);
  return out;
}

std::size_t inverted(const TetMesh& mesh, const Eigen::VectorXd& u) {
  TetMesh now = mesh;
  for (std::size_t i = 0; i < now.vertices.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    now.vertices[i] = now.vertices[i] + Vec3{u[at], u[at + 1], u[at + 2]};
  }
  std::size_t out = 0;
  for (std::size_t i = 0; i < now.tets.size(); ++i) out += volume(now, i) <= 0 ? 1u : 0u;
  return out;
}

std::string remark_of(const Diagnostic& error) {
  const std::string location = location_of(error);
  return std::string(error.error.rule) + (location.empty() ? "" : ", ") + location + ": " +
         (error.remedy.empty() ? remedy(error.error) : error.remedy);
}

FemOutcome refused(const Diagnostic& error) {
  FemOutcome out;
  out.verdict = Verdict::diverges;
  out.refused = true;
  out.error = remark_of(error);
  return out;
}

Eigen::VectorXd weight_of(const FemModel& model, double gravity) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(model.size());
  for (Eigen::Index z = 2; z < out.size(); z += 3) out[z] = -gravity * model.lumped_mass()[z];
  return out;
}

double largest(const Eigen::VectorXd& u) { return u.size() > 0 ? u.cwiseAbs().maxCoeff() : 0; }

}  // namespace

FemCase shaken_slab(Extent extent, const Material& material, double amplitude) {
  FemCase out = slab("slab", extent, material);
  out.options.mass_damping = 0;
  shake(out, amplitude);
  return out;
}

std::vector<FemCase> fem_cases(Extent extent) {
  std::vector<FemCase> out;
  add_materials(out, extent);
  add_starts(out, extent);
  add_motions(out, extent);
  return out;
}

FemOutcome run(const FemCase& fem_case, std::optional<Method> method) {
  auto model = FemModel::create(fem_case.mesh, fem_case.options);
  if (!model) return refused(model.error());
  IntegratorOptions options = method ? suited(*model, *method, fem_case.step) : choose(*model, fem_case.step).options;
  options.modes = std::min(kModes, static_cast<int>(model->free_dofs().size()));
  auto integrator = make_integrator(*model, options);
  if (!integrator) return refused(integrator.error());

  FemState state = model->rest();
  for (const int dof : model->free_dofs()) {
    state.u[dof] = fem_case.start.u[dof];
    state.v[dof] = fem_case.start.v[dof];
  }
  const Eigen::VectorXd weight = weight_of(*model, fem_case.gravity);
  const double least = kRounding * fem_case.options.materials[0].young * size_of(fem_case.mesh);
  const double before = std::max(least, energy(*model, state));
  FemOutcome out;
  out.taken = to_string(options);
  FemState kept = state, halfway = state;
  for (; out.steps < fem_case.steps; ++out.steps) {
    kept.u = state.u;
    kept.v = state.v;
    if (out.steps == fem_case.steps / 2) halfway.u = state.u;
    if (const auto step = (*integrator)->step(weight, state); !step) {
      out.verdict = Verdict::diverges;
      out.error = remark_of(step.error());
      out.kept_state = (state.u.array() == kept.u.array()).all() && (state.v.array() == kept.v.array()).all();
      return out;
    }
    out.not_finite += state.u.allFinite() && state.v.allFinite() ? 0u : 1u;
  }
  const double after = energy(*model, state);
  out.energy = after / before;
  out.inverted = inverted(fem_case.mesh, state.u);
  out.farthest = largest(state.u);
  out.drift = largest(state.u - halfway.u);
  out.verdict = !(after <= kGrown * before) ? Verdict::diverges : out.inverted > 0 ? Verdict::limit : Verdict::stable;
  return out;
}

double largest_explicit_step(FemCase fem_case) {
  fem_case.steps = 4000;
  const auto holds = [&](double step) {
    fem_case.step = step;
    return run(fem_case, Method::velocity_verlet).verdict != Verdict::diverges;
  };
  double high = 1e-6;
  while (holds(high)) high *= 2;
  return bisect(high / 2, high, 1e-3, holds);
}

}  // namespace tactus::sim::study
