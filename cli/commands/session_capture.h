// SPDX-License-Identifier: Apache-2.0
/// The datagrams of simulated sessions in a capture file, as a tool at the network interface of one end would have caught them.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactus/net/pcap.h>
#include <tactus/sim/link/session_network.h>
#include "cli/output.h"

namespace tactus::cli {

/// Addresses are from the blocks for documentation (RFC 5737): the server is 192.0.2.1:7447, clients are 198.51.100.1 and on.
/// Time stamps are the server's clock, so that what datagrams say of it can be held against them.
class SessionCapture {
 public:
  enum class End : std::uint8_t { client, server };  ///< at whose interface
  struct Count {
    std::uint64_t datagrams = 0, bytes = 0;  ///< without the headers of UDP and IPv4
  };
  struct Client {
    Count up, down;  ///< as captured
  };

  /// err  as OutputFile::create; the file cannot be written
  static tl::expected<std::unique_ptr<SessionCapture>, Failure> create(const std::string& path, OutputFile::Existing existing,
                                                                       std::initializer_list<std::string> others, End end);
  /// To be called for every datagram.   post  the capture outlives it
  std::function<void(const sim::Sighting&)> observer();
  /// err  a datagram could not be written
  Outcome keep();

  static net::Ipv4Endpoint server() noexcept;
  static net::Ipv4Endpoint client(std::size_t user) noexcept;
  static std::string text_of(const net::Ipv4Endpoint& endpoint);  ///< "192.0.2.1:7447"
  Client count(std::size_t user) const { return user < clients_.size() ? clients_[user] : Client(); }

 private:
  SessionCapture(OutputFile file, net::PcapWriter writer, End end)
      : file_(std::move(file)), writer_(std::move(writer)), end_(end) {}
  void add(const sim::Sighting& sighting);

  OutputFile file_;
  net::PcapWriter writer_;
  End end_;
  std::optional<Error> error_;  // the first
  std::vector<Client> clients_;
};

}  // namespace tactus::cli
