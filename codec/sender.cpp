// SPDX-License-Identifier: Apache-2.0
#include <tactus/sender.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/deformable/deformable_encoder.h>
#include <tactus/elastic/driven_shape.h>
#include <tactus/load/load_encoder.h>
#include <tactus/rigid/rigid_encoder.h>
#include <tactus/rigid/rigid_states.h>

namespace tactus {

struct SharedTruth::Impl {
  Impl(const Scene& of, const RigidTriggers& triggers) : scene(of), held(of), rigid(of, triggers, held) {
    for (std::uint32_t i = 0; i < of.deformables.size(); ++i) shapes.emplace_back(of, i, held);
    if (of.loads) loads.emplace(of, held);
  }
  bool fits(const Truth& truth) const noexcept;
  Result<void> read(std::int64_t tick, const Truth& truth) noexcept;

  const Scene& scene;
  SharedScene owned;  // where it is shared
  HeldList held;
  RigidTruth rigid;
  std::vector<ShapeTruth> shapes;
  std::optional<LoadTruth> loads;
  std::optional<RigidWork> work;  // where it is shared
};

struct Sender::Impl {
  Impl(SharedScene of, const SenderOptions& options, std::shared_ptr<SharedTruth> of_others, KnownDevice of_receiver)
      : scene(std::move(of)),
        shared(std::move(of_others)),
        own(shared ? nullptr : std::make_unique<SharedTruth::Impl>(*scene, options.triggers)),
        device(std::move(of_receiver)),
        rigid(*scene, policy_of(0, options.policy), 0, max_rigid_packet(*scene), 1, initial_states(*scene), *scene,
              options.triggers, options.policy, truth().rigid, truth().work ? &*truth().work : nullptr, device.path.get()) {
    for (std::size_t i = 0; i < scene->deformables.size(); ++i)
      deformables.push_back(DeformableEncoder::create(*scene, i, options.deformable, policy_of(i + 1, options.policy),
                                                      device.shape_of(*scene, scene->deformables[i])));
    if (scene->loads) add_loads(options);
    frames.assign(deformables.size(), -1);
    packets.reserve(2 + 2 * deformables.size());
  }

  SharedTruth::Impl& truth() noexcept { return own ? *own : *shared->impl_; }
  /// What Baseline::repaired means for these objects.
  SenderPolicy policy_of(std::size_t substream, SenderPolicy policy) const noexcept {
    if (policy.baseline == Baseline::repaired)
      policy.baseline = may_chain(*scene, substream) ? Baseline::previous : Baseline::acknowledged;
    return policy;
  }
  void add_loads(const SenderOptions& options) {
    const std::size_t substream = load_substream(*scene);
    const SenderPolicy policy = policy_of(substream, options.policy);
    loads.emplace(*scene, policy, substream, max_load_packet(*scene), 1, initial_loads(*scene), *scene, options.load,
                  policy.baseline, *truth().loads);
  }
  Result<void> read(std::int64_t tick, const Truth& truth) noexcept;
  Result<std::span<const Packet>> encode(std::int64_t tick, const Truth& truth, std::optional<std::uint64_t> number) noexcept;
  bool has_shape(std::int64_t tick, std::size_t i) noexcept;
  void add(const Packet& packet) noexcept {
    if (packet.bytes.empty()) return;
    packets.push_back(packet);
    last_number = std::max(last_number, packet.number);
  }

