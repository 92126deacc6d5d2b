// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/decoder.h>

#include <algorithm>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/out_of_memory.h>
#include <tactus/deformable/main_reader.h>
#include <tactus/deformable/thesis_syntax.h>
#include <tactus/packet/packet_order.h>

namespace tactus {
namespace {

constexpr std::int64_t kTickLimit = 0xffffffff;

/// A state that packets may build on.
struct Slot {
  bool held = false;
  std::uint64_t number = 0;
  DeformableState state;
};

struct ListedVertex {
  std::uint32_t vertex = 0;
  std::uint32_t symbol[3]{};
};

}  // namespace

struct DeformableDecoder::Impl {
  Impl(const StreamHeader& stream, std::size_t index, const DecodeLimits& decode_limits)
      : baseline_span(stream.baseline_span),
        mesh(stream.meshes[index]),
        limits(decode_limits),
        order(stream.tick_rate),
        reader(mesh),
        initial{true, 0, initial_state(mesh)},
        staging(initial) {
    slots.assign(baseline_span, initial);
    for (Slot& slot : slots) slot.held = false;
    if (mesh.profile == DeformableProfile::thesis) {
      listed.reserve(mesh.rest.size());
      cold = initial_thesis_models(mesh);
      models = cold;
    }
  }

  std::uint8_t baseline_span;
  const DeformableObject mesh;
  DecodeLimits limits;
  PacketOrder order;
  MainReader reader;        // main
  Slot initial, staging;    // nothing reaches a slot before the whole packet has proved valid
  std::vector<Slot> slots;  // baseline_span of them
  std::size_t newest = 0;
  std::vector<ListedVertex> listed;    // thesis
  std::vector<BitModel> cold, models;  // thesis

  const Slot& current() const noexcept { return slots[newest].held ? slots[newest] : initial; }
  Result<const Slot*> baseline_of(bool key, std::uint32_t delta, std::uint64_t number) noexcept;
  Result<std::int64_t> tick_after(const Slot& baseline, bool key, std::uint32_t delta) const noexcept;
  Result<DecodedDeformablePacket> decode_main(std::span<const std::uint8_t> payload, std::uint64_t number) noexcept;
  Result<DecodedDeformablePacket> decode_thesis(std::span<const std::uint8_t> payload, std::uint64_t number) noexcept;
  Result<ThesisHead> read_thesis_head(ByteReader& in) const noexcept;
  Result<void> read_list(RangeDecoder& coder, std::uint32_t count) noexcept;
  void commit(std::uint64_t number, bool key, std::int64_t tick) noexcept;
};

Result<const Slot*> DeformableDecoder::Impl::baseline_of(bool key, std::uint32_t delta, std::uint64_t number) noexcept {
  if (key) return &initial;
  if (delta < 1 || delta > baseline_span) return fail(Errc::invalid, "R-PKT-3");
  if (order.is_foreign(number)) {
    order.forget();
    return fail(Errc::state, "R-PKT-7");
  }
  const std::uint64_t wanted = number - delta;
  const auto slot = std::find_if(slots.begin(), slots.end(), [&](const Slot& s) { return s.held && s.number == wanted; });
  if (!order.holds(wanted) || slot == slots.end()) return fail(Errc::state, "R-PKT-4");
  return &*slot;
}

Result<std::int64_t> DeformableDecoder::Impl::tick_after(const Slot& baseline, bool key, std::uint32_t delta) const noexcept {
  const std::int64_t tick = baseline.state.tick + delta;
  if (tick >= kTickLimit || !order.fits(key, tick)) return fail(Errc::invalid, "R-MES-8");
  return tick;
}

void DeformableDecoder::Impl::commit(std::uint64_t number, bool key, std::int64_t tick) noexcept {
  staging.held = true;
  staging.number = number;
  staging.state.tick = tick;
  newest = (newest + 1) % slots.size();
  std::swap(slots[newest], staging);
  order.accept(number, key, tick);
}

Result<DecodedDeformablePacket> DeformableDecoder::Impl::decode_main(std::span<const std::uint8_t> payload,
                                                                     std::uint64_t number) noexcept {
  RangeDecoder coder(payload);
  const auto bit = [&] { return 16 + 8 * static_cast<std::uint64_t>(std::min(coder.position(), payload.size())); };
  MainModels start = main_start_models();
  MainHead head;
  code_main_start(coder, start, mesh, baseline_span, head);
  if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
  TACTUS_TRY(const Slot* baseline, baseline_of(head.key, head.baseline_delta, number));
  TACTUS_TRY(const std::int64_t tick, tick_after(*baseline, head.key, head.tick_delta));
  const auto updates = reader.read(coder, start, head, baseline->state, staging.state);
  if (!updates) return fail(updates.error().code, updates.error().rule, bit());
  if (const char* rule = coder.broken_rule()) return fail(Errc::malformed, rule, bit());
  commit(number, head.key, tick);
  return DecodedDeformablePacket{
      static_cast<std::uint16_t>(number), head.key, head.half, tick, *updates, coder.range(), coder.code()};
}

Result<ThesisHead> DeformableDecoder::Impl::read_thesis_head(ByteReader& in) const noexcept {
  ThesisHead head;
  const std::uint8_t key = in.u8();
  if (key > 1) return fail(Errc::malformed, "R-MES-11", in.bit_offset());
  head.key = key == 1;
  if (!head.key && baseline_span > 1) head.baseline_delta = in.u8();
  const std::uint64_t tick_delta = in.varint(), count = in.varint(), list_bytes = in.varint(), lowest = in.varint(),
                      range = in.varint();
  if (in.overrun()) return fail(Errc::truncated, "R-MES-11", in.bit_offset());
  if (!in.ok()) return fail(Errc::malformed, "R-MES-11", in.bit_offset());
  constexpr std::uint64_t kSpan = std::uint64_t{4} * DeformableObject::kMaxDisplacement;
  if (tick_delta > 0xffffffff || count < 1 || count > mesh.rest.size() || lowest > kSpan || range > kSpan)
    return fail(Errc::invalid, "R-MES-12", in.bit_offset());
  if (list_bytes > in.remaining()) return fail(Errc::truncated, "R-MES-11", in.bit_offset());
  head.tick_delta = static_cast<std::uint32_t>(tick_delta);
  head.count = static_cast<std::uint32_t>(count);
  head.list_bytes = static_cast<std::uint32_t>(list_bytes);
  head.lowest = static_cast<std::int32_t>(lowest >> 1 ^ (~(lowest & 1) + 1));
  head.range = static_cast<std::uint32_t>(range);
  return head;
}

Result<void> DeformableDecoder::Impl::read_list(RangeDecoder& coder, std::uint32_t count) noexcept {
  listed.clear();
  std::uint64_t next = 0;
  const auto vertices = static_cast<std::uint32_t>(mesh.rest.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    next += code_gap(coder, models, 0xffffffff, vertices);
    if (next >= vertices) return fail(Errc::invalid, "R-MES-13");
    listed.push_back({static_cast<std::uint32_t>(next++), {}});
  }
  if (const char* rule = coder.broken_rule()) return fail(Errc::malformed, rule);
  return {};
}

Result<DecodedDeformablePacket> DeformableDecoder::Impl::decode_thesis(std::span<const std::uint8_t> payload,
                                                                       std::uint64_t number) noexcept {
  ByteReader in(payload, 2);
  TACTUS_TRY(const ThesisHead head, read_thesis_head(in));
  TACTUS_TRY(const Slot* baseline, baseline_of(head.key, head.baseline_delta, number));
  TACTUS_TRY(const std::int64_t tick, tick_after(*baseline, head.key, head.tick_delta));
  models = mesh.models_kept ? baseline->state.models : cold;
  RangeDecoder list(in.bytes(head.list_bytes));
  if (auto read = read_list(list, head.count); !read) return fail(read.error().code, read.error().rule, in.bit_offset());
  RangeDecoder coder(in.bytes(in.remaining()));
  const auto symbols = std::span<BitModel>(models).subspan(kIndexModels);
  for (ListedVertex& l : listed)
    for (std::uint32_t& s : l.symbol) s = code_symbol(coder, symbols, mesh.quant_bits, 0);
  if (const char* rule = coder.broken_rule()) return fail(Errc::malformed, rule, in.bit_offset());

  DeformableState& next = staging.state;
  next.displacement = baseline->state.displacement;
  for (const ListedVertex& l : listed) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto& u = next.displacement[l.vertex][axis];
      u = limited_displacement(std::int64_t{u} + restore_error(l.symbol[axis], head, mesh.quant_bits));
    }
  }
  if (mesh.models_kept) next.models = models;
  commit(number, head.key, tick);
  return DecodedDeformablePacket{
      static_cast<std::uint16_t>(number), head.key, Layer::all, tick, head.count, coder.range(), coder.code()};
}

