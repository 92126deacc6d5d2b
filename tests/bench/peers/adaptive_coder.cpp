// SPDX-License-Identifier: Apache-2.0
/// What anybody would write first: numbers through an adaptive binary range coder. Class of the magnitude under that of the number
/// before it on the same axis, then the two bits below the leading one, all adaptive; the rest raw. Models live on from packet to
/// packet, so a packet decodes only after all before it.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include <tactus/base/range_coder.h>
#include "tests/bench/peers/coder.h"

namespace tactus::peers {
namespace {

constexpr std::size_t kContexts = 8;  // classes of the number before, the last one for all larger ones

struct Models {
  std::array<std::array<MagnitudeModel, kContexts>, 3> size;
  std::array<std::array<TreeModel<2>, 16>, 3> leading;
};

/// |value| < 2^30
template <class Coder>
std::int32_t code(Coder& coder, Models& models, std::size_t axis, std::uint32_t& before, std::int32_t value) {
  const auto size = static_cast<std::uint32_t>(std::abs(value));
  const auto typed = static_cast<std::uint32_t>(std::bit_width(size));
  auto& model = models.size[axis][std::min<std::size_t>(before, kContexts - 1)];
  std::uint32_t width = coder.template tree<4>(model, std::min(typed, 15U));
  before = width;
  if (width == 15) width += coder.raw(4, typed - 15);
  if (width == 0) return 0;
  std::uint32_t out = 1;
  unsigned left = width - 1;
  if (left >= 2) {
    left -= 2;
    out = 4 | coder.template tree<2>(models.leading[axis][std::min(width, 15U)], size >> left & 3);
  }
  for (unsigned count = 0; left > 0; left -= count) {
    count = std::min(left, 16U);
    out = out << count | coder.raw(count, size >> (left - count) & ((1U << count) - 1));
  }
  return coder.raw(1, value < 0) != 0 ? -static_cast<std::int32_t>(out) : static_cast<std::int32_t>(out);
}

class AdaptiveCoder final : public VertexCoder {
 public:
  Bytes encode(std::span<const Vec3i> values) override {
    Bytes out(16 * values.size() + 16);
    RangeEncoder coder(out);
    std::array<std::uint32_t, 3> before{};
    for (const Vec3i& v : values)
      for (std::size_t axis = 0; axis < 3; ++axis) code(coder, models_, axis, before[axis], v[axis]);
    out.resize(coder.finish());
    return out;
  }
  bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) override {
    RangeDecoder coder(packet);
    std::array<std::uint32_t, 3> before{};
    for (Vec3i& v : values)
      for (std::size_t axis = 0; axis < 3; ++axis) v[axis] = code(coder, models_, axis, before[axis], 0);
    return !coder.broken_rule();
  }

 private:
  Models models_;
};

}  // namespace

void add_adaptive(std::vector<Peer>& out) {
  out.push_back({"adaptive range coder", "models kept",
                 [](const Animation&) -> std::unique_ptr<VertexCoder> { return std::make_unique<AdaptiveCoder>(); }});
}

}  // namespace tactus::peers
