// SPDX-License-Identifier: Apache-2.0
#include <tactus/receiver.h>

#include <algorithm>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/deformable/deformable_decoder.h>
#include <tactus/elastic/driven_shape.h>
#include <tactus/load/load_decoder.h>
#include <tactus/packet/substream.h>
#include <tactus/packet/substream_decoder.h>
#include <tactus/rigid/rigid_decoder.h>
#include <tactus/rigid/rigid_states.h>
#include <tactus/scene/mesh_support.h>

namespace tactus {

struct Receiver::Impl {
  Impl(SharedScene of, const ReceiverOptions& options, KnownDevice of_client)
      : scene(std::move(of)),
        device(std::move(of_client)),
        rigid(*scene, options.limits, initial_states(*scene), *scene),
        deformables(decoders(*scene, options.limits, device)),
        replica(*scene, options.replica, shapes(deformables), device.path.get(), thesis_for(*scene, options)) {
    if (scene->loads) loads.emplace(*scene, options.limits, initial_loads(*scene), *scene);
    std::size_t vertices = 0;
    for (const DeformableObject& object : scene->deformables) vertices = std::max(vertices, object.rest.size());
    metres.resize(3 * vertices);
  }

  using Decoders = std::vector<std::unique_ptr<DeformableDecoder>>;
  static Decoders decoders(const Scene& scene, const DecodeLimits& limits, const KnownDevice& device) {
    Decoders out;
    for (std::size_t i = 0; i < scene.deformables.size(); ++i)
      out.push_back(scene.mesh_support()->decoder(scene, i, limits, device.shape_of(scene, scene.deformables[i])));
    return out;
  }
  static const ThesisComponent* thesis_for(const Scene& scene, const ReceiverOptions& options) noexcept {
    return options.limits.thesis ? options.limits.thesis : scene.thesis();
  }
  static std::vector<DeformableDecoder*> shapes(const Decoders& decoders) {
    std::vector<DeformableDecoder*> out;
    for (const auto& decoder : decoders) out.push_back(decoder.get());
    return out;
  }

  Result<DecodedPacket> decode(std::uint64_t number, const SubstreamPacket& part) noexcept;

  SharedScene scene;
  KnownDevice device;
  SubstreamDecoder<RigidDecoder> rigid;
  Decoders deformables;
  std::optional<SubstreamDecoder<LoadDecoder>> loads;
  Replica replica;
  std::vector<float> metres;  // of the shape that was asked for last
};

Receiver::Receiver(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Receiver::Receiver(Receiver&&) noexcept = default;
Receiver& Receiver::operator=(Receiver&&) noexcept = default;
Receiver::~Receiver() = default;

Result<Receiver> Receiver::create(SharedScene scene, const ReceiverOptions& options) {
  return create_with(std::move(scene), options, {});
}

Result<Receiver> Receiver::create(SharedScene scene, const ReceiverOptions& options, std::shared_ptr<const DevicePath> device) {
  return create_with(std::move(scene), options, KnownDevice(std::move(device)));
}

Result<Receiver> Receiver::create_with(SharedScene scene, const ReceiverOptions& options, KnownDevice device) try {
  TACTUS_CHECK(check_scene(*scene, options.limits));
  TACTUS_CHECK(Replica::check(options.replica, *scene, Impl::thesis_for(*scene, options)));
  return Receiver(std::make_unique<Impl>(std::move(scene), options, std::move(device)));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<DecodedPacket> Receiver::Impl::decode(std::uint64_t number, const SubstreamPacket& part) noexcept {
  if (part.substream == 0) return rigid.decode(number, part.bytes);
  if (part.substream > deformables.size()) return loads->decode(number, part.bytes);
  return deformables[part.substream - 1]->decode(number, part.bytes);
}

Result<DecodedPacket> Receiver::push(std::uint64_t number, std::span<const std::uint8_t> packet,
                                     std::optional<std::int64_t> now) noexcept {
  if (!is_number(number)) return fail(Errc::invalid_argument, "R-API-5");
  TACTUS_TRY(const SubstreamPacket part, split_substream(*impl_->scene, packet));
  auto decoded = impl_->decode(number, part);
  if (!decoded) {
    const Error& error = decoded.error();
    return fail_at(error, error.bit_offset + 8 * (packet.size() - part.bytes.size()));
  }
  if (part.substream == 0) impl_->replica.apply(*decoded, impl_->rigid.after(*decoded), now.value_or(decoded->tick));
  return decoded;
}

void Receiver::skip_number(std::uint64_t number) noexcept { impl_->replica.skip_number(number); }

Pose Receiver::pose(std::uint32_t object, std::int64_t tick) const noexcept {
  return to_pose(impl_->replica.pose(object, tick), impl_->scene->grid.position);
}

std::span<const float> Receiver::displacements(std::size_t object, std::int64_t tick) noexcept {
  const auto shape = impl_->replica.displacements(object, tick);
  auto out = impl_->metres.begin();
  for (const auto& vertex : shape) {
    const Vec3 u = to_metres(vertex, impl_->scene->grid.position);
    for (const double component : {u.x, u.y, u.z}) *out++ = static_cast<float>(component);
  }
  return std::span(impl_->metres).first(3 * shape.size());
}

Replica& Receiver::replica() noexcept { return impl_->replica; }
const SharedScene& Receiver::scene() const noexcept { return impl_->scene; }
const RigidState& Receiver::object_after(const DecodedPacket& packet, std::uint32_t object) const noexcept {
  return impl_->rigid.after(packet).objects[object];
}
const RigidState& Receiver::object(std::uint32_t object) const noexcept { return impl_->rigid.newest().objects[object]; }

std::span<const std::array<std::int32_t, 3>> Receiver::decoded_displacements(std::size_t object) const noexcept {
  return impl_->deformables[object]->displacements();
}

bool Receiver::holds(std::uint64_t number, std::span<const std::uint8_t> packet) const noexcept {
  const auto part = split_substream(*impl_->scene, packet);
  if (!part) return false;
  if (part->substream == 0) return impl_->rigid.holds(number);
  if (part->substream > impl_->deformables.size()) return impl_->loads->holds(number);
  return impl_->deformables[part->substream - 1]->holds(number);
}

std::span<const GridForce> Receiver::load(std::uint32_t object, std::int64_t tick) const noexcept {
  const Scene& scene = *impl_->scene;
  const auto at = std::ranges::lower_bound(scene.moving(), object);
  if (!impl_->loads || at == scene.moving().end() || *at != object) return {};
  const std::size_t size = vectors_of_load(scene);
  return std::span(impl_->loads->at(tick).vectors).subspan(static_cast<std::size_t>(at - scene.moving().begin()) * size, size);
}

std::int64_t Receiver::tick(std::size_t substream) const noexcept {
  if (substream == 0) return impl_->rigid.newest().tick;
  if (substream > impl_->deformables.size()) return impl_->loads->newest().tick;
  return impl_->deformables[substream - 1]->tick();
}

std::uint64_t Receiver::state_hash(std::size_t substream) const noexcept {
  if (substream == 0) return tactus::state_hash(*impl_->scene, impl_->rigid.newest());
  if (substream > impl_->deformables.size()) return tactus::state_hash(impl_->loads->newest());
  return impl_->deformables[substream - 1]->state_hash();
}

}  // namespace tactus
