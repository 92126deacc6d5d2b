// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_work.h>

#include <algorithm>
#include <bit>

#include <tactus/rigid/rigid_syntax.h>

namespace tactus {

constexpr std::size_t kLargest = 300 * (RigidWork::kMostUpdates + 1);  // [bytes] of a payload of so many updates

RigidWork::RigidWork(const Scene& scene) : entries_(std::bit_ceil(std::clamp<std::size_t>(2 * scene.moving().size(), 64, 8192))) {
  const std::size_t most = std::min(scene.moving().size(), kMostUpdates);
  const std::size_t bytes = std::min(max_rigid_packet(scene), kLargest);
  for (Body& body : bodies_) {
    body.key.reserve(kAll + kEach * most);
    body.bytes.reserve(bytes);
    body.after.reserve(most);
  }
}

std::size_t RigidWork::slot_of(const Asked& asked) const noexcept {
  const std::uint64_t hash =
      (asked.version + (asked.early == 1 ? 0 : 1u << 20)) * 0xBF58476D1CE4E5B9u + asked.object * 0x9E3779B97F4A7C15u;
  return (hash >> 32) & (entries_.size() - 1);
}

const RigidDecision* RigidWork::find(std::uint64_t read, const Asked& asked) const noexcept {
  const Entry& entry = entries_[slot_of(asked)];
  return entry.read == read && entry.asked == asked ? &entry.decision : nullptr;
}

void RigidWork::put(std::uint64_t read, const Asked& asked, const RigidDecision& decision) noexcept {
  entries_[slot_of(asked)] = {read, asked, decision};
}

const RigidWork::Body* RigidWork::find(std::uint64_t read, std::span<const std::uint32_t> key) const noexcept {
  const auto found =
      std::ranges::find_if(bodies_, [&](const Body& body) { return body.read == read && std::ranges::equal(body.key, key); });
  return found == bodies_.end() ? nullptr : &*found;
}

void RigidWork::put(std::uint64_t read, std::span<const std::uint32_t> key, std::span<const std::uint8_t> bytes, Reason reason,
                    std::span<VersionedPath* const> after) noexcept {
  const auto same = std::ranges::find_if(bodies_, [&](const Body& body) {
    return body.read == read && std::ranges::equal(std::span(body.key).subspan(kHead), key.subspan(kHead));
  });
  for (std::size_t i = 0; i < after.size(); ++i)
    after[i]->version = same != bodies_.end() ? same->after[i].version : next_version();
  Body& body = bodies_[next_++ % bodies_.size()];
  body.read = read;
  body.key.assign(key.begin(), key.end());
  body.bytes.assign(bytes.begin(), bytes.end());
  body.after.clear();
  for (const VersionedPath* path : after) body.after.push_back(*path);
  body.reason = reason;
}

void append_to(std::vector<std::uint32_t>& key, const RigidState& s) noexcept {
  const auto add = [&key](std::int64_t value) { key.push_back(static_cast<std::uint32_t>(value)); };
  add(s.tick);
  add(s.tick >> 32);
  for (const std::int32_t v : s.position) add(v);
  for (const std::int32_t v : s.rotation) add(v);
  for (const std::int32_t v : s.velocity) add(v);
  for (const std::int32_t v : s.angular_velocity) add(v);
  add(static_cast<std::int64_t>(s.predictor) | s.smoothing_exp << 8 | s.retained << 16 | (s.contact.is_held ? 1 << 24 : 0) |
      s.lod << 25);
  for (const std::int32_t v : s.contact.point) add(v);
  for (const std::int32_t v : s.contact.normal) add(v);
  add(s.contact.drag);
}

}  // namespace tactus
