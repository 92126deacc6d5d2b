// SPDX-License-Identifier: Apache-2.0
#include "codec/mesh/mesh_state.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "codec/base/hash.h"
#include "codec/mesh/mesh_thesis.h"

namespace tactus {
namespace {

constexpr unsigned kShareBits = 4;
constexpr std::int64_t kMoveLimit = 1 << 20;  // of what one vertex adds to its anchors: sums over 2^20 vertices fit 64 bits

}  // namespace

MeshState initial_mesh_state(const MeshObject& mesh) {
  MeshState state;
  state.displacement.resize(mesh.rest.size());
  state.motion = MeshMotion(MeshPredictor::channels(mesh));
  if (mesh.profile == MeshProfile::thesis && mesh.models_kept) state.models = cold_thesis_models(mesh);
  return state;
}

std::uint64_t mesh_state_hash(const MeshObject& mesh, const MeshState& state) noexcept {
  Fnv1a hash;
  hash.add64(static_cast<std::uint64_t>(state.tick));
  for (const Vec3i& u : state.displacement)
    for (const std::int32_t c : u) hash.add32(c);
  if (mesh.profile == MeshProfile::main) {
    hash.add32(state.visual);
    hash.add32(state.triangle);
    hash.add32(state.haptic);
    state.motion.add_to(hash);
  }
  for (const BitModel& m : state.models) hash.add32(static_cast<std::uint32_t>(m.zero | m.rate << 16));
  return hash.value();
}

std::uint32_t mesh_steps(const MeshObject& mesh, std::int64_t ticks) noexcept {
  return static_cast<std::uint32_t>(std::min<std::int64_t>(round_div(ticks << 8, mesh.frame_period), 0xffffffff));
}

std::uint32_t haptic_bound(std::uint32_t level) noexcept {
  constexpr std::array<std::uint64_t, 6> kMantissa{32768, 36781, 41285, 46341, 52016, 58386};  // 2^(15 + k / 6), rounded
  if (level == 0) return 0;
  return static_cast<std::uint32_t>((kMantissa[(level - 1) % 6] << ((level - 1) / 6)) >> 15);
}

std::size_t MeshPredictor::channels(const MeshObject& mesh) noexcept {
  if (mesh.profile == MeshProfile::thesis) return 0;
  return mesh.basis.steps.empty() ? 3 * std::min<std::size_t>(mesh.anchors, mesh.rest.size()) : mesh.basis.steps.size();
}

MeshPredictor::MeshPredictor(const MeshObject& mesh, const MeshHierarchy& hierarchy)
    : mesh_(mesh), hierarchy_(hierarchy), increments_(channels(mesh)) {
  if (!mesh.basis.steps.empty()) {
    sum_.resize(3 * mesh.rest.size());
    return;
  }
  anchors_ = channels(mesh) / 3;
  field_.resize(mesh.rest.size());
  if (anchors_ == 0) return;
  std::vector<std::int64_t> mass(mesh.rest.size(), std::int64_t{1} << kShareBits);
  for (std::size_t i = mesh.rest.size(); i-- > anchors_;) {
    for (const MeshParent& p : hierarchy.parents[i]) mass[p.vertex] += round_shift(p.weight * mass[hierarchy.order[i]], 15);
  }
  for (std::size_t a = 0; a < anchors_; ++a) share_.push_back(mass[hierarchy.order[a]]);
}

/// Anchors move by their increments, every other vertex with its parents.
void MeshPredictor::spread_anchors(std::span<Vec3i> out) noexcept {
  for (std::size_t i = 0; i < hierarchy_.order.size(); ++i) {
    const std::uint32_t v = hierarchy_.order[i];
    auto& moved = field_[v];
    moved = {};
    if (i < anchors_) {
      for (std::size_t axis = 0; axis < 3; ++axis) moved[axis] = increments_[3 * i + axis];
    } else {
      for (const MeshParent& p : hierarchy_.parents[i])
        for (std::size_t axis = 0; axis < 3; ++axis) moved[axis] += p.weight * field_[p.vertex][axis];
      for (auto& c : moved) c = round_shift(c, 15);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) out[v][axis] = limited_displacement(out[v][axis] + moved[axis]);
  }
}

/// The transpose: every vertex hands what it moved on to its parents; an anchor's increment is the weighted mean.
void MeshPredictor::gather_anchors(std::span<const Vec3i> before, std::span<const Vec3i> after) noexcept {
  for (std::size_t v = 0; v < field_.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      field_[v][axis] = std::clamp(static_cast<std::int64_t>(after[v][axis]) - before[v][axis], -kMoveLimit, kMoveLimit)
                        << kShareBits;
  for (std::size_t i = hierarchy_.order.size(); i-- > anchors_;) {
    const auto& moved = field_[hierarchy_.order[i]];
    for (const MeshParent& p : hierarchy_.parents[i])
      for (std::size_t axis = 0; axis < 3; ++axis) field_[p.vertex][axis] += round_shift(p.weight * moved[axis], 15);
  }
  for (std::size_t a = 0; a < anchors_; ++a)
    for (std::size_t axis = 0; axis < 3; ++axis)
      increments_[3 * a + axis] = limited_displacement(round_div(field_[hierarchy_.order[a]][axis], share_[a]));
}

/// out += modes * coefficients, all coefficients brought to 14 bits by one shift.
void MeshPredictor::combine(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept {
  std::uint32_t largest = 0;
  for (const std::int32_t g : coefficients) largest = std::max(largest, static_cast<std::uint32_t>(std::abs(g)));
  if (largest == 0) return;
  const auto width = static_cast<unsigned>(std::bit_width(largest));
  const unsigned shift = width > 14 ? width - 14 : 0;
  std::fill(sum_.begin(), sum_.end(), 0);
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    const auto g = static_cast<std::int16_t>(round_shift(coefficients[k], shift));
    if (g == 0) continue;
    const std::int16_t* mode = mesh_.basis.entries.data() + k * sum_.size();
    for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i] += mode[i] * g;
  }
  for (std::size_t v = 0; v < out.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      out[v][axis] = limited_displacement(out[v][axis] + round_shift(static_cast<std::int64_t>(sum_[3 * v + axis]) << shift, 11));
}

void MeshPredictor::predict(const MeshState& state, std::uint32_t steps, std::span<Vec3i> out) noexcept {
  std::copy(state.displacement.begin(), state.displacement.end(), out.begin());
  if (state.motion.size() == 0) return;
  state.motion.predict(steps, increments_);
  const bool still = std::all_of(increments_.begin(), increments_.end(), [](std::int32_t c) { return c == 0; });
  if (still) return;
  if (anchors_ > 0) spread_anchors(out);
  else combine(increments_, out);
}

void MeshPredictor::add_modes(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept {
  combine(coefficients, out);
  for (std::size_t k = 0; k < coefficients.size(); ++k)
    increments_[k] = limited_displacement(static_cast<std::int64_t>(increments_[k]) + coefficients[k]);
}

void MeshPredictor::learn(std::span<const Vec3i> before, std::uint32_t steps, MeshState& state) noexcept {
  if (anchors_ > 0) gather_anchors(before, state.displacement);
  state.motion.learn(steps, increments_);
}

}  // namespace tactus
