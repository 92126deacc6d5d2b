// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/element.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tactus::sim {

bool supported(InstructionSet set) noexcept {
#ifdef TACTUS_FEM_X86
  if (set == InstructionSet::avx2) return __builtin_cpu_supports("avx2") != 0;
  if (set == InstructionSet::avx512) return __builtin_cpu_supports("avx512f") != 0;
#endif
  return set == InstructionSet::portable;
}

InstructionSet widest() noexcept {
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2})
    if (supported(set)) return set;
  return InstructionSet::portable;
}

ElementKernels kernels([[maybe_unused]] InstructionSet set) noexcept {
#ifdef TACTUS_FEM_X86
  if (set == InstructionSet::avx2) return avx2_kernels();
  if (set == InstructionSet::avx512) return avx512_kernels();
#endif
  return portable_kernels();
}

Elements::Elements(const TetMesh& mesh, std::span<const Lame> moduli, bool corotated)
    : blocks_((mesh.tets.size() + kBlockSize - 1) / kBlockSize),
      u_(mesh.vertices.size()),
      k_(mesh.vertices.size()),
      size_(mesh.tets.size()),
      corotated_(corotated) {
  for (ElementBlock& block : blocks_)
    for (double& w : block.rotation[0]) w = 1;
  for (std::size_t i = 0; i < size_; ++i) {
    const auto [at, lane] = slot_of(i);
    ElementBlock& block = blocks_[at];
    const auto& [a, b, c, d] = mesh.tets[i];
    const Vec3& origin = mesh.vertices[a];
    const Vec3 x = mesh.vertices[b] - origin, y = mesh.vertices[c] - origin, z = mesh.vertices[d] - origin;
    const double six_volumes = dot(cross(x, y), z);
    const Vec3 gradients[3] = {cross(y, z), cross(z, x), cross(x, y)};
    for (std::size_t r = 0; r < 3; ++r) {
      block.gradient[3 * r][lane] = gradients[r].x / six_volumes;
      block.gradient[3 * r + 1][lane] = gradients[r].y / six_volumes;
      block.gradient[3 * r + 2][lane] = gradients[r].z / six_volumes;
    }
    block.two_mu[lane] = six_volumes / 3 * moduli[i].mu;
    block.lambda[lane] = six_volumes / 6 * moduli[i].lambda;
    for (std::size_t r = 0; r < 4; ++r) block.corner[r][lane] = 4 * mesh.tets[i][r];
  }
}

void Elements::spread(const double* u) noexcept {
  for (std::size_t i = 0; i < u_.size(); ++i) std::memcpy(u_[i].xyz, u + 3 * i, sizeof u_[i].xyz);
}

void Elements::forces(const double* u, double* k) noexcept {
  spread(u);
  std::fill(k_.begin(), k_.end(), VertexVector{});
  (corotated_ ? kernels_.forces : kernels_.linear_forces)({blocks_.data(), blocks_.size()}, u_.data()->xyz, k_.data()->xyz);
  for (std::size_t i = 0; i < k_.size(); ++i) std::memcpy(k + 3 * i, k_[i].xyz, sizeof k_[i].xyz);
}

double Elements::energy(const double* u) noexcept {
  spread(u);
  return (corotated_ ? kernels_.energy : kernels_.linear_energy)({blocks_.data(), blocks_.size()}, u_.data()->xyz);
}

void Elements::turn(const double* u) noexcept {
  if (!corotated_) return;
  spread(u);
  kernels_.turn({blocks_.data(), blocks_.size()}, u_.data()->xyz);
}

Quat Elements::rotation(std::size_t element) const noexcept {
  const auto [block, lane] = slot_of(element);
  const auto& q = blocks_[block].rotation;
  const Quat out{q[0][lane], q[1][lane], q[2][lane], q[3][lane]};
  const double scale = 1 / std::sqrt(out.w * out.w + out.x * out.x + out.y * out.y + out.z * out.z);
  return {scale * out.w, scale * out.x, scale * out.y, scale * out.z};
}

std::array<Vec3, 4> Elements::gradients(std::size_t element) const noexcept {
  const auto [block, lane] = slot_of(element);
  const auto& g = blocks_[block].gradient;
  const Vec3 x{g[0][lane], g[1][lane], g[2][lane]}, y{g[3][lane], g[4][lane], g[5][lane]}, z{g[6][lane], g[7][lane], g[8][lane]};
  return {-(x + y + z), x, y, z};
}

Lame Elements::moduli(std::size_t element) const noexcept {
  const auto [block, lane] = slot_of(element);
  return {0.5 * blocks_[block].two_mu[lane], blocks_[block].lambda[lane]};
}

Matrix3 Elements::deformation(std::size_t element, const double* u) const noexcept {
  const std::array<Vec3, 4> g = gradients(element);
  const std::array<std::uint32_t, 4> corner = corners(element);
  Matrix3 f;
  for (std::size_t c = 0; c < 3; ++c) {
    Vec3 row;
    for (std::size_t r = 1; r < 4; ++r) row = row + (u[corner[r] + c] - u[corner[0] + c]) * g[r];
    f.m[c][0] = row.x, f.m[c][1] = row.y, f.m[c][2] = row.z;
    f.m[c][c] += 1;
  }
  return f;
}

std::array<std::uint32_t, 4> Elements::corners(std::size_t element) const noexcept {
  const auto [block, lane] = slot_of(element);
  const auto& corner = blocks_[block].corner;
  return {corner[0][lane] / 4 * 3, corner[1][lane] / 4 * 3, corner[2][lane] / 4 * 3, corner[3][lane] / 4 * 3};
}

}  // namespace tactus::sim
