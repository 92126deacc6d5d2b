// SPDX-License-Identifier: Apache-2.0
/// Cookies by which an address proves itself, without any memory of it. spec/70-session.md section 11.3. Internal to the library.
#pragma once

#include <gnutls/dtls.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/base/result.h>

namespace tactus::seal {

class Cookies {
 public:
  /// err  internal R-SEA-6: the system has no random bits
  static Result<Cookies> create(std::uint64_t now);

  enum class Verdict { proven, unproven, no_hello };
  struct Look {
    Verdict verdict = Verdict::no_hello;
    gnutls_dtls_prestate_st state{};  ///< for the association, if proven
  };
  /// in   who  bytes of the sender's address;  wire  a datagram that begins with a ClientHello
  Look look(std::uint64_t now, std::span<const std::uint8_t> who, std::span<const std::uint8_t> wire) noexcept;
  /// A HelloVerifyRequest; empty: GnuTLS refuses.   out  valid until the next call
  std::span<const std::uint8_t> answer(std::span<const std::uint8_t> who) noexcept;

 private:
  using Key = std::array<std::uint8_t, GNUTLS_COOKIE_KEY_SIZE>;
  void renew(std::uint64_t now) noexcept;

  Key current_{}, before_{};
  std::uint64_t renewed_ = 0;  // [us]
  std::array<std::uint8_t, 64> answer_{};
  std::size_t answer_size_ = 0;
};

}  // namespace tactus::seal
