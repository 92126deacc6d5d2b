// SPDX-License-Identifier: Apache-2.0
/// Both profiles of the mesh codec on a seeded sheet; only operations that IEEE 754 defines exactly.
#include <cinttypes>
#include <cstdio>
#include <random>
#include <vector>

#include <tactus/base/hash.h>
#include <tactus/tactus.h>
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
  bool split = false;
};

bool run(const char* name, const Setting& setting) {
  const auto& [profile, modes, visual, noise, split] = setting;
  const TriMesh mesh = sheet();
  StreamHeader header;
  header.tick_rate = 60;
  header.baseline_span = 4;
  DeformableObject object = make_deformable_object("sheet", mesh, header.grid.position).value();
  object.profile = profile;
  object.split = split;
  if (modes > 0 && profile == DeformableProfile::main) object.basis = make_mode_basis(bumps(mesh, modes), modes).value();
  header.meshes.push_back(object);
  DeformableEncoderOptions options;
  options.thresholds.visual = visual;
  options.key_interval = 1;
  auto encoder = DeformableEncoder::create(header, 0, options);
  auto decoder = DeformableDecoder::create(header, 0);
  const auto bytes = write_header(header);
  if (!encoder || !decoder || !bytes) return false;
  Fnv1a stream, states;
  for (const std::uint8_t b : *bytes) stream.add_byte(b);
  std::mt19937_64 random(11);
  const std::vector<double> shapes = bumps(mesh, 8);
  std::array<double, 8> level{}, speed{};
  std::vector<Vec3> displacement(mesh.vertices.size());
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    for (std::size_t k = 0; k < 8; ++k) {
      if (random() % 32 == 0) speed[k] += 0.3 * uniform(random);
      speed[k] = 0.98 * speed[k] - 2 * level[k];
      level[k] += speed[k] / 60;
    }
    for (std::size_t v = 0; v < displacement.size(); ++v) {
      Vec3 u{noise * uniform(random), noise * uniform(random), noise * uniform(random)};
      for (std::size_t k = 0; k < 8; ++k) {
        const double* s = shapes.data() + 3 * (k * displacement.size() + v);
        u = u + level[k] * Vec3{s[0], s[1], s[2]};
      }
      displacement[v] = u;
    }
    std::optional<SurfaceTouch> touch;
    if (tick % 100 > 30) touch = SurfaceTouch{static_cast<std::uint32_t>(tick / 3 % 300), 1 + uniform(random), 500};
    const auto first = encoder->encode(tick, displacement, touch);
    if (!first) return false;
    for (const EncodedDeformablePacket& packet : {*first, encoder->encode_rest()}) {
      if (packet.bytes.empty()) continue;
      for (const std::uint8_t b : packet.bytes) stream.add_byte(b);
      const auto decoded = decoder->decode(packet.bytes);
      if (!decoded) return false;
      stream.add32(decoded->final_range);
      stream.add32(decoded->final_code);
      states.add64(decoder->state_hash());
    }
    if (decoder->state_hash() != encoder->state_hash()) return false;
  }
  std::printf("%s stream %016" PRIx64 "\n%s states %016" PRIx64 "\n", name, stream.value(), name, states.value());
  return true;
}

}  // namespace

bool run_meshes() {
  return run("mesh-thesis", {.profile = DeformableProfile::thesis}) && run("mesh-main", {}) &&
         run("mesh-noise", {.visual = 2e-4, .noise = 1e-3}) && run("mesh-basis", {.modes = 8}) &&
         run("mesh-exact", {.modes = 5, .visual = 0}) && run("mesh-split", {.modes = 8, .split = true});
}

}  // namespace tactus::golden