  SharedScene scene;
  std::shared_ptr<SharedTruth> shared;
  std::unique_ptr<SharedTruth::Impl> own;  // where it is not shared
  KnownDevice device;
  SubstreamEncoder<RigidEncoder> rigid;
  std::vector<std::unique_ptr<DeformableEncoder>> deformables;
  std::optional<SubstreamEncoder<LoadEncoder>> loads;
  std::vector<std::int64_t> frames;  // by deformable object: tick of its newest shape, -1: none yet
  std::vector<Packet> packets;       // of this tick
  std::int64_t last_tick = -1;
  std::uint64_t last_number = 0;
};

/// As many of everything as the scene has.
bool SharedTruth::Impl::fits(const Truth& truth) const noexcept {
  const bool has_objects = !scene.moving().empty() || !truth.objects.empty() || !truth.contacts.empty();
  if (has_objects && truth.objects.size() != scene.objects.size()) return false;
  if (!truth.deformables.empty() && truth.deformables.size() != shapes.size()) return false;
  for (std::size_t i = 0; i < truth.deformables.size(); ++i)
    if (const auto& shape = truth.deformables[i].displacements; !shape.empty() && shape.size() != shapes[i].components())
      return false;
  return loads ? loads->fits(truth.loads) : truth.loads.empty();
}

/// All counts are looked at before anything changes; nothing else stops a tick.
Result<void> SharedTruth::Impl::read(std::int64_t tick, const Truth& truth) noexcept {
  if (!fits(truth)) return fail(Errc::invalid_argument, "R-API-5");
  held.begin();
  if (truth.objects.size() == scene.objects.size()) TACTUS_CHECK(rigid.read(tick, truth.objects, truth.contacts, truth.moved));
  for (std::size_t i = 0; i < shapes.size(); ++i)
    shapes[i].read(tick, truth.deformables.empty() ? nullptr : &truth.deformables[i]);
  if (loads) loads->read(tick, truth.loads);
  held.end();
  return {};
}

Result<void> Sender::Impl::read(std::int64_t tick, const Truth& truth) noexcept {
  if (tick <= last_tick || tick >= kTickLimit) return fail(Errc::invalid_argument, "R-API-5");
  if (shared && !scene->moving().empty() && shared->impl_->rigid.tick() != tick) return fail(Errc::invalid_argument, "R-API-5");
  if (own) TACTUS_CHECK(own->read(tick, truth));
  const auto& shapes = this->truth().shapes;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (shapes[i].is_new()) deformables[i]->read(shapes[i]);
  return {};
}

/// A shape that is new, or whose object rests while its receiver needs it once more.
bool Sender::Impl::has_shape(std::int64_t tick, std::size_t i) noexcept {
  const ShapeTruth& shape = truth().shapes[i];
  if (shape.is_new()) {
    frames[i] = tick;
    return true;
  }
  const DeformableObject& object = scene->deformables[i];
  const bool rests = frames[i] >= 0 && tick > frames[i] + (std::int64_t{object.frame_period} >> 7);  // two frames
  if (!rests || (object.body && device.path) || !deformables[i]->is_owed(tick)) return false;
  deformables[i]->read(shape);
  return true;
}

Result<std::span<const Packet>> Sender::Impl::encode(std::int64_t tick, const Truth& truth,
                                                     std::optional<std::uint64_t> number) noexcept {
  if (number && (*number <= last_number || !is_number(*number + 1))) return fail(Errc::invalid_argument, "R-API-5");
  TACTUS_CHECK(read(tick, truth));
  packets.clear();
  if (!scene->moving().empty()) {
    TACTUS_TRY(const Packet packet, rigid.encode(tick, Layer::all, number));
    add(packet);
  }
  for (std::size_t i = 0; i < deformables.size(); ++i) {
    if (!has_shape(tick, i)) continue;
    DeformableEncoder& object = *deformables[i];
    const Packet first = object.encode(tick, object.is_layered() ? Layer::haptic : Layer::all, number);
    add(first);
    if (!object.is_layered()) continue;
    const bool follows = number && !first.bytes.empty();
    add(object.encode(tick, Layer::visual, follows ? std::optional(*number + 1) : number));
  }
  if (loads) {
    TACTUS_TRY(const Packet packet, loads->encode(tick, Layer::all, number));
    add(packet);
  }
  last_tick = tick;
  return std::span<const Packet>(packets);
}

Sender::Sender(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Sender::Sender(Sender&&) noexcept = default;
Sender& Sender::operator=(Sender&&) noexcept = default;
Sender::~Sender() = default;

/// What options must be, and those that count.
static Result<SenderOptions> checked(const Scene& scene, SenderOptions options) {
  for (const double interval : {options.policy.key_interval, options.policy.silence})
    if (!(interval >= 0 && interval <= 86400)) return fail(Errc::invalid_argument, "R-API-4");
  if (!scene.moving().empty()) TACTUS_CHECK(RigidBounds::check(options.triggers, scene.grid));
  if (!scene.deformables.empty()) TACTUS_CHECK(DeformableEncoder::check(options.deformable));
  if (scene.loads) TACTUS_CHECK(LoadEncoder::check(options.load));
  if (scene.moving().empty()) options.triggers = {};  // they may be anything
  return options;
}

SharedTruth::SharedTruth(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
SharedTruth::~SharedTruth() = default;

Result<std::shared_ptr<SharedTruth>> SharedTruth::create(SharedScene scene, const SenderOptions& options) try {
  TACTUS_TRY(const SenderOptions used, checked(*scene, options));
  auto impl = std::make_unique<Impl>(*scene, used.triggers);
  impl->work.emplace(*scene);
  impl->owned = std::move(scene);
  return std::shared_ptr<SharedTruth>(new SharedTruth(std::move(impl)));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> SharedTruth::read(std::int64_t tick, const Truth& truth) noexcept { return impl_->read(tick, truth); }

std::span<const HeldPart> SharedTruth::held() const noexcept { return impl_->held.parts(); }

Result<Sender> Sender::create(SharedScene scene, const SenderOptions& options) {
  return create_with(std::move(scene), options, nullptr, {});
}

Result<Sender> Sender::create(SharedScene scene, const SenderOptions& options, std::shared_ptr<SharedTruth> truth) {
  return create_with(std::move(scene), options, std::move(truth), {});
}

Result<Sender> Sender::create(SharedScene scene, const SenderOptions& options, std::shared_ptr<SharedTruth> truth,
                              std::shared_ptr<const DevicePath> device) {
  return create_with(std::move(scene), options, std::move(truth), KnownDevice(std::move(device)));
}

Result<Sender> Sender::create_with(SharedScene scene, const SenderOptions& options, std::shared_ptr<SharedTruth> truth,
                                   KnownDevice device) try {
  TACTUS_TRY(const SenderOptions used, checked(*scene, options));
  return Sender(std::make_unique<Impl>(std::move(scene), used, std::move(truth), std::move(device)));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<std::span<const Packet>> Sender::encode(std::int64_t tick, const Truth& truth,
                                               std::optional<std::uint64_t> number) noexcept {
  return impl_->encode(tick, truth, number);
}

std::span<const HeldPart> Sender::held() const noexcept { return impl_->truth().held.parts(); }

void Sender::request_key() noexcept {
  impl_->rigid.request_key();
  for (auto& object : impl_->deformables) object->request_key();
  if (impl_->loads) impl_->loads->request_key();
}

void Sender::request_key(std::size_t substream) noexcept {
  if (substream == 0) impl_->rigid.request_key();
  else if (substream <= impl_->deformables.size()) impl_->deformables[substream - 1]->request_key();
  else if (impl_->loads && substream == load_substream(*impl_->scene)) impl_->loads->request_key();
}

void Sender::acknowledge(std::size_t substream, std::uint64_t number) noexcept {
  if (substream == 0) impl_->rigid.acknowledge(number);
  else if (substream <= impl_->deformables.size()) impl_->deformables[substream - 1]->acknowledge(number);
  else if (impl_->loads && substream == load_substream(*impl_->scene)) impl_->loads->acknowledge(number);
}

void Sender::set_link(const LinkState& link) noexcept {
  impl_->rigid.codec().set_link(link);
  for (auto& object : impl_->deformables) object->set_link(link);
  if (impl_->loads) impl_->loads->codec().set_link(link);
}

void Sender::set_bound_scale(double factor) noexcept {
  const double within = factor >= 1 ? std::min(factor, 64.0) : 1;  // NaN: 1
  impl_->rigid.codec().set_bound_scale(within);
  for (auto& object : impl_->deformables) object->set_bound_scale(within);
  if (impl_->loads) impl_->loads->codec().set_bound_scale(within);
}

void Sender::set_viewpoints(std::span<const Vec3> viewpoints) noexcept { impl_->rigid.codec().set_viewpoints(viewpoints); }

void Sender::forget_last(std::size_t substream) noexcept {
  if (substream == 0) impl_->rigid.forget_last();
  else if (substream <= impl_->deformables.size()) impl_->deformables[substream - 1]->forget_last();
  else if (impl_->loads && substream == load_substream(*impl_->scene)) impl_->loads->forget_last();
}

const SharedScene& Sender::scene() const noexcept { return impl_->scene; }
const RigidState& Sender::object(std::uint32_t object) const noexcept { return impl_->rigid.newest().objects[object]; }

std::uint64_t Sender::state_hash(std::size_t substream) const noexcept {
  if (substream == 0) return tactus::state_hash(*impl_->scene, impl_->rigid.newest());
  if (substream > impl_->deformables.size()) return tactus::state_hash(impl_->loads->newest());
  return impl_->deformables[substream - 1]->state_hash();
}

}  // namespace tactus
