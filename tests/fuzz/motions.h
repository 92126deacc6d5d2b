// SPDX-License-Identifier: Apache-2.0
/// Any bytes as what an encoder is given: motions, contacts, displacements.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/trigger.h>

namespace tactus {

inline double step(ByteReader& in, double scale) { return scale * static_cast<std::int16_t>(in.u16()); }
inline Vec3 vector(ByteReader& in, double scale) { return {step(in, scale), step(in, scale), step(in, scale)}; }

/// Mostly a small movement; now and then anything at all, a NaN too.
inline void move(ByteReader& in, RigidSample& sample) {
  const unsigned what = in.u8();
  sample.pose.position = sample.pose.position + vector(in, what & 1 ? 1e-3 : 1e-7);
  if (what & 2) sample.velocity = vector(in, 1e-4);
  if (what & 4) sample.angular_velocity = vector(in, 1e-3);
  const Vec3 turn = vector(in, what & 8 ? 1e-4 : 1e-7);
  const Quat q = Quat{1, turn.x, turn.y, turn.z} * sample.pose.rotation;
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  sample.pose.rotation = {q.w / length, q.x / length, q.y / length, q.z / length};
  if (what != 255) return;
  const std::uint64_t bits = in.u64();
  std::memcpy(&sample.velocity.y, &bits, sizeof bits);
}

inline Contact contact(ByteReader& in, const Pose& pose) {
  Contact c{static_cast<ContactKind>(in.u8() % 3), 0, vector(in, 1e-6), {0, 0, 1}, {}, step(in, 0.1)};
  c.device = to_world(pose, c.point - Vec3{0, 0, step(in, 1e-6)});
  return c;
}

/// Some vertices in a row; now and then one number that may be anything.
///   u  V x 3
inline void move(ByteReader& in, std::vector<float>& u) {
  const unsigned what = in.u8();
  const std::size_t vertices = u.size() / 3;
  const std::size_t first = in.u8() % vertices, last = std::min(vertices, first + in.u8() % 8);
  for (std::size_t i = 3 * first; i < 3 * last; ++i) u[i] += static_cast<float>(step(in, what & 1 ? 1e-3 : 1e-6));
  if (what == 255) u[3 * first] = std::bit_cast<float>(static_cast<std::uint32_t>(in.u64() >> 32));
}

}  // namespace tactus
