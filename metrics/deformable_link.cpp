// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/deformable_link.h>

#include <algorithm>
#include <cmath>

#include <tactus/deformable/displacement.h>

namespace tactus {

namespace {

/// No triangle is so small that it has no area on the grid: a trace of what the client shows could not hold it.
bool keeps_its_areas(const DeformableObject& object, unsigned position_exp) {
  return std::ranges::all_of(object.triangles, [&](const Triangle& t) {
    const auto corner = [&](std::size_t k) { return to_metres(object.rest[t[k]], position_exp); };
    return norm(cross(corner(1) - corner(0), corner(2) - corner(0))) > 0;
  });
}

}  // namespace

Result<DeformableObject> deformable_object(const TraceDeformable& mesh, const DeformableCoding& coding, unsigned position_exp) {
  TACTUS_TRY(DeformableObject object, make_deformable_object(mesh.name, mesh.rest, position_exp));
  if (!keeps_its_areas(object, position_exp)) return fail(Errc::invalid_argument, "R-API-10");
  object.profile = coding.profile;
  object.rings = coding.rings;
  object.quant_bits = coding.quant_bits;
  object.models_kept = coding.models_kept;
  object.split = coding.profile == DeformableProfile::main && coding.split;
  object.frame_period =
      static_cast<std::uint32_t>(std::clamp(std::floor(256 * mesh.period + 0.5), 1.0, double{DeformableObject::kMaxFramePeriod}));
  if (coding.profile == DeformableProfile::main && coding.basis) {
    TACTUS_TRY(object.basis, coding.basis(mesh));
  }
  return object;
}

std::optional<SurfaceTouch> touch_of(const TraceFrame& frame, std::size_t mesh) noexcept {
  std::optional<SurfaceTouch> lightest;
  for (const UserSample& user : frame.users) {
    if (!user.surface_contact || user.surface_contact->mesh != mesh) continue;
    const SurfaceContact& contact = *user.surface_contact;
    const double depth = norm(contact.proxy - user.contact.device);
    if (lightest && lightest->force / lightest->stiffness <= depth) continue;
    lightest = SurfaceTouch{contact.triangle, contact.stiffness * depth, contact.stiffness};
  }
  return lightest;
}

Result<DeformableLink> DeformableLink::create(const StreamHeader& header, std::size_t mesh,
                                              const DeformableEncoderOptions& options) {
  TACTUS_TRY(DeformableEncoder encoder, DeformableEncoder::create(header, mesh, options));
  TACTUS_TRY(DeformableDecoder decoder, DeformableDecoder::create(header, mesh));
  return DeformableLink(std::move(encoder), std::move(decoder), header.meshes[mesh].rest.size(), header.grid.position);
}

Result<DeformablePackets> DeformableLink::encode(std::int64_t tick, std::span<const float> displacements,
                                                 const std::optional<SurfaceTouch>& touch) noexcept {
  if (displacements.size() != 3 * vectors_.size()) return fail(Errc::invalid_argument, "R-API-5");
  for (std::size_t v = 0; v < vectors_.size(); ++v)
    vectors_[v] = {displacements[3 * v], displacements[3 * v + 1], displacements[3 * v + 2]};
  TACTUS_TRY(const EncodedDeformablePacket first, encoder_.encode(tick, vectors_, touch));
  return DeformablePackets{first, encoder_.encode_rest()};
}

std::span<const Vec3> DeformableLink::shown(std::int64_t tick) noexcept {
  const auto displacements = decoder_.displacements_at(tick);
  for (std::size_t v = 0; v < vectors_.size(); ++v) vectors_[v] = to_metres(displacements[v], position_exp_);
  return vectors_;
}

void DeformableRates::add(std::size_t packet_bytes, std::uint64_t update_count, bool key, Layer half) {
  sizes.push_back(static_cast<std::uint32_t>(packet_bytes));
  bytes += packet_bytes;
  updates += update_count;
  keys += key ? 1 : 0;
  if (half == Layer::all) return;
  Half& of_half = halves[static_cast<std::size_t>(half)];
  ++of_half.packets;
  of_half.bytes += packet_bytes;
}

std::uint32_t DeformableRates::quantile(double share) const {
  if (sizes.empty()) return 0;
  std::vector<std::uint32_t> sorted = sizes;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

}  // namespace tactus