DeformableDecoder::DeformableDecoder(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
DeformableDecoder::DeformableDecoder(DeformableDecoder&&) noexcept = default;
DeformableDecoder& DeformableDecoder::operator=(DeformableDecoder&&) noexcept = default;
DeformableDecoder::~DeformableDecoder() = default;

Result<DeformableDecoder> DeformableDecoder::create(const StreamHeader& header, std::size_t mesh,
                                                    const DecodeLimits& limits) try {
  TACTUS_CHECK(check_header(header, limits));
  if (mesh >= header.meshes.size()) return fail(Errc::invalid_argument, "R-API-5");
  return DeformableDecoder(std::make_unique<Impl>(header, mesh, limits));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<DecodedDeformablePacket> DeformableDecoder::decode(std::span<const std::uint8_t> packet,
                                                          std::optional<std::int64_t> now) noexcept {
  Impl& d = *impl_;
  if (packet.size() > d.limits.packet_bytes) return fail(Errc::limit_exceeded, "R-PKT-1");
  if (packet.size() < 2) return fail(Errc::truncated, "R-PKT-2");
  const auto sequence = static_cast<std::uint16_t>(packet[0] | packet[1] << 8);
  d.order.arrive(now);
  if (d.order.is_late(sequence)) return fail(Errc::state, "R-PKT-5");
  const std::uint64_t number = d.order.number_of(sequence);
  return d.mesh.profile == DeformableProfile::main ? d.decode_main(packet.subspan(2), number)
                                                   : d.decode_thesis(packet.subspan(2), number);
}

std::span<const DeformableDecoder::Displacement> DeformableDecoder::displacements() const noexcept {
  return impl_->current().state.displacement;
}

std::span<const DeformableDecoder::Displacement> DeformableDecoder::displacements_at(std::int64_t tick) noexcept {
  Impl& d = *impl_;
  const DeformableState& state = d.current().state;
  return d.reader.predict(state, std::clamp(tick, state.tick, kTickLimit));
}

std::int64_t DeformableDecoder::tick() const noexcept { return impl_->current().state.tick; }
std::uint64_t DeformableDecoder::state_hash() const noexcept { return tactus::state_hash(impl_->mesh, impl_->current().state); }

}  // namespace tactus
