// SPDX-License-Identifier: Apache-2.0
#include "cli/viewer/packet_log.h"

#include <fmt/format.h>

#include <utility>

#include <tactus/scene/scene_syntax.h>

namespace tactus::cli {

Result<PacketLog> PacketLog::create(const SharedScene& scene, const SenderOptions& options) {
  TACTUS_TRY(Sender sender, Sender::create(scene, options));
  TACTUS_TRY(Receiver receiver, Receiver::create(scene));
  return PacketLog(std::move(sender), std::move(receiver));
}

Result<void> PacketLog::add(std::int64_t tick, const Truth& truth) {
  TACTUS_TRY(const auto packets, sender_.encode(tick, truth));
  for (const Packet& packet : packets) {
    TACTUS_TRY(const DecodedPacket decoded, receiver_.push(packet.bytes));
    PlayedPacket placed;
    static_cast<DecodedPacket&>(placed) = decoded;
    placed.bytes = packet.bytes.size();
    placed.offset = bytes_.size();
    packets_.add(placed);
    bytes_.append(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
  }
  return {};
}

nlohmann::ordered_json PacketLog::hashes() const {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  const std::size_t substreams = scene().deformables.size() + (scene().loads ? 2U : 1U);
  for (std::size_t i = 0; i < substreams; ++i) out.push_back(fmt::format("{:016x}", sender_.state_hash(i)));
  return out;
}

nlohmann::ordered_json PacketLog::take() {
  nlohmann::ordered_json out{{"stream", base64(bytes_)}, {"packets", packets_.take()}};
  bytes_.clear();
  return out;
}

Result<std::string> declaration_of(const Scene& scene) {
  TACTUS_TRY(const auto bytes, write_scene(scene));
  return base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace tactus::cli
