// SPDX-License-Identifier: Apache-2.0
/// The C interface from tests: small scenes and streams.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bindings/handles.h"

namespace tactus::c_test {

/// Options with the defaults.
template <class T>
T filled() {
  T out;
  EXPECT_EQ(init<T>(&out, sizeof out), TACTUS_OK);
  return out;
}

/// The function refuses, with this rule.
#define EXPECT_REFUSED(rule_name, function, ...)                                                            \
  do {                                                                                                      \
    tactus_error error{};                                                                                   \
    EXPECT_NE(function(__VA_ARGS__, &error), TACTUS_OK) << #function;                                       \
    EXPECT_STREQ(error.rule == nullptr ? "none" : error.rule, rule_name) << #function "(" #__VA_ARGS__ ")"; \
    EXPECT_EQ(function(__VA_ARGS__, nullptr), error.status) << #function;                                   \
  } while (false)

/// Two boxes, of which one can move; with a sheet of two triangles if asked for.
inline Scene make_scene(bool with_sheet = false, const tactus_scene_options* options = nullptr) {
  tactus_scene_builder* raw = nullptr;
  EXPECT_EQ(tactus_scene_builder_create(options, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  auto fixed = filled<tactus_rigid_options>(), above = filled<tactus_rigid_options>();
  fixed.dof = TACTUS_DOF_NONE;
  above.initial = {{0, 0, 0.05}, {1, 0, 0, 0}};
  EXPECT_EQ(tactus_scene_builder_rigid(raw, "table", &fixed, nullptr), TACTUS_OK);
  EXPECT_EQ(tactus_scene_builder_rigid(raw, "cube", &above, nullptr), TACTUS_OK);
  if (with_sheet) {
    const double corners[] = {0, 0, 0, 0.1, 0, 0, 0.1, 0.1, 0, 0, 0.1, 0};
    const std::uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    EXPECT_EQ(tactus_scene_builder_deformable(raw, "sheet", corners, 4, triangles, 2, nullptr, nullptr), TACTUS_OK);
  }
  EXPECT_EQ(tactus_scene_builder_declare_bounds(raw, nullptr, nullptr, nullptr, nullptr), TACTUS_OK);
  tactus_scene* scene = nullptr;
  tactus_error error{};
  EXPECT_EQ(tactus_scene_builder_build(raw, &scene, &error), TACTUS_OK) << error.object;
  return Scene(scene);
}

/// The cube swings.
struct Truth {
  tactus_rigid_sample objects[2]{};
  float displacements[12]{};
  tactus_shape shape{};
  tactus_truth truth = sized<tactus_truth>();

  explicit Truth(bool with_sheet = false) {
    truth.objects = objects;
    truth.object_count = 2;
    truth.shapes = &shape;
    truth.shape_count = with_sheet ? 1 : 0;
    at(0);
  }
  Truth(const Truth&) = delete;
  Truth& operator=(const Truth&) = delete;
  const tactus_truth* at(std::int64_t tick) {
    const double t = 1e-3 * static_cast<double>(tick), w = 6.28;
    objects[0] = {{{0, 0, 0}, {1, 0, 0, 0}}, {}, {}};
    objects[1] = {{{0.1 * std::sin(w * t), 0, 0.05}, {1, 0, 0, 0}}, {0.1 * w * std::cos(w * t), 0, 0}, {}};
    for (std::size_t i = 0; i < 12; ++i) displacements[i] = i % 3 == 2 ? static_cast<float>(-0.01 * std::sin(w * t)) : 0;
    shape = {displacements, 4, 0, 0, 0, 0};
    return &truth;
  }
};

inline Sender make_sender(const Scene& scene, const tactus_sender_options* options = nullptr) {
  tactus_sender* raw = nullptr;
  EXPECT_EQ(tactus_sender_create(scene.get(), options, &raw, nullptr), TACTUS_OK);
  return Sender(raw);
}

inline Receiver make_receiver(const Scene& scene, const tactus_receiver_options* options = nullptr) {
  tactus_receiver* raw = nullptr;
  EXPECT_EQ(tactus_receiver_create(scene.get(), options, &raw, nullptr), TACTUS_OK);
  return Receiver(raw);
}

struct Packet {
  tactus_packet info{};
  std::vector<std::uint8_t> bytes{};
};

inline std::vector<Packet> encode(const Sender& sender, std::int64_t tick, const tactus_truth* truth) {
  auto encoded = sized<tactus_encoded>();
  tactus_error error{};
  EXPECT_EQ(tactus_sender_encode(sender.get(), tick, truth, &encoded, &error), TACTUS_OK) << error.rule;
  std::vector<Packet> out;
  for (std::size_t i = 0; i < encoded.packet_count; ++i) {
    const tactus_packet& packet = encoded.packets[i];
    out.push_back({packet, {packet.data, packet.data + packet.bytes}});
  }
  return out;
}

inline tactus_status push(const Receiver& receiver, const Packet& packet, std::int64_t now = TACTUS_PACKET_TICK,
                          tactus_packet_info* info = nullptr, tactus_error* error = nullptr) {
  return tactus_receiver_push(receiver.get(), packet.info.number, packet.bytes.data(), packet.bytes.size(), now, info, error);
}

inline std::vector<std::uint8_t> take(const Writer& writer) {
  std::size_t size = 0;
  EXPECT_NE(tactus_writer_take(writer.get(), nullptr, 0, &size, nullptr), TACTUS_INVALID_ARGUMENT);
  std::vector<std::uint8_t> out(size);
  EXPECT_EQ(tactus_writer_take(writer.get(), out.data(), out.size(), &size, nullptr), TACTUS_OK);
  return out;
}

/// A stream file of so many ticks.
inline std::vector<std::uint8_t> make_stream(bool with_sheet = false, std::int64_t ticks = 500) {
  const Scene scene = make_scene(with_sheet);
  const Sender sender = make_sender(scene);
  tactus_writer* raw = nullptr;
  EXPECT_EQ(tactus_writer_create(scene.get(), &raw, nullptr), TACTUS_OK);
  const Writer writer(raw);
  Truth truth(with_sheet);
  for (std::int64_t tick = 0; tick < ticks; ++tick)
    for (const Packet& packet : encode(sender, tick, truth.at(tick)))
      EXPECT_EQ(
          tactus_writer_add(raw, tick, packet.info.number, packet.bytes.data(), packet.bytes.size(), packet.info.key, nullptr),
          TACTUS_OK);
  EXPECT_EQ(tactus_writer_finish(raw, nullptr), TACTUS_OK);
  return take(writer);
}

}  // namespace tactus::c_test
