// SPDX-License-Identifier: Apache-2.0
/// The packets of a motion as a page holds them: coded from the truth, and decoded as a client does that gets them all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include <tactus/receiver.h>
#include <tactus/sender.h>
#include "cli/viewer/packet_table.h"

namespace tactus::cli {

class PacketLog {
 public:
  /// err  of Sender::create, Receiver::create
  static Result<PacketLog> create(const SharedScene& scene, const SenderOptions& options);
  /// err  of Sender::encode, Receiver::push
  Result<void> add(std::int64_t tick, const Truth& truth);
  /// The next packet of every substream is a place to begin at.
  void request_key() noexcept { sender_.request_key(); }
  Replica& replica() noexcept { return receiver_.replica(); }
  const Scene& scene() const noexcept { return *sender_.scene(); }
  nlohmann::ordered_json hashes() const;  ///< of the substreams' states
  std::size_t bytes() const noexcept { return bytes_.size(); }
  /// The packets so far, as "stream" and "packets"; it begins anew.
  nlohmann::ordered_json take();

 private:
  PacketLog(Sender sender, Receiver receiver) : sender_(std::move(sender)), receiver_(std::move(receiver)) {}

  Sender sender_;
  Receiver receiver_;
  std::string bytes_;
  PacketTable packets_;
};

/// A scene's declaration in base64.   err  of write_scene
Result<std::string> declaration_of(const Scene& scene);

}  // namespace tactus::cli
