// SPDX-License-Identifier: Apache-2.0
/// A recording with all that a trace can hold, written to and read from temporary files.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <tactus/trace/trace_file.h>
#include "tests/unit/temp_file.h"

namespace tactus {

using Bytes = std::vector<std::uint8_t>;

/// Bits, not values: -0 is not 0.
inline std::string image(const TraceFrame& frame) {
  std::string out;
  const auto put = [&out](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    out.append(raw, sizeof value);
  };
  const auto put_vec = [&put](const Vec3& v) { put(v.x), put(v.y), put(v.z); };
  put(frame.tick), put(frame.shown);
  out.append(frame.marker).append(1, '\0');
  for (const RigidSample& s : frame.objects) {
    put_vec(s.pose.position), put_vec(s.velocity), put_vec(s.angular_velocity);
    put(s.pose.rotation.w), put(s.pose.rotation.x), put(s.pose.rotation.y), put(s.pose.rotation.z);
  }
  for (const UserSample& u : frame.users) {
    put_vec(u.device.position), put_vec(u.device.velocity), put(u.device.buttons), put(u.device.time);
    put(u.device.orientation.w), put(u.device.orientation.x), put(u.device.orientation.y), put(u.device.orientation.z);
    put(u.contact.kind), put(u.contact.object), put(u.contact.stiffness);
    put_vec(u.contact.point), put_vec(u.contact.normal), put_vec(u.force), put_vec(u.server_force);
    put(u.servo.lateness), put(u.servo.age), put(u.servo.missed), put(u.servo.guard);
    if (!u.surface_contact) continue;
    put(u.surface_contact->mesh), put(u.surface_contact->triangle), put(u.surface_contact->stiffness);
    for (const double weight : u.surface_contact->weights) put(weight);
    put_vec(u.surface_contact->proxy), put_vec(u.surface_contact->normal);
  }
  for (const DeformableSample& m : frame.meshes) {
    put(m.updated);
    for (const float value : m.displacements) put(value);
  }
  return out;
}

struct Recording {
  TraceInfo info;
  std::vector<TraceFrame> frames;
};

/// A cube that moves, a floor that does not, one user who touches now and then with a device that senses
/// all there is, and one who never does.
inline Recording make_recording(std::size_t frame_count, std::uint32_t tick_rate = 1000) {
  std::mt19937_64 random(7);
  const auto number = [&random] { return std::ldexp(static_cast<double>(random()), -60) - 8.0; };
  const auto vec = [&number] { return Vec3{number(), number(), number()}; };
  std::mt19937_64 others(8);  // what only some devices sense leaves the rest as it is
  const auto more = [&others] { return std::ldexp(static_cast<double>(others()), -60) - 8.0; };
  const auto turn = [&more] {
    const double a = more();
    return Quat{std::cos(a), 0.6 * std::sin(a), 0, -0.8 * std::sin(a)};
  };
  Recording recording;
  recording.info = {tick_rate,
                    {{"cube", Dof::all}, {"floor \xC3\xA4", Dof::none}},
                    {{"left", {true, true, true, true}}, {"right"}},
                    "test",
                    "[scene]\nname = \"x\"\n"};
  const Pose floor{vec(), {0.6, 0, -0.8, -0.0}};
  for (std::size_t i = 0; i < frame_count; ++i) {
    TraceFrame frame;
    frame.tick = static_cast<std::int64_t>(i < 3 ? i : 2 * i);  // a gap
    frame.objects = {{{vec(), {number(), number(), number(), number()}}, vec(), {0.0, -0.0, 5e-324}}, {floor, {}, {}}};
    UserSample touching{.device = {}, .contact = {}, .force = vec(), .server_force = vec()};
    if (i % 3 == 1) touching.contact = {ContactKind::surface, 1, vec(), {0, 0, 1}, {}, 630.0};
    if (i % 3 == 2) touching.contact = {ContactKind::spring, 0, vec(), vec(), {}, 1e-3};
    touching.device = {vec(), turn(), {more(), more(), more()}, static_cast<std::uint32_t>(i / 2 % 4), 1'000'003 * frame.tick};
    touching.contact.device = touching.device.position;
    UserSample apart;
    apart.device.position = apart.contact.device = vec();
    frame.users = {touching, apart};
    recording.frames.push_back(frame);
  }
  return recording;
}

/// The same with two meshes: a tetrahedron that is new every third tick, and a square that never moves. One user touches them.
inline Recording make_mesh_recording(std::size_t frame_count) {
  Recording recording = make_recording(frame_count);
  recording.info.meshes = {{"blob", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}}},
                           {"sheet \xC3\xA4", {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}}};
  std::vector<float> shape(12);
  for (std::size_t i = 0; i < frame_count; ++i) {
    TraceFrame& frame = recording.frames[i];
    const bool updated = i % 3 == 1;
    if (updated)
      for (std::size_t k = 0; k < shape.size(); ++k) shape[k] = std::ldexp(static_cast<float>(k + i), -7);
    frame.meshes = {{updated, shape}, {false, std::vector<float>(12)}};
    if (i % 4 == 2)
      frame.users[1].surface_contact = {static_cast<std::uint32_t>(i / 4 % 2), 1, {0.25, 0.5, 0.25}, {1, 2, 3}, {0, 0, 1}, 20.0};
  }
  return recording;
}

inline Bytes write_recording(const Recording& recording, const std::string& path) {
  auto writer = TraceWriter::create(path, recording.info);
  EXPECT_TRUE(writer);
  for (const TraceFrame& frame : recording.frames) EXPECT_TRUE(writer->write(frame));
  EXPECT_TRUE(writer->finish());
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Reading {
  std::vector<TraceFrame> frames;
  std::optional<Error> error;
  bool cut_short = false;
};

inline Reading read_all(TraceResult<TraceReader> reader) {
  Reading reading;
  TraceFrame frame;
  while (reader) {
    const auto more = reader->next(frame);
    if (!more) reading.error = more.error();
    if (!more || !*more) break;
    reading.frames.push_back(frame);
  }
  if (!reader) reading.error = reader.error();
  if (!reading.error) reading.cut_short = reader->cut_short();
  return reading;
}

inline Reading read_bytes(std::span<const std::uint8_t> bytes) {
  const Bytes exact(bytes.begin(), bytes.end());  // a heap block of just this size, so that a sanitizer sees every step too far
  return read_all(TraceReader::open_memory(exact));
}

}  // namespace tactus
