// SPDX-License-Identifier: Apache-2.0
/// Whatever a Falcon says: rows of (size, its bytes) are USB IN transfers. Each reply holds bytes that stood there in this order, a pose that
/// comes of its counts is one that its position leads back to, and the torques in it are finite. However it began, a whole frame is read.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/device/falcon/falcon_frame.h>
#include <tactus/device/falcon/falcon_kinematics.h>
#include "tests/fuzz/require.h"

namespace {

using namespace tactus::device::falcon;

void check(const Reply& reply) {
  require(reply.buttons < 16 && reply.homed <= kAllHomed);
  const Triple angles{angle_of(reply.counts[0]), angle_of(reply.counts[1]), angle_of(reply.counts[2])};
  const auto pose = pose_with(angles);
  if (!pose) return;
  const auto again = pose_at(pose->position);
  require(again.has_value());
  for (std::size_t i = 0; i < 3; ++i)
    require(std::abs(std::remainder(again->angles[i] - angles[i], 2 * 3.14159265358979)) < 1e-6);
  for (const double torque : torques(*pose, {1, 2, 3})) require(std::isfinite(torque));
}

int replies_in(ReplyParser& parser, std::span<const std::uint8_t> transfer) {
  int out = 0;
  parser.give(transfer);
  while (const auto reply = parser.next()) {
    if (!*reply) continue;
    check(**reply);
    ++out;
  }
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ReplyParser parser;
  int replies = 0;
  for (std::span<const std::uint8_t> left(data, size); !left.empty();) {
    const std::size_t bytes = std::min<std::size_t>(left[0], left.size() - 1);
    const std::vector<std::uint8_t> transfer(left.begin() + 1, left.begin() + 1 + static_cast<std::ptrdiff_t>(bytes));
    replies += replies_in(parser, transfer);
    left = left.subspan(1 + bytes);
  }
  require(static_cast<std::size_t>(replies) <= size / kFrameBytes);
  std::array<std::uint8_t, 2 + kFrameBytes> whole{};
  const Frame frame = encode({{-32768, 32767, 0}, Light::red});
  std::copy(frame.begin(), frame.end(), whole.begin() + 2);
  require(replies_in(parser, whole) == 1);
  return 0;
}
