// SPDX-License-Identifier: Apache-2.0
/// Which channels a trace has, in the order in which a tick's messages are written. Shared by writer and reader.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/trace/frame.h"
#include "codec/trace/schemas.h"

namespace tactus {

enum class Role : std::uint8_t { pose, twist, device, force, server_force, contact };
enum class Occurs : std::uint8_t { every_tick, first_tick, in_contact };

struct TraceChannel {
  Role role = Role::pose;
  Occurs occurs = Occurs::every_tick;
  std::uint32_t index = 0;  ///< of the object (pose, twist) or the user
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
    case Role::force:
    case Role::server_force:
      break;
  }
  return MessageType::vector;
}

inline std::vector<TraceChannel> trace_channels(const TraceInfo& info) {
  std::vector<TraceChannel> channels;
  for (std::uint32_t i = 0; i < info.objects.size(); ++i) {
    const std::string path = "/objects/" + info.objects[i].name;
    const bool moves = info.objects[i].dof != Dof::none;
    channels.push_back({Role::pose, moves ? Occurs::every_tick : Occurs::first_tick, i, path + "/pose"});
    if (moves) channels.push_back({Role::twist, Occurs::every_tick, i, path + "/twist"});
  }
  for (std::uint32_t i = 0; i < info.users.size(); ++i) {
    const std::string path = "/users/" + info.users[i];
    channels.push_back({Role::device, Occurs::every_tick, i, path + "/device"});
    channels.push_back({Role::force, Occurs::every_tick, i, path + "/force"});
    channels.push_back({Role::server_force, Occurs::every_tick, i, path + "/server_force"});
    channels.push_back({Role::contact, Occurs::in_contact, i, path + "/contact"});
  }
  const auto comes_every_tick = [](const TraceChannel& channel) { return channel.occurs == Occurs::every_tick; };
  if (!channels.empty() && std::none_of(channels.begin(), channels.end(), comes_every_tick))
    channels.front().occurs = Occurs::every_tick;  // the ticks must show somewhere
  return channels;
}

}  // namespace tactus
