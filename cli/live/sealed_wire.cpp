// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include <tactus/base/shown.h>
#include <tactus/seal/seal_client.h>
#include <tactus/seal/seal_server.h>
#include "cli/live/ticker.h"
#include "cli/live/wire.h"

namespace tactus::cli {
namespace {

constexpr int kMost = 100;  // datagrams that are nothing for the session: a tick must not wait for a flood to end

std::string names(const std::vector<std::string>& list) {
  constexpr std::size_t kMostNamed = 5;
  std::string out;
  for (std::size_t i = 0; i < std::min(list.size(), kMostNamed); ++i) out += (i > 0 ? ", " : "") + list[i];
  return list.size() > kMostNamed ? fmt::format("{} and {} more", out, list.size() - kMostNamed) : out;
}

tl::unexpected<Failure> refuse_keys(const std::string& path, const Diagnostic& error) {
  if (error.error.code == Errc::io) return refuse(path, error.error);  // with the system's reason
  return refuse(error);
}

/// "3 users: new: anna, eve; removed: bob; another key: carl; may only look on now: dora".
std::string difference(const seal::KeyList& before, const seal::KeyList& after) {
  std::vector<std::string> fresh, gone, other, observe, touch;
  for (const seal::KeyList::User& user : before.users())
    if (after.find(user.name()) == nullptr) gone.emplace_back(user.name());
  for (const seal::KeyList::User& user : after.users()) {
    const seal::KeyList::User* const old = before.find(user.name());
    if (old == nullptr) fresh.emplace_back(user.name());
    else if (*old->key != *user.key) other.emplace_back(user.name());
    else if (old->role != user.role) (user.role == seal::Role::touch ? touch : observe).emplace_back(user.name());
  }
  std::string out = fmt::format("{} {}", after.users().size(), after.users().size() == 1 ? "user" : "users");
  const char* separator = ": ";
  const auto add = [&](const std::vector<std::string>& list, const char* what) {
    if (list.empty()) return;
    out += fmt::format("{}{}: {}", std::exchange(separator, "; "), what, names(list));
  };
  add(fresh, "new");
  add(gone, "removed");
  add(other, "another key");
  add(observe, "may only look on now");
  add(touch, "may touch now");
  return out;
}

class SealedServerWire final : public ServerWire {
 public:
  SealedServerWire(net::UdpSocket& socket, std::string path, seal::KeyListFile keys, seal::Server server)
      : socket_(socket), path_(std::move(path)), keys_(std::move(keys)), server_(std::move(server)) {}

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
  std::optional<WireUser> user_of(std::uint64_t peer) const override {
    const seal::KeyList::User* const user = server_.user_of(peer);
    if (user == nullptr) return std::nullopt;
    return WireUser{std::string(user->name()), user->role == seal::Role::touch};
  }
  std::optional<KeyNews> look_at_keys(std::uint64_t now, bool at_once) override {
    constexpr std::uint64_t kEvery = 1'000'000;  // [us]
    if (!at_once && now < looked_at_ + kEvery) return std::nullopt;
    looked_at_ = now;
    const seal::KeyList before = keys_.keys();
    const auto is_new = at_once ? keys_.read_again() : keys_.look();
    if (!is_new) return KeyNews{"keeps the keys before: " + refuse_keys(path_, is_new.error()).value().text, true, {}};
    if (!*is_new) return std::nullopt;
    KeyNews news{shown_path(path_) + ": " + difference(before, keys_.keys()), false, {}};
    news.removed = server_.replace(keys_.keys());
    flush();
    return news;
  }
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
  std::uint64_t limited() const override { return server_.counters().limited; }
  std::uint64_t limited_of(std::uint64_t peer) const override { return server_.limited_of(peer); }
  std::optional<SealUse> seal() const override { return SealUse{seal::kOverhead, server_.counters(), {}}; }

 private:
  static constexpr std::uint64_t kTicksToLook = 1000;

  void flush() {
    while (const auto datagram = server_.poll_datagram()) socket_.send(datagram->to, datagram->bytes);
  }

  net::UdpSocket& socket_;
  std::string path_;
  seal::KeyListFile keys_;
  std::uint64_t looked_at_ = 0;
  seal::Server server_;
  std::uint64_t ticks_ = 0;
  std::array<std::uint8_t, 2048> buffer_{};
};

class SealedClientWire final : public ClientWire {
 public:
  SealedClientWire(net::UdpSocket& socket, std::string key, std::string user, seal::Client client)
      : socket_(socket), key_(std::move(key)), user_(std::move(user)), client_(std::move(client)) {
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
  bool is_doubted() const override { return client_.is_doubted(); }
  std::optional<std::uint64_t> next_timeout() const override { return client_.next_timeout(); }
  void close() override {
    client_.close();
    flush();
  }
  std::optional<SealUse> seal() const override { return SealUse{seal::kOverhead, client_.counters(), user_}; }

 private:
  void flush() {
    while (const auto datagram = client_.poll_datagram()) socket_.send(*datagram);
  }

  net::UdpSocket& socket_;
  std::string key_, user_;  // path of its file, and its name
  seal::Client client_;
  bool renews_ = false;  // there was another association before
  std::array<std::uint8_t, 2048> buffer_{};
};

}  // namespace

std::string how_to_seal() { return "Make a key with `tactus key`, and give it to both ends."; }

tl::expected<std::unique_ptr<ServerWire>, Failure> sealed_wire_of_server(net::UdpSocket& socket, std::uint32_t clients,
                                                                         const std::string& key) {
  auto keys = seal::KeyListFile::open(key);
  if (!keys) return refuse_keys(key, keys.error());
  // Room for clients that come while others, whom the server did not notice leaving, are still there.
  auto server = seal::Server::create(keys->keys(), microseconds_now(), {.peers = 2 * std::size_t{clients} + 8});
  if (!server) return refuse(key, server.error());
  return std::make_unique<SealedServerWire>(socket, key, std::move(*keys), std::move(*server));
}

tl::expected<std::unique_ptr<ClientWire>, Failure> sealed_wire_of_client(net::UdpSocket& socket, const std::string& key) {
  auto read = seal::Key::read(key);
  if (!read) return refuse_keys(key, read.error());
  std::string user(read->name());
  auto client = seal::Client::create(std::move(*read), microseconds_now());
  if (!client) return refuse(key, client.error());
  return std::make_unique<SealedClientWire>(socket, key, std::move(user), std::move(*client));
}

}  // namespace tactus::cli
