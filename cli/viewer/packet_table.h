// SPDX-License-Identifier: Apache-2.0
/// Packets in their order: where they are, and why they were sent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>

#include <tactus/player.h>
#include "cli/viewer/columns.h"

namespace tactus::cli {

class PacketTable {
 public:
  void add(const PlayedPacket& packet) {
    Reason reason = Reason::request;
    for (const RigidUpdate& update : packet.updates) reason = std::max(reason, update.reason);
    ticks_.add(packet.tick);
    offsets_.add(static_cast<std::int64_t>(packet.offset));
    sizes_.add(static_cast<std::int64_t>(packet.bytes));
    substreams_.add(static_cast<std::int64_t>(packet.substream));
    keys_.add(packet.key ? 1 : 0);
    reasons_.add(static_cast<std::int64_t>(reason));
    updates_.add(static_cast<std::int64_t>(packet.updates.size() + packet.loads + packet.vertices));
    last_ = packet.tick;
  }
  std::int64_t last_tick() const noexcept { return last_; }
  /// The packets so far; it begins anew.
  nlohmann::ordered_json take() {
    return {{"ticks", ticks_.take()},           {"offsets", offsets_.take()}, {"sizes", sizes_.take()},
            {"substreams", substreams_.take()}, {"keys", keys_.take()},       {"reasons", reasons_.take()},
            {"updates", updates_.take()}};
  }

 private:
  Column ticks_{1}, offsets_{1}, sizes_{1}, substreams_{1}, keys_{1}, reasons_{1}, updates_{1};
  std::int64_t last_ = 0;
};

}  // namespace tactus::cli
