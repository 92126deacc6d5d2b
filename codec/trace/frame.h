// SPDX-License-Identifier: Apache-2.0
/// What truly happened at one tick, in SI units. Uncompressed; the unit of a trace.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/rigid/contact.h"
#include "codec/rigid/rigid.h"

namespace tactus {

/// What a trace's channels describe. Everything a scene lacks has no channel.
struct TraceObject {
  std::string name;
  std::uint8_t dof = Dof::all;
};

struct TraceInfo {
  std::uint32_t tick_rate = 1000;  ///< ticks per second
  std::vector<TraceObject> objects;
  std::vector<std::string> users;  ///< empty: a recording without touch
  std::string source;              ///< "sim push-1dof seed 1", "import cube-tosses.csv"
  std::string scene;               ///< scene file (TOML) attached to the trace; may be empty
};

/// One user at one tick.
struct UserSample {
  Contact contact;    ///< contact.device is always the probe's position, even without contact
  Vec3 force;         ///< [N] rendered at the client, what the hand felt
  Vec3 server_force;  ///< [N] rendered at the server from the true state, same device sample
};

struct TraceFrame {
  std::int64_t tick = 0;
  std::vector<RigidSample> objects;  ///< order of TraceInfo::objects
  std::vector<UserSample> users;     ///< order of TraceInfo::users
};

}  // namespace tactus
