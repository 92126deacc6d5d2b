// SPDX-License-Identifier: Apache-2.0
/// Which channels a trace has, in the order in which a tick's messages are written. Shared by writer and reader.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <tactus/trace/frame.h>
#include <tactus/trace/message_schemas.h>

namespace tactus {

enum class Role : std::uint8_t {
  pose,
  twist,
  device,
  orientation,
  velocity,
  buttons,
  device_time,
  force,
  server_force,
  contact,
  surface_contact,
  rest,
  displacement,
  shown,
  marker,
  servo,
  reports
};
enum class Occurs : std::uint8_t { every_tick, first_tick, when_changed, in_contact, when_updated, when_marked, when_reported };

inline constexpr const char* kShownTopic = "/shown";
inline constexpr const char* kMarkersTopic = "/markers";

struct TraceChannel {
  Role role = Role::pose;
  Occurs occurs = Occurs::every_tick;
  std::uint32_t index = 0;  ///< of the object (pose, twist), the mesh (rest, displacement) or the user
  std::string topic;
};

inline MessageType message_type(Role role) noexcept {
  switch (role) {
    case Role::pose:
      return MessageType::pose;
    case Role::twist:
      return MessageType::twist;
    case Role::device:
      return MessageType::point;
    case Role::contact:
      return MessageType::contact;
    case Role::surface_contact:
      return MessageType::surface_contact;
    case Role::rest:
      return MessageType::mesh;
    case Role::displacement:
      return MessageType::displacements;
    case Role::orientation:
      return MessageType::quaternion;
    case Role::buttons:
      return MessageType::buttons;
    case Role::device_time:
    case Role::shown:
      return MessageType::time_reference;
    case Role::marker:
      return MessageType::log;
    case Role::servo:
      return MessageType::servo;
    case Role::reports:
      return MessageType::reports;
    case Role::velocity:
    case Role::force:
    case Role::server_force:
      break;
  }
  return MessageType::vector;
}

/// True if a mesh's fixed vertices and period are valid.
inline bool is_valid(const TraceDeformable& mesh) noexcept {
  const bool ascends = std::ranges::adjacent_find(mesh.fixed, std::greater_equal<>()) == mesh.fixed.end();
  const bool is_there = mesh.fixed.empty() || mesh.fixed.back() < mesh.rest.vertices.size();
  return ascends && is_there && mesh.period > 0 && mesh.period <= 1e9;  // false for NaN
}

inline std::vector<TraceChannel> trace_channels(const TraceInfo& info) {
  std::vector<TraceChannel> channels;
  for (std::uint32_t i = 0; i < info.objects.size(); ++i) {
    const std::string path = "/objects/" + info.objects[i].name;
    const bool moves = info.objects[i].dof != Dof::none;
    channels.push_back({Role::pose, moves ? Occurs::when_changed : Occurs::first_tick, i, path + "/pose"});
    if (moves) channels.push_back({Role::twist, Occurs::when_changed, i, path + "/twist"});
  }
  for (std::uint32_t i = 0; i < info.meshes.size(); ++i) {
    const std::string path = "/meshes/" + info.meshes[i].name;
    channels.push_back({Role::rest, Occurs::first_tick, i, path + "/rest"});
    channels.push_back({Role::displacement, Occurs::when_updated, i, path + "/displacement"});
  }
  if (info.shows_past) channels.push_back({Role::shown, Occurs::every_tick, 0, kShownTopic});
  if (info.capture) channels.push_back({Role::marker, Occurs::when_marked, 0, kMarkersTopic});
  for (std::uint32_t i = 0; i < info.users.size(); ++i) {
    const std::string path = "/users/" + info.users[i].name;
    const DeviceSenses& senses = info.users[i].senses;
    channels.push_back({Role::device, Occurs::every_tick, i, path + "/device"});
    if (senses.orientation) channels.push_back({Role::orientation, Occurs::every_tick, i, path + "/device_orientation"});
    if (senses.velocity) channels.push_back({Role::velocity, Occurs::every_tick, i, path + "/device_velocity"});
    if (senses.buttons) channels.push_back({Role::buttons, Occurs::when_changed, i, path + "/device_buttons"});
    if (senses.time) channels.push_back({Role::device_time, Occurs::every_tick, i, path + "/device_time"});
    if (info.users[i].has_servo) channels.push_back({Role::servo, Occurs::every_tick, i, path + "/servo"});
    if (info.users[i].report_descriptor) channels.push_back({Role::reports, Occurs::when_reported, i, path + "/device_reports"});
    channels.push_back({Role::force, Occurs::every_tick, i, path + "/force"});
    channels.push_back({Role::server_force, Occurs::every_tick, i, path + "/server_force"});
    channels.push_back({Role::contact, Occurs::in_contact, i, path + "/contact"});
    if (!info.meshes.empty()) channels.push_back({Role::surface_contact, Occurs::in_contact, i, path + "/mesh_contact"});
  }
  const auto comes_every_tick = [](const TraceChannel& channel) { return channel.occurs == Occurs::every_tick; };
  if (!channels.empty() && std::none_of(channels.begin(), channels.end(), comes_every_tick))
    channels[info.objects.empty() ? 1 : 0].occurs = Occurs::every_tick;  // the ticks must show: pose, or displacement behind rest
  return channels;
}

}  // namespace tactus
