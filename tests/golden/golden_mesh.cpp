// SPDX-License-Identifier: Apache-2.0
/// Both profiles of the codec of deformable objects on a seeded sheet; only operations that IEEE 754 defines exactly.
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/tactus.h>
#include <tactus/thesis/thesis.h>
#include "tests/golden/golden.h"

namespace tactus::golden {
namespace {

constexpr std::uint32_t kSide = 14;  // vertices

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * (1.0 / 4503599627370496.0) - 1; }

TriMesh sheet() {
  TriMesh mesh;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i)
    mesh.vertices.push_back({0.01 * (i % kSide), 0.01 * (i / kSide), 0.001 * (i % 3)});
  for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
    for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
      const std::uint32_t a = j * kSide + i;
      mesh.triangles.push_back({a, a + 1, a + kSide + 1});
      mesh.triangles.push_back({a, a + kSide + 1, a + kSide});
    }
  }
  return mesh;
}

/// Parabolic bumps of different widths, made so that they overlap.
std::vector<double> bumps(const TriMesh& mesh, std::size_t modes) {
  std::vector<double> out;
  for (std::size_t k = 0; k < modes; ++k) {
    const double cx = 0.02 + 0.03 * static_cast<double>(k % 4), cy = 0.03 + 0.04 * static_cast<double>(k / 4);
    for (const Vec3& x : mesh.vertices) {
      const double z = 1 / (1 + 2000 * ((x.x - cx) * (x.x - cx) + (x.y - cy) * (x.y - cy)));
      out.insert(out.end(), {0.2 * z, -0.1 * z, z});
    }
  }
  return out;
}

struct Setting {
  DeformableProfile profile = DeformableProfile::main;
  std::size_t modes = 0;
  double visual = 1e-3, noise = 1e-5;
  bool layered = false;
  std::uint8_t spring_modes = 0;
  std::uint16_t fade = 0;
  std::uint8_t weight_sets = 1;
  std::uint8_t clusters = 0;
};

/// The sheet's shape, pushed about.
class Motion {
 public:
  Motion(const TriMesh& mesh, double noise) : shapes_(bumps(mesh, kShapes)), noise_(noise), out_(3 * mesh.vertices.size()) {}

  /// Displacements of the next frame, exact in single precision: points of the grid below 2 m.
  std::span<const float> step() {
    for (std::size_t k = 0; k < kShapes; ++k) {
      if (random_() % 32 == 0) speed_[k] += 0.3 * uniform(random_);
      speed_[k] = 0.98 * speed_[k] - 2 * level_[k];
      level_[k] += speed_[k] / 60;
    }
    for (std::size_t v = 0; v < out_.size() / 3; ++v) {
      Vec3 u{noise_ * uniform(random_), noise_ * uniform(random_), noise_ * uniform(random_)};
      for (std::size_t k = 0; k < kShapes; ++k) {
        const double* s = shapes_.data() + k * out_.size() + 3 * v;
        u = u + level_[k] * Vec3{s[0], s[1], s[2]};
      }
      out_[3 * v] = rounded(u.x);
      out_[3 * v + 1] = rounded(u.y);
      out_[3 * v + 2] = rounded(u.z);
    }
    return out_;
  }
  SurfaceTouch touch(std::int64_t tick) {
    return SurfaceTouch{static_cast<std::uint32_t>(tick / 3 % 300), 1 + uniform(random_), 500};
  }

 private:
  static constexpr std::size_t kShapes = 8;

  static float rounded(double metres) {
    constexpr double kUnits = 1 << GridExponents{}.position;
    return static_cast<float>(std::floor(metres * kUnits + 0.5) / kUnits);
  }

  std::mt19937_64 random_{11};
  std::vector<double> shapes_;
  double noise_;
  std::array<double, kShapes> level_{}, speed_{};
  std::vector<float> out_;
};

SharedScene scene_of(const TriMesh& mesh, const Setting& setting) {
  SceneSpec spec;
  spec.tick_rate = 60;
  spec.baseline_span = 4;
  DeformableObject object = make_deformable_object("sheet", mesh, spec.grid.position).value();
  object.profile = setting.profile;
  object.layered = setting.layered;
  object.fade = setting.fade;
  object.weight_sets = setting.weight_sets;
  if (setting.modes > 0) object.basis = make_mode_basis(bumps(mesh, setting.modes), setting.modes).value();
  if (setting.spring_modes > 0) object.spring_basis = {setting.spring_modes, {0, 1, 2, 40}};
  if (setting.clusters > 0) {
    object.cluster_basis = {setting.clusters, 5, {}};
    for (std::size_t v = 0; v < object.rest.size(); ++v)
      object.cluster_basis.clusters.push_back(static_cast<std::uint8_t>(v * setting.clusters / object.rest.size()));
  }
  spec.deformables.push_back(std::move(object));
  return Scene::create(std::move(spec), {.thesis = &thesis_component}).value();
}

bool run(const char* name, const Setting& setting) {
  const TriMesh mesh = sheet();
  const SharedScene scene = scene_of(mesh, setting);
  SenderOptions options;
  options.deformable.thresholds = {.visual = setting.visual, .weber_fraction = 0.025};
  options.policy.key_interval = 1;
  auto sender = Sender::create(scene, options);
  auto receiver = Receiver::create(scene);
  const auto bytes = write_scene(*scene);
  if (!sender || !receiver || !bytes) return false;
  Fnv1a stream, states;
  for (const std::uint8_t b : *bytes) stream.add_byte(b);
  Motion motion(mesh, setting.noise);
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    DeformableTruth truth{motion.step(), {}};
    if (tick % 100 > 30) truth.touch = motion.touch(tick);
    const auto packets = sender->encode(tick, {.deformables = {&truth, 1}});
    if (!packets) return false;
    for (const Packet& packet : *packets) {
      for (const std::uint8_t b : packet.bytes) stream.add_byte(b);
      const auto decoded = receiver->push(packet.number, packet.bytes);
      if (!decoded) return false;
      stream.add32(decoded->final_range);
      stream.add32(decoded->final_code);
      states.add64(receiver->state_hash(1));
    }
    if (receiver->state_hash(1) != sender->state_hash(1)) return false;
  }
  std::printf("%s stream %016" PRIx64 "\n%s states %016" PRIx64 "\n", name, stream.value(), name, states.value());
  return true;
}

}  // namespace

bool run_meshes() {
  return run("mesh-thesis", {.profile = DeformableProfile::thesis}) && run("mesh-main", {}) &&
         run("mesh-noise", {.visual = 2e-4, .noise = 1e-3}) && run("mesh-basis", {.modes = 8}) &&
         run("mesh-exact", {.modes = 5, .visual = 0}) && run("mesh-split", {.modes = 8, .layered = true}) &&
         run("mesh-springs", {.spring_modes = 12}) &&
         run("mesh-springs-fade", {.spring_modes = 12, .fade = 4217, .weight_sets = 2}) &&
         run("mesh-springs-sets", {.spring_modes = 12, .fade = 4217, .weight_sets = 7}) &&
         run("mesh-springs-layers", {.layered = true, .spring_modes = 12, .fade = 4217, .weight_sets = 7}) &&
         run("mesh-clusters", {.fade = 7000, .clusters = 7});
}

}  // namespace tactus::golden
