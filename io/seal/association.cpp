// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/association.h>

#include <gnutls/crypto.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include <tactus/base/rule.h>

namespace tactus::seal {

// ==== cookies ====

namespace {

constexpr std::uint64_t kRenewEvery = 30'000'000;  // [us]

gnutls_datum_t datum_of(std::span<std::uint8_t> bytes) { return {bytes.data(), static_cast<unsigned>(bytes.size())}; }

/// GnuTLS takes it as not constant, and leaves it as it is.
void* untouched(std::span<const std::uint8_t> bytes) { return const_cast<std::uint8_t*>(bytes.data()); }

}  // namespace

Result<Cookies> Cookies::create(std::uint64_t now) {
  Cookies out;
  out.renewed_ = now;
  for (Key* key : {&out.current_, &out.before_})
    if (gnutls_rnd(GNUTLS_RND_KEY, key->data(), key->size()) != 0) return fail(Errc::internal, "R-SEA-6");
  return out;
}

void Cookies::renew(std::uint64_t now) noexcept {
  for (int i = 0; i < 2 && now >= renewed_ + kRenewEvery; ++i) {  // twice if nobody came for long
    Key fresh{};
    if (gnutls_rnd(GNUTLS_RND_KEY, fresh.data(), fresh.size()) != 0) return;
    before_ = current_;
    current_ = fresh;
    renewed_ += kRenewEvery;
  }
  if (now >= renewed_ + kRenewEvery) renewed_ = now;
}

Cookies::Look Cookies::look(std::uint64_t now, std::span<const std::uint8_t> who, std::span<const std::uint8_t> wire) noexcept {
  renew(now);
  Look out;
  for (Key* key : {&current_, &before_}) {
    gnutls_datum_t datum = datum_of(*key);
    const int found = gnutls_dtls_cookie_verify(&datum, untouched(who), who.size(), untouched(wire), wire.size(), &out.state);
    if (found == GNUTLS_E_BAD_COOKIE) out.verdict = Verdict::unvalidated;
    if (found != 0) continue;
    out.verdict = Verdict::validated;
    break;
  }
  return out;
}

std::span<const std::uint8_t> Cookies::answer(std::span<const std::uint8_t> who) noexcept {
  const auto push = [](gnutls_transport_ptr_t self, const void* bytes, std::size_t size) -> ssize_t {
    auto& in = *static_cast<Cookies*>(self);
    in.answer_size_ = std::min(size, in.answer_.size());
    std::copy_n(static_cast<const std::uint8_t*>(bytes), in.answer_size_, in.answer_.begin());
    return static_cast<ssize_t>(size);
  };
  gnutls_datum_t key = datum_of(current_);
  gnutls_dtls_prestate_st state{};
  answer_size_ = 0;
  if (gnutls_dtls_cookie_send(&key, untouched(who), who.size(), &state, this, push) < 0) return {};
  return std::span<const std::uint8_t>(answer_).first(answer_size_);
}

// ==== association ====

namespace {

constexpr const char* kPriorities =
    "NORMAL:-VERS-ALL:+VERS-DTLS1.2:-KX-ALL:+ECDHE-PSK:-CIPHER-ALL:+CHACHA20-POLY1305:-GROUP-ALL:+GROUP-X25519:+GROUP-SECP256R1";
constexpr unsigned kNever = 24 * 3600 * 1000;  // [ms]; the time to repeat is above the whole time, so GnuTLS does neither
constexpr int kMostRecords = 16;               // of a datagram: GnuTLS returns after each that it drops

std::uint64_t read(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t out = 0;
  for (const std::uint8_t byte : bytes) out = out << 8 | byte;
  return out;
}

/// A copy that GnuTLS frees.
bool copy(std::span<const std::uint8_t> secret, gnutls_datum_t& out) noexcept {
  out.data = static_cast<unsigned char*>(gnutls_malloc(secret.size()));
  if (out.data == nullptr) return false;
  std::memcpy(out.data, secret.data(), secret.size());
  out.size = static_cast<unsigned>(secret.size());
  return true;
}

}  // namespace

std::optional<RecordHead> read_head(std::span<const std::uint8_t> wire) noexcept {
  if (wire.size() < kRecordHead || wire[0] < 20 || wire[0] > 23) return std::nullopt;
  if (wire[1] != 0xFE || (wire[2] != 0xFD && wire[2] != 0xFF)) return std::nullopt;
  const std::size_t end = kRecordHead + read(wire.subspan(11, 2));
  for (std::size_t at = end; at != wire.size(); at += kRecordHead + read(wire.subspan(at + 11, 2)))
    if (at > wire.size() || wire.size() - at < kRecordHead) return std::nullopt;
  return RecordHead{.content = static_cast<Content>(wire[0]),
                    .epoch = static_cast<std::uint16_t>(read(wire.subspan(3, 2))),
                    .number = read(wire.subspan(5, 6)),
                    .is_alone = end == wire.size()};
}

std::optional<std::uint8_t> message_type(std::span<const std::uint8_t> wire) noexcept {
  if (wire.size() < kRecordHead + kMessageHead) return std::nullopt;
  return wire[kRecordHead];
}

bool says_wrong_key(std::span<const std::uint8_t> wire) noexcept {
  constexpr std::uint8_t kFatal = 2;
  const auto head = read_head(wire);
  if (!head || head->content != Content::alert || head->epoch != 0 || wire.size() != kRecordHead + 2) return false;
  return wire[kRecordHead] == kFatal && (wire[kRecordHead + 1] == kDecryptError || wire[kRecordHead + 1] == kUnknownIdentity);
}

Result<std::unique_ptr<Context>> Context::create(KeyList keys, const Limits& limits) try {
  TACTUS_TRY(Key decoy, Key::generate("nobody"));
  std::unique_ptr<Context> out(new Context(std::move(keys), std::move(decoy), limits));
  if (gnutls_priority_init(&out->priority_, kPriorities, nullptr) != 0 ||
      gnutls_psk_allocate_client_credentials(&out->client_) != 0 || gnutls_psk_allocate_server_credentials(&out->server_) != 0)
    return fail(Errc::internal, "R-SEA-6");
  gnutls_psk_set_client_credentials_function(out->client_, Association::give_client_key);
  gnutls_psk_set_server_credentials_function(out->server_, Association::give_server_key);
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Context::~Context() {
  if (server_ != nullptr) gnutls_psk_free_server_credentials(server_);
  if (client_ != nullptr) gnutls_psk_free_client_credentials(client_);
  if (priority_ != nullptr) gnutls_priority_deinit(priority_);
}

Result<std::unique_ptr<Association>> Association::create(const Context& context, unsigned flags, int credentials, void* of) try {
  std::unique_ptr<Association> out(new Association(context));
  if (gnutls_init(&out->session_, flags | GNUTLS_DATAGRAM | GNUTLS_NONBLOCK | GNUTLS_NO_SIGNAL | GNUTLS_NO_TICKETS) != 0 ||
      gnutls_priority_set(out->session_, context.priority_) != 0 ||
      gnutls_credentials_set(out->session_, static_cast<gnutls_credentials_type_t>(credentials), of) != 0)
    return fail(Errc::internal, "R-SEA-6");
  gnutls_session_set_ptr(out->session_, out.get());
  gnutls_transport_set_ptr(out->session_, out.get());
  gnutls_transport_set_push_function(out->session_, push);
  gnutls_transport_set_pull_function(out->session_, pull);
  gnutls_transport_set_pull_timeout_function(out->session_, wait);
  gnutls_dtls_set_mtu(out->session_, kLargestSealed);
  gnutls_dtls_set_timeouts(out->session_, kNever, kNever);
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<std::unique_ptr<Association>> Association::client(const Context& context) {
  return create(context, GNUTLS_CLIENT, GNUTLS_CRD_PSK, context.client_);
}

Result<std::unique_ptr<Association>> Association::server(const Context& context, gnutls_dtls_prestate_st cookie) {
  TACTUS_TRY(auto out, create(context, GNUTLS_SERVER, GNUTLS_CRD_PSK, context.server_));
  gnutls_dtls_prestate_set(out->session_, &cookie);
  return out;
}

Association::~Association() {
  if (session_ != nullptr) gnutls_deinit(session_);
}

int Association::give_client_key(gnutls_session_t session, char** name, gnutls_datum_t* secret) noexcept {
  const auto& in = *static_cast<const Association*>(gnutls_session_get_ptr(session));
  const Key& key = *in.context_.keys_.users().front().key;
  *name = static_cast<char*>(gnutls_calloc(1, key.name().size() + 1));
  if (*name == nullptr) return GNUTLS_E_MEMORY_ERROR;
  std::copy(key.name().begin(), key.name().end(), *name);
  return copy(key.secret(), *secret) ? 0 : GNUTLS_E_MEMORY_ERROR;
}

int Association::give_server_key(gnutls_session_t session, const char* name, gnutls_datum_t* secret) noexcept {
  auto& in = *static_cast<Association*>(gnutls_session_get_ptr(session));
  const KeyList::User* const user = in.context_.keys_.find(name);
  in.was_asked_ = true;
  if (user != nullptr) in.key_ = user->key;
  return copy((user != nullptr ? *user->key : in.context_.decoy_).secret(), *secret) ? 0 : GNUTLS_E_MEMORY_ERROR;
}

ssize_t Association::push(gnutls_transport_ptr_t self, const void* bytes, std::size_t size) noexcept {
  auto& in = *static_cast<Association*>(self);
  const auto* from = static_cast<const std::uint8_t*>(bytes);
  if (!in.outbox_.empty()) {
    in.sealed_size_ = std::min(size, in.outbox_.size());
    std::copy_n(from, in.sealed_size_, in.outbox_.begin());
    return static_cast<ssize_t>(size);
  }
  if (!in.has_spoken_) in.flight_.clear();
  in.has_spoken_ = true;
  try {
    if (in.flight_.size() + size > kLargestSealed) in.failed_to_speak_ = true;  // no flight of this suite is a quarter as long
    else in.flight_.insert(in.flight_.end(), from, from + size);
  } catch (const std::bad_alloc&) {
    in.failed_to_speak_ = true;
  }
  return static_cast<ssize_t>(size);
}

ssize_t Association::pull(gnutls_transport_ptr_t self, void* bytes, std::size_t size) noexcept {
  auto& in = *static_cast<Association*>(self);
  if (in.inbox_.empty()) {
    gnutls_transport_set_errno(in.session_, EAGAIN);
    return -1;
  }
  const std::size_t taken = std::min(size, in.inbox_.size());
  std::copy_n(in.inbox_.begin(), taken, static_cast<std::uint8_t*>(bytes));
  in.inbox_ = {};
  return static_cast<ssize_t>(taken);
}

int Association::wait(gnutls_transport_ptr_t self, unsigned /*milliseconds*/) noexcept {
  return static_cast<const Association*>(self)->inbox_.empty() ? 0 : 1;
}

Association::Stage Association::advance(std::span<const std::uint8_t> wire) noexcept {
  inbox_ = wire;
  has_spoken_ = false;
  for (int i = 0; i < kMostRecords && stage_ == Stage::handshake; ++i) {
    const int done = gnutls_handshake(session_);
    if (done == GNUTLS_E_SUCCESS) stage_ = Stage::open;
    else if (gnutls_error_is_fatal(done) != 0) stage_ = Stage::broken;
    else if (wire.empty()) break;
  }
  inbox_ = {};
  if (failed_to_speak_) stage_ = Stage::broken;
  note_records(wire);
  return stage_;
}

/// GnuTLS drops what is not authentic without a word. A client that has the key is open by the first of its sealed records.
void Association::note_records(std::span<const std::uint8_t> wire) noexcept {
  is_key_wrong_ = false;
  if (!was_asked_ || stage_ != Stage::handshake || !read_head(wire)) return;
  for (; !wire.empty(); wire = wire.subspan(kRecordHead + read(wire.subspan(11, 2)))) {
    was_changed_ = was_changed_ || wire[0] == static_cast<std::uint8_t>(Content::change_cipher_spec);
    is_key_wrong_ = is_key_wrong_ || (was_changed_ && read(wire.subspan(3, 2)) == 1);
  }
}

Result<std::span<const std::uint8_t>> Association::seal(std::span<const std::uint8_t> plain,
                                                        std::span<std::uint8_t> out) noexcept {
  if (plain.empty() || plain.size() > kLargestPlain) return fail(Errc::limit_exceeded, "R-SEA-5");
  if (sealed_ >= context_.limits_.sealed) {
    stage_ = Stage::broken;
    return fail(Errc::limit_exceeded, "R-SEA-4");
  }
  ++sealed_;
  outbox_ = out;
  sealed_size_ = 0;
  const ssize_t sent = gnutls_record_send(session_, plain.data(), plain.size());
  outbox_ = {};
  if (sent != static_cast<ssize_t>(plain.size()) || sealed_size_ != plain.size() + kOverhead) {
    stage_ = Stage::broken;
    return fail(Errc::internal, "R-SEA-6");
  }
  return out.first(sealed_size_);
}

bool Association::was_heard(std::uint64_t number) const noexcept {
  if (number > newest_) return false;
  const std::uint64_t back = newest_ - number;
  return back >= 64 || (window_ >> back & 1) != 0;
}

void Association::note_heard(std::uint64_t number) noexcept {
  if (number > newest_) {
    const std::uint64_t ahead = number - newest_;
    window_ = ahead >= 64 ? 0 : window_ << ahead;
    newest_ = number;
  }
  if (newest_ - number < 64) window_ |= std::uint64_t{1} << (newest_ - number);
}

Association::Inside Association::open(const RecordHead& head, std::span<const std::uint8_t> wire,
                                      std::span<std::uint8_t> out) noexcept {
  const bool is_old = was_heard(head.number);
  inbox_ = wire;
  has_spoken_ = true;  // what GnuTLS may send now is no flight of the handshake
  const std::size_t before = flight_.size();
  ssize_t size = GNUTLS_E_AGAIN;  // first GnuTLS drops what it still has of damaged datagrams of the handshake
  for (int i = 0; i < kMostRecords && !inbox_.empty() && (size == GNUTLS_E_AGAIN || size == GNUTLS_E_INTERRUPTED); ++i)
    size = gnutls_record_recv(session_, out.data(), out.size());
  inbox_ = {};
  flight_.resize(std::min(before, flight_.size()));
  if (size > 0 || (size == 0 && head.content == Content::alert)) note_heard(head.number);
  if (size > 0) return {Opened::plain, out.first(static_cast<std::size_t>(size))};
  if (size == 0 && head.content == Content::alert) {
    stage_ = Stage::broken;
    return {Opened::closed, {}};
  }
  if (size == GNUTLS_E_AGAIN || size == GNUTLS_E_INTERRUPTED) {
    if (is_old) return {Opened::replayed, {}};
    if (++unauthentic_ < context_.limits_.dropped) return {Opened::unauthentic, {}};
    stage_ = Stage::broken;
    return {Opened::used_up, {}};
  }
  if (gnutls_error_is_fatal(static_cast<int>(size)) == 0)
    return {};  // it wants to begin anew, or warns: authentic, and of no use
  stage_ = Stage::broken;
  const bool is_denied = size == GNUTLS_E_FATAL_ALERT_RECEIVED && gnutls_alert_get(session_) == kAccessDenied;
  return {is_denied ? Opened::denied : Opened::closed, {}};
}

std::span<const std::uint8_t> Association::alert(std::uint8_t what, std::span<std::uint8_t> out) noexcept {
  outbox_ = out;
  sealed_size_ = 0;
  const int done = gnutls_alert_send(session_, GNUTLS_AL_FATAL, static_cast<gnutls_alert_description_t>(what));
  outbox_ = {};
  return out.first(done == 0 ? sealed_size_ : 0);
}

std::span<const std::uint8_t> Association::close() noexcept {
  has_spoken_ = false;
  gnutls_bye(session_, GNUTLS_SHUT_WR);
  stage_ = Stage::broken;
  return has_spoken_ ? flight() : std::span<const std::uint8_t>();
}

}  // namespace tactus::seal
