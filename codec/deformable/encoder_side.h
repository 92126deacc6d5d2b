// SPDX-License-Identifier: Apache-2.0
/// What the encoders of both profiles share: the state that the decoder holds, when a key packet is due. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/deformable/encoder.h>
#include <tactus/deformable/state.h>
#include <tactus/packet/packet_order.h>

namespace tactus {

struct DeformableTruth {
  std::int64_t tick = 0;
  std::span<const Vec3i> truth;
  const std::optional<SurfaceTouch>& touch;
};

/// h = p |f_s| / k_c [m], thesis eq. 3.12.   pre  there is a p
inline double haptic_threshold(const DeformableThresholds& t, const SurfaceTouch& touch) noexcept {
  return *t.weber_fraction * std::max(touch.force / touch.stiffness, t.depth_floor);
}

inline std::int64_t squared_distance(const Vec3i& a, const Vec3i& b) noexcept {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t d = std::int64_t{a[i]} - b[i];
    sum += d * d;
  }
  return sum;
}

class DeformableEncoderSide {
 public:
  /// pre  header and mesh outlive the side
  DeformableEncoderSide(const StreamHeader& header, const DeformableObject& mesh, const DeformableEncoderOptions& options)
      : header_(header),
        mesh_(mesh),
        options_(options),
        rings_(mesh),
        initial_(initial_state(mesh)),
        held_(initial_),
        next_(initial_),
        expected_(mesh.rest.size()),
        split_(mesh.profile == DeformableProfile::main ? mesh.split : options.split),
        sequence_(static_cast<std::uint16_t>(options.first_sequence - 1)) {
    for (std::size_t i = 0; i < (split_ ? 2 : 1); ++i) buffers_[i].resize(max_deformable_packet_size(mesh));
  }
  DeformableEncoderSide(const DeformableEncoderSide&) = delete;
  DeformableEncoderSide& operator=(const DeformableEncoderSide&) = delete;
  virtual ~DeformableEncoderSide() = default;

  /// Of a split mesh the haptic half of a frame, then the visual one; else the whole.
  virtual EncodedDeformablePacket encode(const DeformableTruth& frame, Layer half) noexcept = 0;
  bool is_split() const noexcept { return split_; }
  const DeformableState& held() const noexcept { return held_; }

  void forget_last() noexcept {
    if (!std::exchange(can_forget_, false)) return;
    std::swap(held_, next_);
    key_tick_ = before_.key_tick;
    behind_ = before_.behind + 1;
    key_requested_ = key_requested_ || before_.key_requested;
  }
  void request_key() noexcept { key_requested_ = true; }

 protected:
  /// The first packet, one per interval, one after a pause so long that receivers may soon forget what there was, and one where the
  /// decoder no longer keeps what it should build on, or is said not to hold it.
  bool key_due(std::int64_t tick) const noexcept {
    const auto interval = static_cast<std::int64_t>(std::ceil(options_.key_interval * header_.tick_rate));
    return key_requested_ || key_tick_ < 0 || behind_ > header_.baseline_span || (interval > 0 && tick - key_tick_ >= interval) ||
           2 * (tick - held_.tick) > forget_ticks(header_.tick_rate);
  }
  /// The next packet is due although every bound may hold.
  bool key_requested() const noexcept { return key_requested_; }
  /// Packets back to `held_`.
  std::uint32_t baseline_delta() const noexcept { return behind_; }
  /// Somebody presses whose haptic threshold is to be kept.
  bool is_felt(const DeformableTruth& frame) const noexcept { return frame.touch && options_.thresholds.weber_fraction; }
  const DeformableState& base(bool key) const noexcept { return key ? initial_ : held_; }
  std::span<const std::uint32_t> area(std::uint32_t triangle) noexcept {
    rings_.triangles_around(triangle, mesh_.rings);
    return rings_.vertices();
  }
  /// Where the packet is written: the visual half beside the haptic one.
  std::span<std::uint8_t> buffer(Layer half) noexcept { return buffers_[half == Layer::visual ? 1 : 0]; }
  /// The packet in its buffer turns `base` into `next_`.
  EncodedDeformablePacket finish(std::size_t size, bool key, Layer half, std::int64_t tick, std::uint32_t updates) noexcept {
    const std::span<std::uint8_t> packet = buffer(half).first(size);
    ++sequence_;
    packet[0] = static_cast<std::uint8_t>(sequence_);
    packet[1] = static_cast<std::uint8_t>(sequence_ >> 8);
    next_.tick = tick;
    std::swap(held_, next_);
    before_ = {key_tick_, behind_, key_requested_};
    key_requested_ = false;
    can_forget_ = true;
    behind_ = 1;
    if (key) key_tick_ = tick;
    return {packet, updates, key, half};
  }

  const StreamHeader& header_;
  const DeformableObject& mesh_;
  const DeformableEncoderOptions options_;
  Rings rings_;
  const DeformableState initial_;  // what key packets build on
  DeformableState held_,
      next_;  // what the decoder holds, and will hold after the packet at hand; between packets what it held before
  std::vector<Vec3i> expected_;

 private:
  struct Before {
    std::int64_t key_tick = -1;
    std::uint32_t behind = 1;
    bool key_requested = false;
  };

  const bool split_;
  std::array<std::vector<std::uint8_t>, 2> buffers_;
  std::uint16_t sequence_;
  std::int64_t key_tick_ = -1;  // of the last key packet; -1: none yet
  std::uint32_t behind_ = 1;    // packets from `held_` to the next one; more than 1 after losses
  bool key_requested_ = false;  // by request_key(), since the last packet
  Before before_;               // the last packet
  bool can_forget_ = false;     // `next_` is the state before it
};

std::unique_ptr<DeformableEncoderSide> make_main_side(const StreamHeader& header, const DeformableObject& mesh,
                                                      const DeformableEncoderOptions& options);
std::unique_ptr<DeformableEncoderSide> make_thesis_side(const StreamHeader& header, const DeformableObject& mesh,
                                                        const DeformableEncoderOptions& options);

}  // namespace tactus
