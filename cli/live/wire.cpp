// SPDX-License-Identifier: Apache-2.0
#include "cli/live/wire.h"

#include <algorithm>
#include <array>

#include "cli/live/live_report.h"

namespace tactus::cli {

// ==== peers ====

bool Peers::permits(std::uint64_t now, const net::Address& from, std::size_t bytes) {
  const auto known = std::ranges::find(known_, from, &Known::at);
  const bool permitted =
      known != known_.end() ? known->limit.take(now, bytes, net::kClientRate) : strangers_.take(now, from, bytes);
  limited_ += permitted ? 0u : 1u;
  return permitted;
}

std::uint64_t Peers::limited_of(std::uint64_t peer) const {
  const auto known = std::ranges::find(known_, peer, [](const Known& one) { return one.at.key(); });
  return known == known_.end() ? 0 : known->limit.dropped();
}

std::uint64_t Peers::name(const net::Address& from) {
  newest_ = from;
  return from.key();
}

void Peers::settle(const HasSession& has_session) {
  if (!has_session(newest_.key()) || std::ranges::find(known_, newest_, &Known::at) != known_.end()) return;
  if (known_.size() == most_) std::erase_if(known_, [&](const Known& known) { return !has_session(known.at.key()); });
  if (known_.size() < most_) known_.push_back({newest_});
}

const net::Address* Peers::find(std::uint64_t peer) const {
  const auto found = std::ranges::find(known_, peer, [](const Known& known) { return known.at.key(); });
  if (found != known_.end()) return &found->at;
  return newest_.key() == peer ? &newest_ : nullptr;
}

// ==== plain wire ====

namespace {

constexpr int kMostDropped = 1000;  // datagrams at a time: a tick must not wait for a flood to end

class PlainServerWire final : public ServerWire {
 public:
  PlainServerWire(net::UdpSocket& socket, std::uint32_t clients) : socket_(socket), peers_(clients, system_entropy()) {}

  std::optional<Heard> receive(std::uint64_t now) override {
    for (int i = 0; i < kMostDropped; ++i) {
      const auto received = socket_.receive(buffer_);
      if (!received) return std::nullopt;
      if (peers_.permits(now, received->from, received->bytes.size())) return Heard{peers_.name(received->from), received->bytes};
    }
    return std::nullopt;
  }
  void settle(const HasSession& has_session) override { peers_.settle(has_session); }
  void send(std::uint64_t peer, std::span<const std::uint8_t> bytes) override {
    if (const net::Address* to = peers_.find(peer)) socket_.send(*to, bytes);
  }
  std::string address_of(std::uint64_t peer) const override {
    const net::Address* const at = peers_.find(peer);
    return (at != nullptr ? *at : net::Address()).text();
  }
  std::optional<WireUser> user_of(std::uint64_t /*peer*/) const override { return std::nullopt; }
  std::optional<KeyNews> look_at_keys(std::uint64_t /*now*/, bool /*at_once*/) override { return std::nullopt; }
  void tick(std::uint64_t /*now*/, const HasSession& /*has_session*/) override {}
  std::optional<std::uint64_t> poll_closed() override { return std::nullopt; }
  void close() override {}
  std::uint64_t limited() const override { return peers_.limited(); }
  std::uint64_t limited_of(std::uint64_t peer) const override { return peers_.limited_of(peer); }
  std::optional<SealUse> seal() const override { return std::nullopt; }

 private:
  net::UdpSocket& socket_;
  Peers peers_;
  std::array<std::uint8_t, 2048> buffer_{};
};

class PlainClientWire final : public ClientWire {
 public:
  explicit PlainClientWire(net::UdpSocket& socket) : socket_(socket) {}

  Result<std::optional<std::span<const std::uint8_t>>> receive(std::uint64_t /*now*/) override {
    const auto received = socket_.receive(buffer_);
    if (!received) return std::nullopt;
    return received->bytes;
  }
  Result<void> handle_timeout(std::uint64_t /*now*/) override { return {}; }
  void send(std::span<const std::uint8_t> bytes) override { socket_.send(bytes); }
  void renew(std::uint64_t /*now*/) override {}
  bool is_open() const override { return true; }
  bool is_doubted() const override { return false; }
  std::optional<std::uint64_t> next_timeout() const override { return std::nullopt; }
  void close() override {}
  std::optional<SealUse> seal() const override { return std::nullopt; }

 private:
  net::UdpSocket& socket_;
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace

std::unique_ptr<ServerWire> plain_wire_of_server(net::UdpSocket& socket, std::uint32_t clients) {
  return std::make_unique<PlainServerWire>(socket, clients);
}

std::unique_ptr<ClientWire> plain_wire_of_client(net::UdpSocket& socket) { return std::make_unique<PlainClientWire>(socket); }

}  // namespace tactus::cli
