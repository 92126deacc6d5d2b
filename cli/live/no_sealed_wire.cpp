// SPDX-License-Identifier: Apache-2.0
/// In place of sealed_wire.cpp in a program that was built without the seal.
#include "cli/live/wire.h"

namespace tactus::cli {
namespace {

tl::unexpected<Failure> no_seal() { return refuse_arguments("--key: this program was built without the seal", how_to_seal()); }

}  // namespace

std::string how_to_seal() { return "Install libgnutls28-dev and build it with TACTUS_WITH_SEAL=ON."; }

tl::expected<std::unique_ptr<ServerWire>, Failure> sealed_wire_of_server(net::UdpSocket& /*socket*/, std::uint32_t /*clients*/,
                                                                         const std::string& /*key*/) {
  return no_seal();
}

tl::expected<std::unique_ptr<ClientWire>, Failure> sealed_wire_of_client(net::UdpSocket& /*socket*/, const std::string& /*key*/) {
  return no_seal();
}

}  // namespace tactus::cli
