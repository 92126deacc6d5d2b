// SPDX-License-Identifier: Apache-2.0
#include <tactus/load/load_decoder.h>

#include <algorithm>

namespace tactus {

LoadDecoder::LoadDecoder(const Scene& scene) : scene_(scene), steps_(vectors_of_load(scene)) {
  objects_.reserve(scene.moving().size());
  vectors_.reserve(scene.moving().size() * steps_.size());
}

Result<PacketHead> LoadDecoder::read_head(std::span<const std::uint8_t> payload) noexcept {
  coder_ = RangeDecoder(payload);
  payload_ = payload.size();
  models_ = {};
  head_ = {};
  code_head(coder_, models_, scene_, head_);
  if (coder_.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
  return head_;
}

Result<void> LoadDecoder::read_objects(const LoadState& base) noexcept {
  const std::size_t moving = scene_.moving().size();
  std::uint64_t next = 0;
  for (std::uint32_t i = 0; i < head_.count; ++i) {
    if (moving > 1) next += coder_.magnitude(models_.gap, 0);
    if (coder_.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
    if (next >= moving) return fail(Errc::invalid, "R-LOD-3", bit());
    const auto object = static_cast<std::size_t>(next++);
    std::uint8_t level = 0;
    code_load(coder_, models_, level, steps_);
    if (coder_.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
    objects_.push_back(object);
    for (std::size_t v = 0; v < steps_.size(); ++v) {
      const Vec3i& before = base.vectors[object * steps_.size() + v];
      vectors_.push_back(steps_[v].changed ? after_step(before, steps_[v].steps, level) : before);
    }
  }
  return {};
}

Result<void> LoadDecoder::read_body(const LoadState& base, std::int64_t, DecodedPacket& out) noexcept {
  objects_.clear();
  vectors_.clear();
  if (head_.count < 1 || head_.count > scene_.moving().size()) return fail(Errc::invalid, "R-LOD-2", bit());
  TACTUS_CHECK(read_objects(base));
  if (const RuleName rule = coder_.broken_rule()) return fail(Errc::malformed, rule, bit());
  out.substream = load_substream(scene_);
  out.loads = head_.count;
  out.final_range = coder_.range();
  out.final_code = coder_.code();
  return {};
}

void LoadDecoder::commit(const LoadState& base, LoadState& next) noexcept {
  if (&base != &next) std::copy(base.vectors.begin(), base.vectors.end(), next.vectors.begin());
  const auto size = static_cast<std::ptrdiff_t>(steps_.size());
  for (std::size_t i = 0; i < objects_.size(); ++i)
    std::copy_n(vectors_.begin() + static_cast<std::ptrdiff_t>(i) * size, size,
                next.vectors.begin() + static_cast<std::ptrdiff_t>(objects_[i]) * size);
}

}  // namespace tactus
