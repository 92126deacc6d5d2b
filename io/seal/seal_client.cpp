// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/seal_client.h>

#include <algorithm>
#include <array>

#include <tactus/base/rule.h>
#include <tactus/seal/association.h>

namespace tactus::seal {
namespace {

constexpr std::uint64_t kFirstRepeat = 250'000, kNextRepeat = 500'000;  // [us] after a flight was sent
constexpr unsigned kMostRepetitions = 6;                                // of a flight, then the handshake begins anew
constexpr std::uint64_t kTimeout = 10'000'000;                          // [us] for the whole handshake

}  // namespace

struct Client::Impl {
  Result<void> begin(std::uint64_t now) noexcept;
  void advance(std::uint64_t now, std::span<const std::uint8_t> wire) noexcept;
  void speak(std::uint64_t now, std::uint64_t wait) noexcept {
    is_to_send = true;
    repeat_at = now + wait;
  }

  std::unique_ptr<Context> context;
  std::unique_ptr<Association> link;
  std::uint64_t began = 0, repeat_at = 0;  // [us]
  unsigned repetitions = 0;
  bool is_to_send = false, has_cookie = false, was_answered = false, is_doubted = false, is_closed = false;
  std::span<const std::uint8_t> goodbye;
  std::array<std::uint8_t, kLargestSealed> opened{}, sealed{};
  Counters counters;
};

Client::Client(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<Client> Client::create(Key key, std::uint64_t now, const Limits& limits) try {
  auto impl = std::make_unique<Impl>();
  TACTUS_TRY(impl->context, Context::create(std::move(key), limits));
  impl->began = now;
  TACTUS_CHECK(impl->begin(now));
  return Client(std::move(impl));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

/// From the first message.
Result<void> Client::Impl::begin(std::uint64_t now) noexcept {
  TACTUS_TRY(link, Association::client(*context));
  repetitions = 0;
  has_cookie = false;
  if (link->advance({}) == Association::Stage::broken) return fail(Errc::internal, "R-SEA-6");
  speak(now, kFirstRepeat);
  return {};
}

void Client::Impl::advance(std::uint64_t now, std::span<const std::uint8_t> wire) noexcept {
  switch (link->advance(wire)) {
    case Association::Stage::open:
      ++counters.handshakes;
      is_to_send = link->has_spoken();
      break;
    case Association::Stage::broken:  // by what may be noise: begin anew, but not faster than the network can be blamed for
      is_to_send = false;
      repetitions = kMostRepetitions;
      repeat_at = now + kFirstRepeat;
      break;
    case Association::Stage::handshake:
      if (!link->has_spoken()) break;
      repetitions = 0;
      was_answered = was_answered || message_type(link->flight()) == kClientKeyExchange;
      speak(now, kFirstRepeat);
      break;
  }
}

bool Client::is_doubted() const noexcept { return impl_->is_doubted && !is_open(); }
bool Client::is_open() const noexcept { return impl_->link->stage() == Association::Stage::open; }

Result<std::optional<std::span<const std::uint8_t>>> Client::open(std::uint64_t now,
                                                                  std::span<const std::uint8_t> wire) noexcept {
  Impl& in = *impl_;
  if (in.is_closed) return std::nullopt;
  const auto head = read_head(wire);
  if (!head || wire.size() > kLargestSealed) {
    ++in.counters.strangers;
    return std::nullopt;
  }
  const bool is_handshake = head->content == Content::handshake || head->content == Content::change_cipher_spec;
  if (in.link->stage() != Association::Stage::open) {
    in.is_doubted = in.is_doubted || (in.was_answered && says_wrong_key(wire));  // it changes nothing else
    if (!is_handshake || in.link->stage() == Association::Stage::broken) return std::nullopt;
    if (!in.has_cookie && message_type(wire) != kHelloVerifyRequest) return std::nullopt;  // the server has sent nothing else yet
    in.has_cookie = true;
    in.advance(now, wire);
    return std::nullopt;
  }
  if (is_handshake) return std::nullopt;  // a late copy
  if (head->epoch != 1 || !head->is_alone) {
    ++in.counters.strangers;
    return std::nullopt;
  }
  const auto inside = in.link->open(*head, wire, in.opened);
  switch (inside.what) {
    case Association::Opened::plain:
      ++in.counters.opened;
      return inside.plain;
    case Association::Opened::replayed:
      ++in.counters.replayed;
      break;
    case Association::Opened::unauthentic:
      ++in.counters.unauthentic;
      break;
    case Association::Opened::nothing:
      break;
    case Association::Opened::used_up:
      in.is_closed = true;
      return fail(Errc::limit_exceeded, "R-SEA-4");
    case Association::Opened::closed:
      in.is_closed = true;
      return fail(Errc::state, "R-SEA-3");
    case Association::Opened::denied:
      in.is_closed = true;
      return fail(Errc::state, "R-SEA-7");
  }
  return std::nullopt;
}

Result<std::span<const std::uint8_t>> Client::seal(std::span<const std::uint8_t> plain) noexcept {
  Impl& in = *impl_;
  if (!is_open()) return fail(Errc::limit_exceeded, "R-SEA-5");
  const auto out = in.link->seal(plain, in.sealed);
  in.is_closed = !is_open();
  in.counters.sealed += out ? 1u : 0u;
  return out;
}

Result<void> Client::handle_timeout(std::uint64_t now) noexcept {
  Impl& in = *impl_;
  if (in.is_closed || is_open()) return {};
  if (now >= in.began + kTimeout) {
    in.is_closed = true;
    if (in.was_answered) return fail(Errc::state, "R-SEA-2");
    return fail(Errc::state, "R-SEA-1");
  }
  if (now < in.repeat_at) return {};
  if (in.repetitions == kMostRepetitions) return in.begin(now);
  ++in.repetitions;
  in.speak(now, kNextRepeat);
  return {};
}

void Client::close() noexcept {
  Impl& in = *impl_;
  if (is_open()) in.goodbye = in.link->close();
  in.is_to_send = false;
  in.is_closed = true;
}

std::optional<std::span<const std::uint8_t>> Client::poll_datagram() noexcept {
  Impl& in = *impl_;
  if (!in.goodbye.empty()) return std::exchange(in.goodbye, {});
  if (!std::exchange(in.is_to_send, false)) return std::nullopt;
  return in.link->flight();
}

std::optional<std::uint64_t> Client::next_timeout() const noexcept {
  const Impl& in = *impl_;
  if (in.is_closed || is_open()) return std::nullopt;
  return std::min(in.repeat_at, in.began + kTimeout);
}

Counters Client::counters() const noexcept { return impl_->counters; }

}  // namespace tactus::seal
