// SPDX-License-Identifier: Apache-2.0
/// One DTLS association, and the cookies that validate an address. Internal to the library.
#pragma once

#include <gnutls/dtls.h>
#include <gnutls/gnutls.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/seal/key_list.h>

namespace tactus::seal {

// ==== cookies ====
// Cookies that validate an address, without any memory of it. spec/70-session.md section 11.3.

class Cookies {
 public:
  /// err  internal R-SEA-6: the system has no random bits
  static Result<Cookies> create(std::uint64_t now);

  enum class Verdict { validated, unvalidated, no_hello };
  struct Look {
    Verdict verdict = Verdict::no_hello;
    gnutls_dtls_prestate_st state{};  ///< for the association, if validated
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

// ==== association ====
// One DTLS association: datagrams in, datagrams out, without socket and clock. spec/70-session.md section 11.
//
// GnuTLS never repeats a flight here, as its timers know the machine's clock only: who owns the association sends flight() again.

enum class Content : std::uint8_t { change_cipher_spec = 20, alert = 21, handshake = 22, application_data = 23 };
constexpr std::uint8_t kDecryptError = 51, kAccessDenied = 49, kUnknownIdentity = 115;      // alerts
constexpr std::uint8_t kClientHello = 1, kHelloVerifyRequest = 3, kClientKeyExchange = 16;  // types of handshake messages
constexpr std::size_t kRecordHead = 13, kMessageHead = 12;                                  // [bytes]

/// Head of the first record of a datagram (RFC 6347, section 4.1).
struct RecordHead {
  Content content = Content::alert;
  std::uint16_t epoch = 0;
  std::uint64_t number = 0;
  bool is_alone = false;  ///< the record is the whole datagram
};
/// Nothing: it does not begin with a record of DTLS 1.0 to 1.2, or is not whole records to its end.
std::optional<RecordHead> read_head(std::span<const std::uint8_t> wire) noexcept;
/// The type of the handshake message that a datagram begins with.   pre  read_head() says handshake, epoch 0
std::optional<std::uint8_t> message_type(std::span<const std::uint8_t> wire) noexcept;

/// A fatal alert in epoch 0, which anyone can forge, that says that the key is wrong.
bool says_wrong_key(std::span<const std::uint8_t> wire) noexcept;

/// What the associations of one end share: keys and priorities. It stays where it is.
class Context {
 public:
  /// in   keys  of a client one   err  internal R-SEA-6
  static Result<std::unique_ptr<Context>> create(KeyList keys, const Limits& limits);
  const KeyList& keys() const noexcept { return keys_; }
  void replace(KeyList keys) noexcept { keys_ = std::move(keys); }  ///< those of associations that there are stay what they were
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  ~Context();

 private:
  friend class Association;
  Context(KeyList keys, Key decoy, const Limits& limits) noexcept
      : keys_(std::move(keys)), decoy_(std::move(decoy)), limits_(limits) {}

  KeyList keys_;
  Key decoy_;  // of users that nobody knows: nobody has it, and a handshake with it fails as with any wrong key
  Limits limits_;
  gnutls_priority_t priority_ = nullptr;
  gnutls_psk_client_credentials_t client_ = nullptr;
  gnutls_psk_server_credentials_t server_ = nullptr;
};

class Association {
 public:
  /// err  internal R-SEA-6
  static Result<std::unique_ptr<Association>> client(const Context& context);
  static Result<std::unique_ptr<Association>> server(const Context& context, gnutls_dtls_prestate_st cookie);
  Association(const Association&) = delete;
  Association& operator=(const Association&) = delete;
  ~Association();

  enum class Stage { handshake, open, broken };
  Stage stage() const noexcept { return stage_; }
  /// Go on with the handshake: as a client begin it with nothing.   pre  handshake   time some 0.1 ms
  Stage advance(std::span<const std::uint8_t> wire) noexcept;
  /// The last advance() made a new flight.
  bool has_spoken() const noexcept { return has_spoken_; }
  std::span<const std::uint8_t> flight() const noexcept { return flight_; }  ///< the newest, one datagram
  /// Of a server: the last advance() heard what the client sealed, and could not open it.
  bool is_key_wrong() const noexcept { return is_key_wrong_; }
  /// The key that the client has named, of a server; null: none yet, or none that is known.
  const Key* key() const noexcept { return key_.get(); }

  /// One record.   out  in `out`   pre  open, out.size() >= kLargestSealed
  /// err  limit_exceeded R-SEA-4: then the association is broken;  limit_exceeded R-SEA-5: empty or too large
  Result<std::span<const std::uint8_t>> seal(std::span<const std::uint8_t> plain, std::span<std::uint8_t> out) noexcept;

  enum class Opened { plain, nothing, unauthentic, replayed, closed, denied, used_up };
  struct Inside {
    Opened what = Opened::nothing;
    std::span<const std::uint8_t> plain{};
  };
  /// in   wire  a datagram whose only record is alert or application_data of epoch 1   pre  open, out.size() >= kLargestSealed
  Inside open(const RecordHead& head, std::span<const std::uint8_t> wire, std::span<std::uint8_t> out) noexcept;
  /// The alert close_notify: nothing more is sent.   pre  open
  std::span<const std::uint8_t> close() noexcept;
  /// A fatal alert; it changes nothing here.   out  in `out`, empty: GnuTLS refuses   pre  out.size() >= kLargestSealed
  std::span<const std::uint8_t> alert(std::uint8_t what, std::span<std::uint8_t> out) noexcept;

 private:
  friend class Context;
  Association(const Context& context) noexcept : context_(context) {}
  static Result<std::unique_ptr<Association>> create(const Context& context, unsigned flags, int credentials, void* of);
  void note_records(std::span<const std::uint8_t> wire) noexcept;
  static int give_client_key(gnutls_session_t session, char** name, gnutls_datum_t* secret) noexcept;
  static int give_server_key(gnutls_session_t session, const char* name, gnutls_datum_t* secret) noexcept;
  bool was_heard(std::uint64_t number) const noexcept;
  void note_heard(std::uint64_t number) noexcept;
  static ssize_t push(gnutls_transport_ptr_t self, const void* bytes, std::size_t size) noexcept;
  static ssize_t pull(gnutls_transport_ptr_t self, void* bytes, std::size_t size) noexcept;
  static int wait(gnutls_transport_ptr_t self, unsigned milliseconds) noexcept;

  const Context& context_;
  gnutls_session_t session_ = nullptr;
  Stage stage_ = Stage::handshake;
  std::span<const std::uint8_t> inbox_;  // the datagram that GnuTLS may take
  std::span<std::uint8_t> outbox_;       // where a sealed record goes; empty: into flight_
  std::size_t sealed_size_ = 0;
  std::vector<std::uint8_t> flight_;
  bool has_spoken_ = false, failed_to_speak_ = false;
  std::shared_ptr<const Key> key_;
  bool was_asked_ = false, was_changed_ = false, is_key_wrong_ = false;  // for a key; to the cipher, since then
  std::uint64_t sealed_ = 0, unauthentic_ = 0;
  std::uint64_t newest_ = 0,
                window_ = 0;  // bit i: number newest_ - i was heard. To distinguish replays from forgeries; GnuTLS has its own
};

}  // namespace tactus::seal
