// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/session_capture.h"

#include <fmt/format.h>

#include <utility>

namespace tactus::cli {

using CapturePoint = sim::Sighting::CapturePoint;

tl::expected<std::unique_ptr<SessionCapture>, Failure> SessionCapture::create(const std::string& path,
                                                                              OutputFile::Existing existing,
                                                                              std::initializer_list<std::string> others,
                                                                              End end) {
  TACTUS_TRY(auto file, OutputFile::create(path, existing, others));
  TACTUS_TRY(std::ostream* const out, file.open());
  auto writer = net::PcapWriter::create(*out);
  if (!writer) return refuse(path, writer.error());
  return std::unique_ptr<SessionCapture>(new SessionCapture(std::move(file), std::move(*writer), end));
}

net::Ipv4Endpoint SessionCapture::server() noexcept { return {{192, 0, 2, 1}, 7447}; }

net::Ipv4Endpoint SessionCapture::client(std::size_t user) noexcept {
  constexpr std::size_t kHosts = 254, kFirstPort = 49152, kPorts = 65536 - kFirstPort;  // RFC 6335: ports that nobody registers
  return {{198, 51, 100, static_cast<std::uint8_t>(1 + user % kHosts)},
          static_cast<std::uint16_t>(kFirstPort + user / kHosts % kPorts)};
}

std::string SessionCapture::text_of(const net::Ipv4Endpoint& endpoint) {
  return fmt::format("{}:{}", fmt::join(endpoint.host, "."), endpoint.port);
}

std::function<void(const sim::Sighting&)> SessionCapture::observer() {
  return [this](const sim::Sighting& sighting) { add(sighting); };
}

void SessionCapture::add(const sim::Sighting& sighting) {
  const bool at_client = sighting.point == CapturePoint::client_sends || sighting.point == CapturePoint::client_hears;
  if (error_ || at_client != (end_ == End::client)) return;
  const bool up = sighting.point == CapturePoint::client_sends || sighting.point == CapturePoint::server_hears;
  const net::Ipv4Endpoint from = client(sighting.user), to = server();
  const auto added = writer_.add(sighting.time, up ? from : to, up ? to : from, sighting.datagram);
  if (!added) {
    error_ = added.error();
    return;
  }
  if (sighting.user >= clients_.size()) clients_.resize(sighting.user + 1);
  Count& count = up ? clients_[sighting.user].up : clients_[sighting.user].down;
  ++count.datagrams;
  count.bytes += sighting.datagram.size();
}

Outcome SessionCapture::keep() {
  if (error_) return refuse(file_.path(), *error_);
  return file_.keep();
}

}  // namespace tactus::cli
