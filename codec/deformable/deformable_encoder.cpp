// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/deformable_encoder.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/deformable/displacement.h>
#include <tactus/deformable/main_encoder.h>
#include <tactus/deformable/thesis_encoder.h>

namespace tactus {
namespace {

constexpr double kSomeLoss = 0.003;  // share of packets

template <class Codec>
class Of final : public DeformableEncoder {
 public:
  Of(const Scene& scene, std::size_t index, const DeformableOptions& options, const SenderPolicy& policy, std::size_t largest,
     bool layered, typename Codec::State initial)
      : object_(scene.deformables[index]),
        position_exp_(scene.grid.position),
        layered_(layered),
        truth_(object_.rest.size()),
        stream_(scene, layered ? chained(policy) : policy, index + 1, largest, layered ? 2 : 1, initial, scene, object_,
                options) {}

  Result<void> read(const DeformableTruth& truth) noexcept override {
    if (truth.touch) TACTUS_CHECK(check_touch(*truth.touch));
    TACTUS_CHECK(to_grid(truth.displacements, position_exp_, truth_));
    touch_ = truth.touch;
    stream_.codec().read(truth_, touch_ ? &*touch_ : nullptr);
    return {};
  }
  Packet encode(std::int64_t tick, Layer layer, std::optional<std::uint64_t> number) noexcept override {
    return stream_.encode(tick, layer, number).value_or(Packet{});
  }
  bool is_layered() const noexcept override { return layered_; }
  /// Where nothing is lost an acknowledgement is late at most.
  void set_link(const LinkState& link) noexcept override { stream_.set_answer(link.loss >= kSomeLoss ? link.answer : 0); }
  void set_widening(double factor) noexcept override { stream_.codec().set_widening(factor); }
  void know(std::unique_ptr<FollowedShape> shape) noexcept override {
    if constexpr (requires { stream_.codec().know(std::move(shape)); }) stream_.codec().know(std::move(shape));
  }
  void request_key() noexcept override { stream_.request_key(); }
  void forget_last() noexcept override { stream_.forget_last(); }
  void acknowledge(std::uint16_t sequence) noexcept override { stream_.acknowledge(sequence); }
  std::uint64_t state_hash() const noexcept override { return tactus::state_hash(object_, stream_.newest()); }

 private:
  /// A packet of one layer takes the vertices of the other from its baseline, so it must build on the newest packet.
  static SenderPolicy chained(SenderPolicy policy) noexcept {
    policy.baseline = Baseline::previous;
    return policy;
  }
  Result<void> check_touch(const SurfaceTouch& touch) const noexcept {
    if (!std::isfinite(touch.force) || !std::isfinite(touch.stiffness)) return fail(Errc::invalid_argument, "R-API-1");
    if (touch.triangle >= object_.triangles.size() || touch.force < 0 || !(touch.stiffness > 0))
      return fail(Errc::invalid_argument, "R-API-5");
    return {};
  }

  const DeformableObject& object_;
  std::uint8_t position_exp_;
  bool layered_;
  std::vector<Vec3i> truth_;  // this frame, on the grid
  std::optional<SurfaceTouch> touch_;
  SubstreamEncoder<Codec> stream_;
};

}  // namespace

std::size_t max_packet(const DeformableObject& object) noexcept {
  if (object.profile == DeformableProfile::thesis) return max_thesis_packet(object.rest.size(), object.quant_bits);
  return max_main_packet(object.rest.size(), object.basis.steps.size());
}

Result<void> DeformableEncoder::check(const DeformableOptions& options) noexcept {
  const auto in = [](double v, double low, double high) { return v >= low && v <= high; };  // false for NaN
  const DeformableThresholds& t = options.thresholds;
  if (in(t.visual, 0, 1e6) && in(t.weber_fraction.value_or(0), 0, 1e3) && in(t.depth_floor, 0, 1e6) &&
      in(options.visual_share.value_or(1), 1e-3, 1) && in(options.haptic_share.value_or(1), 1e-3, 1))
    return {};
  return fail(Errc::invalid_argument, "R-API-4");
}

std::unique_ptr<DeformableEncoder> DeformableEncoder::create(const Scene& scene, std::size_t object,
                                                             const DeformableOptions& options, const SenderPolicy& policy) {
  const DeformableObject& o = scene.deformables[object];
  if (o.profile == DeformableProfile::thesis)
    return std::make_unique<Of<ThesisEncoder>>(scene, object, options, policy, max_packet(o), options.layered,
                                               initial_thesis_state(o));
  return std::make_unique<Of<MainEncoder>>(scene, object, options, policy, max_packet(o), o.layered, initial_main_state(o));
}

}  // namespace tactus
