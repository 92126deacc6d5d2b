// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <tactus/seal/seal_client.h>
#include <tactus/seal/seal_server.h>
#include "cli/live/ticker.h"
#include "cli/live/wire.h"

namespace tactus::cli {
namespace {

constexpr int kMost = 100;  // datagrams that are nothing for the session: a tick must not wait for a flood to end

class SealedServerWire final : public ServerWire {
 public:
  SealedServerWire(net::UdpSocket& socket, seal::Server server) : socket_(socket), server_(std::move(server)) {}

  std::optional<Heard> receive(std::uint64_t now) override {
    for (int i = 0; i < kMost; ++i) {
      const auto received = socket_.receive(buffer_);
      if (!received) return std::nullopt;
      const auto opened = server_.open(now, received->from, received->bytes);
      flush();
      if (opened) return Heard{opened->peer, opened->plain};
    }
    return std::nullopt;
  }
  void settle(const HasSession& /*has_session*/) override {}
  void send(std::uint64_t peer, std::span<const std::uint8_t> bytes) override {
    if (const auto sealed = server_.seal(peer, bytes)) socket_.send(sealed->to, sealed->bytes);
  }
  std::string address_of(std::uint64_t peer) const override { return server_.address_of(peer).text(); }
  void tick(std::uint64_t now, const HasSession& has_session) override {
    server_.work(now);
    if (++ticks_ % kTicksToLook == 0) server_.keep_only(now, has_session);
    flush();
  }
  std::optional<std::uint64_t> poll_closed() override { return server_.poll_closed(); }
  void close() override {
    server_.close();
    flush();
  }
  std::optional<SealUse> seal() const override { return SealUse{seal::kOverhead, server_.counters()}; }

 private:
  static constexpr std::uint64_t kTicksToLook = 1000;

  void flush() {
    while (const auto datagram = server_.poll_datagram()) socket_.send(datagram->to, datagram->bytes);
  }

  net::UdpSocket& socket_;
  seal::Server server_;
  std::uint64_t ticks_ = 0;
  std::array<std::uint8_t, 2048> buffer_{};
};

class SealedClientWire final : public ClientWire {
 public:
  SealedClientWire(net::UdpSocket& socket, std::string key, seal::Client client)
      : socket_(socket), key_(std::move(key)), client_(std::move(client)) {
    flush();
  }

  Result<std::optional<std::span<const std::uint8_t>>> receive(std::uint64_t now) override {
    for (int i = 0; i < kMost; ++i) {
      const auto received = socket_.receive(buffer_);
      if (!received) break;
      const auto opened = client_.open(now, received->bytes);
      flush();
      if (!opened && !renews_) return tl::unexpected(opened.error());
      if (opened && *opened) return *opened;
    }
    return std::nullopt;
  }
  Result<void> handle_timeout(std::uint64_t now) override {
    const auto done = client_.handle_timeout(now);
    flush();
    renews_ = renews_ && !client_.is_open();
    return renews_ ? Result<void>() : done;  // the session knows how long to wait
  }
  /// A new handshake. The key may have gone meanwhile; then what there is goes on.
  void renew(std::uint64_t now) override {
    auto key = seal::Key::read(key_);
    if (!key) return;
    auto client = seal::Client::create(std::move(*key), now);
    if (!client) return;
    client_ = std::move(*client);
    renews_ = true;
    flush();
  }
  void send(std::span<const std::uint8_t> bytes) override {
    if (const auto sealed = client_.seal(bytes)) socket_.send(*sealed);
  }
  bool is_open() const override { return client_.is_open(); }
  std::optional<std::uint64_t> next_timeout() const override { return client_.next_timeout(); }
  void close() override {
    client_.close();
    flush();
  }
  std::optional<SealUse> seal() const override { return SealUse{seal::kOverhead, client_.counters()}; }

 private:
  void flush() {
    while (const auto datagram = client_.poll_datagram()) socket_.send(*datagram);
  }

  net::UdpSocket& socket_;
  std::string key_;  // path of its file
  seal::Client client_;
  bool renews_ = false;  // there was another association before
  std::array<std::uint8_t, 2048> buffer_{};
};

tl::expected<seal::Key, Failure> read_key(const std::string& path) {
  auto key = seal::Key::read(path);
  if (key) return std::move(*key);
  if (key.error().error.code == Errc::io) return refuse(path, key.error().error);  // with the system's reason
  return refuse(key.error());
}

}  // namespace

std::string how_to_seal() { return "Make a key with `tactus key`, and give it to both ends."; }

tl::expected<std::unique_ptr<ServerWire>, Failure> sealed_wire_of_server(net::UdpSocket& socket, std::uint32_t clients,
                                                                         const std::string& key) {
  TACTUS_TRY(auto read, read_key(key));
  // Room for clients that come while others, whom the server did not notice leaving, are still there.
  auto server = seal::Server::create(std::move(read), microseconds_now(), {.peers = 2 * std::size_t{clients} + 8});
  if (!server) return refuse(key, server.error());
  return std::make_unique<SealedServerWire>(socket, std::move(*server));
}

tl::expected<std::unique_ptr<ClientWire>, Failure> sealed_wire_of_client(net::UdpSocket& socket, const std::string& key) {
  TACTUS_TRY(auto read, read_key(key));
  auto client = seal::Client::create(std::move(read), microseconds_now());
  if (!client) return refuse(key, client.error());
  return std::make_unique<SealedClientWire>(socket, key, std::move(*client));
}

}  // namespace tactus::cli
