// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_decoder.h>

#include <algorithm>

#include <tactus/base/out_of_memory.h>
#include <tactus/packet/packet_order.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {
namespace {

constexpr std::int64_t kTickLimit = 0xffffffff;

/// A state that packets may build on.
struct Slot {
  bool held = false;
  std::uint64_t number = 0;
  std::int64_t tick = 0;
  std::vector<RigidState> objects;
};

}  // namespace

struct RigidDecoder::Impl {
  explicit Impl(std::uint32_t tick_rate) noexcept : order(tick_rate) {}

  StreamHeader header;  // without meshes
  DecodeLimits limits;
  std::vector<std::uint32_t> moving;
  Slot initial;
  PacketOrder order;
  std::vector<Slot> slots;  // baseline_span of them
  std::size_t newest = 0;
  std::vector<RigidUpdate> updates;  // staging: nothing reaches a slot before the whole packet has proved valid
  std::vector<RigidState> states;

  const Slot& current() const noexcept { return slots[newest].held ? slots[newest] : initial; }
  Result<const Slot*> baseline_of(const PacketHead& head, std::uint64_t number) noexcept;
  Result<void> read_updates(RangeDecoder& coder, RigidModels& models, const PacketHead& head, const Slot& baseline,
                            std::int64_t tick) noexcept;
  void commit(const Slot& baseline, std::uint64_t number, std::int64_t tick) noexcept;
};

Result<const Slot*> RigidDecoder::Impl::baseline_of(const PacketHead& head, std::uint64_t number) noexcept {
  if (head.key) return &initial;
  if (head.baseline_delta < 1 || head.baseline_delta > header.baseline_span) return fail(Errc::invalid, "R-PKT-3");
  if (order.is_foreign(number)) {
    order.forget();
    return fail(Errc::state, "R-PKT-7");
  }
  const std::uint64_t wanted = number - head.baseline_delta;
  const auto slot = std::find_if(slots.begin(), slots.end(), [&](const Slot& s) { return s.held && s.number == wanted; });
  if (!order.holds(wanted) || slot == slots.end()) return fail(Errc::state, "R-PKT-4");
  return &*slot;
}

Result<void> RigidDecoder::Impl::read_updates(RangeDecoder& coder, RigidModels& models, const PacketHead& head,
                                              const Slot& baseline, std::int64_t tick) noexcept {
  updates.clear();
  states.clear();
  std::uint64_t next = 0;  // index into `moving`
  for (std::uint32_t i = 0; i < head.count; ++i) {
    if (moving.size() > 1) next += coder.magnitude(models.gap, 0);
    if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
    if (next >= moving.size()) return fail(Errc::invalid, "R-RIG-4");
    const std::uint32_t object = moving[static_cast<std::size_t>(next++)];
    CodedUpdate update;
    code_update(coder, models, header.objects[object].dof, update);
    if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
    const RigidState& base = baseline.objects[object];
    const auto state = reconstruct({base, predict(base, tick, header)}, tick, update, header);
    if (!state) return fail(Errc::invalid, "R-RIG-6");
    updates.push_back({object, update.reason, update.level});
    states.push_back(*state);
  }
  return {};
}

void RigidDecoder::Impl::commit(const Slot& baseline, std::uint64_t number, std::int64_t tick) noexcept {
  newest = (newest + 1) % slots.size();
  Slot& slot = slots[newest];
  if (&slot != &baseline) std::copy(baseline.objects.begin(), baseline.objects.end(), slot.objects.begin());
  slot.held = true;
  slot.number = number;
  slot.tick = tick;
  for (std::size_t i = 0; i < updates.size(); ++i) slot.objects[updates[i].object] = states[i];
}

RigidDecoder::RigidDecoder(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
RigidDecoder::RigidDecoder(RigidDecoder&&) noexcept = default;
RigidDecoder& RigidDecoder::operator=(RigidDecoder&&) noexcept = default;
RigidDecoder::~RigidDecoder() = default;

Result<RigidDecoder> RigidDecoder::create(const StreamHeader& header, const DecodeLimits& limits) try {
  TACTUS_CHECK(check_header(header, limits));
  auto impl = std::make_unique<Impl>(header.tick_rate);
  impl->limits = limits;
  impl->moving = moving_objects(header);
  impl->initial.held = true;
  for (const RigidObject& object : header.objects) impl->initial.objects.push_back(object.initial);
  impl->slots.resize(header.baseline_span);
  for (Slot& slot : impl->slots) slot.objects = impl->initial.objects;
  impl->updates.reserve(impl->moving.size());
  impl->states.reserve(impl->moving.size());
  impl->header = without_meshes(header);
  return RigidDecoder(std::move(impl));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<DecodedPacket> RigidDecoder::decode(std::span<const std::uint8_t> packet, std::optional<std::int64_t> now) noexcept {
  Impl& d = *impl_;
  if (packet.size() > d.limits.packet_bytes) return fail(Errc::limit_exceeded, "R-PKT-1");
  if (packet.size() < 2) return fail(Errc::truncated, "R-PKT-2");
  const auto sequence = static_cast<std::uint16_t>(packet[0] | packet[1] << 8);
  d.order.arrive(now);
  if (d.order.is_late(sequence)) return fail(Errc::state, "R-PKT-5");
  const std::uint64_t number = d.order.number_of(sequence);

  RangeDecoder coder(packet.subspan(2));
  RigidModels models = start_models();
  PacketHead head;
  const auto bit = [&] { return 16 + 8 * static_cast<std::uint64_t>(std::min(coder.position(), packet.size() - 2)); };
  code_head(coder, models, d.header, d.moving.size(), head);
  if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
  TACTUS_TRY(const Slot* baseline, d.baseline_of(head, number));
  const std::int64_t tick = baseline->tick + head.tick_delta;
  if (tick >= kTickLimit || !d.order.fits(head.key, tick)) return fail(Errc::invalid, "R-RIG-1", bit());
  if (head.count < 1 || head.count > d.moving.size()) return fail(Errc::invalid, "R-RIG-3", bit());
  if (auto read = d.read_updates(coder, models, head, *baseline, tick); !read)
    return fail(read.error().code, read.error().rule, bit());
  if (const char* rule = coder.broken_rule()) return fail(Errc::malformed, rule, bit());
  d.commit(*baseline, number, tick);
  d.order.accept(number, head.key, tick);
  return DecodedPacket{sequence, head.key, tick, d.updates, coder.range(), coder.code()};
}

std::span<const RigidState> RigidDecoder::objects() const noexcept { return impl_->current().objects; }
const StreamHeader& RigidDecoder::header() const noexcept { return impl_->header; }
std::uint64_t RigidDecoder::state_hash() const noexcept { return tactus::state_hash(impl_->header, objects()); }

}  // namespace tactus
