// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/encoder.h>

#include <utility>
#include <vector>

#include <tactus/base/out_of_memory.h>
#include <tactus/deformable/displacement.h>
#include <tactus/deformable/encoder_side.h>

namespace tactus {
namespace {

bool are_valid(const DeformableEncoderOptions& o) noexcept {
  const auto in = [](double v, double low, double high) { return v >= low && v <= high; };  // false for NaN
  const DeformableThresholds& t = o.thresholds;
  return in(t.visual, 0, 1e6) && in(t.weber_fraction.value_or(0), 0, 1e3) && in(t.depth_floor, 0, 1e6) &&
         in(o.key_interval, 0, 86400) && in(o.visual_share, 1e-3, 1) && in(o.haptic_share, 1e-3, 1);
}

}  // namespace

struct DeformableEncoder::Impl {
  Impl(StreamHeader stream, std::size_t index, const DeformableEncoderOptions& options)
      : header(std::move(stream)),
        mesh(header.meshes[index]),
        truth(mesh.rest.size()),
        side(mesh.profile == DeformableProfile::main ? make_main_side(header, mesh, options)
                                                     : make_thesis_side(header, mesh, options)) {}

  StreamHeader header;
  const DeformableObject& mesh;
  std::vector<Vec3i> truth;  // this frame, on the grid
  std::optional<SurfaceTouch> last_touch;
  bool rest_is_due = false;  // encode() has seen a frame
  std::unique_ptr<DeformableEncoderSide> side;
  std::int64_t last_tick = -1;

  Result<void> check_touch(const SurfaceTouch& touch) const noexcept {
    if (!std::isfinite(touch.force) || !std::isfinite(touch.stiffness)) return fail(Errc::invalid_argument, "R-API-1");
    if (touch.triangle >= mesh.triangles.size() || touch.force < 0 || !(touch.stiffness > 0))
      return fail(Errc::invalid_argument, "R-API-5");
    return {};
  }
};

DeformableEncoder::DeformableEncoder(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
DeformableEncoder::DeformableEncoder(DeformableEncoder&&) noexcept = default;
DeformableEncoder& DeformableEncoder::operator=(DeformableEncoder&&) noexcept = default;
DeformableEncoder::~DeformableEncoder() = default;

Result<DeformableEncoder> DeformableEncoder::create(StreamHeader header, std::size_t mesh,
                                                    const DeformableEncoderOptions& options) try {
  TACTUS_CHECK(check_header(header));
  if (!are_valid(options)) return fail(Errc::invalid_argument, "R-API-4");
  if (mesh >= header.meshes.size()) return fail(Errc::invalid_argument, "R-API-5");
  return DeformableEncoder(std::make_unique<Impl>(std::move(header), mesh, options));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<EncodedDeformablePacket> DeformableEncoder::encode(std::int64_t tick, std::span<const Vec3> displacement,
                                                          const std::optional<SurfaceTouch>& touch) noexcept {
  Impl& e = *impl_;
  if (tick <= e.last_tick || tick >= 0xffffffff) return fail(Errc::invalid_argument, "R-API-5");
  e.rest_is_due = false;
  if (touch) TACTUS_CHECK(e.check_touch(*touch));
  TACTUS_CHECK(to_grid(displacement, e.header.grid.position, e.truth));
  e.last_tick = tick;
  e.last_touch = touch;
  e.rest_is_due = true;
  return e.side->encode({tick, e.truth, e.last_touch}, e.side->is_split() ? Layer::haptic : Layer::all);
}

EncodedDeformablePacket DeformableEncoder::encode_rest() noexcept {
  Impl& e = *impl_;
  if (!std::exchange(e.rest_is_due, false) || !e.side->is_split()) return {};
  return e.side->encode({e.last_tick, e.truth, e.last_touch}, Layer::visual);
}

void DeformableEncoder::forget_last() noexcept { impl_->side->forget_last(); }
void DeformableEncoder::request_key() noexcept { impl_->side->request_key(); }

const StreamHeader& DeformableEncoder::header() const noexcept { return impl_->header; }
std::uint64_t DeformableEncoder::state_hash() const noexcept { return tactus::state_hash(impl_->mesh, impl_->side->held()); }

}  // namespace tactus
