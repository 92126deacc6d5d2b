// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/cookies.h>

#include <gnutls/crypto.h>

#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus::seal {
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
    if (found == GNUTLS_E_BAD_COOKIE) out.verdict = Verdict::unproven;
    if (found != 0) continue;
    out.verdict = Verdict::proven;
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

}  // namespace tactus::seal
