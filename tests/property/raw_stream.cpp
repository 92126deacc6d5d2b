// SPDX-License-Identifier: Apache-2.0
#include "raw_stream.h"

#include <algorithm>
#include <utility>

#include <tactus/base/bytes.h>

namespace tactus::conformance {

Bytes with_crc(Bytes bytes) {
  const std::uint32_t crc = crc32(bytes);
  ByteWriter(bytes).u32(crc);
  return bytes;
}

Bytes varint(std::uint64_t value) {
  Bytes out;
  ByteWriter(out).varint(value);
  return out;
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes first(const Bytes& bytes, std::size_t count) {
  return Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
}

Bytes RawHeader::body() const {
  Bytes out;
  ByteWriter w(out);
  w.u32(tick_rate);
  w.u8(grid.position);
  w.u8(grid.velocity);
  w.u8(grid.rotation);
  w.u8(grid.angular_velocity);
  w.u16(max_extrapolation);
  w.u8(baseline_span);
  w.bytes(object_count.value_or(varint(objects.size())));
  for (const RawObject& object : objects) {
    w.u8(object.kind);
    w.u8(object.dof);
    w.u8(static_cast<std::uint8_t>(object.name.size()));
    for (const char c : object.name) w.u8(static_cast<std::uint8_t>(c));
    for (const std::int32_t c : object.position) w.i32(c);
    for (const std::int32_t c : object.rotation) w.i32(c);
  }
  w.bytes(deformables);
  w.bytes(loads);
  w.bytes(motion);
  w.bytes(driven);
  w.bytes(elastic);
  w.bytes(extensions);
  return out;
}

Bytes RawHeader::around(const Bytes& body) const {
  Bytes out;
  ByteWriter w(out);
  w.bytes(magic);
  w.u8(version);
  w.u8(profile);
  w.u16(flags);
  w.u32(static_cast<std::uint32_t>(body.size()));
  w.bytes(body);
  return with_crc(std::move(out));
}

SharedScene RawHeader::parsed() const { return parse_scene(bytes()).value().scene; }

Bytes record(std::uint8_t type, const Bytes& payload) { return with_crc(Bytes{type} + varint(payload.size()) + payload); }

Bytes raw_packet(const Scene& header, std::uint16_t sequence, RigidHead head, std::span<const RawUpdate> updates) {
  const auto moving = header.moving();
  return coded_packet(sequence, [&](RangeEncoder& coder, RigidModels& models) {
    code_head(coder, models, header, head);
    std::size_t next = 0;
    for (RawUpdate update : updates) {
      if (moving.size() > 1) next += coder.magnitude(models.gap, update.gap);
      if (next >= moving.size()) return;  // a decoder that obeys R-RIG-4 stops here
      code_update(coder, models, header, moving[next++], update.coded);
    }
  });
}

Stream::Stream(const RawHeader& header) : scene_(header.parsed()), bytes_(header.bytes()) {}

Bytes Stream::packet(const Step& step) {
  const std::uint16_t sequence = step.sequence.value_or(next_sequence_);
  const auto baseline = ticks_.find(static_cast<std::uint16_t>(sequence - step.baseline));
  const std::int64_t from = step.key || baseline == ticks_.end() ? 0 : baseline->second;
  const RigidHead head{{step.key, step.baseline, static_cast<std::uint32_t>(step.tick - from)},
                       static_cast<std::uint32_t>(step.updates.size())};
  const auto moving = scene_->moving();
  std::vector<RawUpdate> updates;
  std::size_t next = 0;
  for (const Update& update : step.updates) {
    const auto at = static_cast<std::size_t>(std::ranges::find(moving, update.object) - moving.begin());
    updates.push_back({static_cast<std::uint32_t>(at - next),
                       {update.reason,
                        update.level,
                        update.ease,
                        update.keep,
                        {update.residual},
                        update.predictor,
                        update.is_held,
                        update.contact}});
    next = at + 1;
  }
  ticks_[sequence] = step.tick;
  next_sequence_ = static_cast<std::uint16_t>(sequence + 1);
  return raw_packet(*scene_, sequence, head, updates);
}

Stream& Stream::add(const Step& step) { return add_packet(step.tick, packet(step), step.key); }

Stream& Stream::add_packet(std::int64_t tick, const Bytes& packet, bool key) {
  if (key) keys_.push_back({tick, bytes_.size()});
  const Bytes delta = varint(static_cast<std::uint64_t>(tick - record_tick_));
  record_tick_ = tick;
  return add_record(1, delta + packet);
}

Stream& Stream::add_record(std::uint8_t type, const Bytes& payload) {
  bytes_ = std::move(bytes_) + record(type, payload);
  return *this;
}

Stream& Stream::finish() {
  const std::size_t index = bytes_.size();
  Bytes entries = varint(keys_.size());
  Key previous{0, 0};
  for (const Key& key : keys_) {
    entries =
        std::move(entries) + varint(static_cast<std::uint64_t>(key.tick - previous.tick)) + varint(key.offset - previous.offset);
    previous = key;
  }
  add_record(2, entries);
  Bytes offset;
  ByteWriter(offset).u64(index);
  return add_record(3, offset);
}

std::int32_t Random::integer(unsigned max_width) {
  const unsigned width = below(max_width + 1);
  const auto bits = static_cast<std::int32_t>(engine_() >> 33) & static_cast<std::int32_t>((std::uint32_t{1} << width) - 1);
  return below(2) == 0 ? bits : -bits;
}

Update random_update(Random& random, const Scene& header, std::uint32_t object) {
  const std::uint8_t dof = header.objects[object].dof;
  const auto level = static_cast<std::uint8_t>(random.below(4) == 0 ? random.below(16) : random.below(6));
  Update out{object, static_cast<Reason>(random.below(4)), level, {}};
  // Three rotation components of this width stay below length 1.
  const unsigned turn_width = header.grid.rotation > level + 1u ? header.grid.rotation - level - 1u : 0;
  const std::array<unsigned, kQuantities> widths{12, 10, std::min(turn_width, 16u), 8};
  for (std::size_t quantity = 0; quantity < kQuantities; ++quantity) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t bit = quantity < 2 ? axis : axis + 3;
      if (dof >> bit & 1u) out.residual[quantity][axis] = random.integer(widths[quantity]);
    }
  }
  return out;
}

Bytes updated_at(const RawHeader& header, std::initializer_list<std::int64_t> ticks) {
  Stream stream(header);
  std::int32_t i = 0;
  for (const std::int64_t tick : ticks) {
    const Update pushed{
        0, Reason::haptic, 0, {{{900 + i, -500, 40 * i}, {3000, 20 * i, -700}, {9000, -3000 * i, 800}, {300, -90, 70 * i}}}};
    stream.add({.tick = tick, .updates = {pushed}, .key = i == 0});
    ++i;
  }
  return stream.finish().bytes();
}

}  // namespace tactus::conformance
