// SPDX-License-Identifier: Apache-2.0
/// The key of a user of sealed sessions, and the file that holds it. spec/70-session.md section 11.2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <tactus/base/diagnostic.h>

namespace tactus::seal {

// ==== counters ====

inline constexpr std::size_t kOverhead = 29;        ///< [bytes] of a record: 13 of its head, 16 of its tag
inline constexpr std::size_t kLargestPlain = 1200;  ///< [bytes] that are sealed at a time
inline constexpr std::size_t kLargestSealed = kLargestPlain + kOverhead;

/// What keys of one handshake may be used for (RFC 9147, section 4.5.3).
struct Limits {
  std::uint64_t sealed = (std::uint64_t{1} << 48) - 1024;  ///< records sealed
  std::uint64_t dropped = std::uint64_t{1} << 36;          ///< records that were not authentic
};

/// What an end of the seal did. Nothing of it is in the traffic of the session.
struct Counters {
  std::uint64_t handshakes = 0;   ///< that came to their end
  std::uint64_t sealed = 0;       ///< records with a datagram of the session
  std::uint64_t opened = 0;       ///< the same, heard
  std::uint64_t unauthentic = 0;  ///< records dropped: forged, damaged, or of an association before
  std::uint64_t replayed = 0;     ///< records dropped that had been heard, or were too old to know
  std::uint64_t strangers = 0;    ///< datagrams dropped that belong to no association and no handshake, or are no record
  std::uint64_t cookies = 0;      ///< answers to addresses that were not validated
  std::uint64_t limited = 0;      ///< datagrams dropped before anything was done: their sender sent too many
};

// ==== key ====

/// A name and 256 random bits. Both are wiped from memory when the key goes; GnuTLS holds copies while a handshake runs.
class Key {
 public:
  static constexpr std::size_t kSecret = 32, kLongestName = 64;  // [bytes]

  /// A new one.   err  invalid_argument R-KEY-4: the name;  internal R-SEA-6: the system has no random bits
  static Result<Key> generate(std::string_view name);
  /// The text of a key file.   in  file  for the message   err  malformed R-KEY-3, with the line;  invalid R-KEY-7: a key list
  static tl::expected<Key, Diagnostic> parse(std::string_view text, const std::string& file);
  /// in   secret  hexadecimal digits in lower case   out  nothing: the name or they are not what they must be
  static std::optional<Key> from(std::string_view name, std::string_view secret) noexcept;
  /// err  io R-KEY-1, with errno;  invalid R-KEY-2: others can read it;  as parse()
  static tl::expected<Key, Diagnostic> read(const std::string& path);
  /// Make a new file that only its owner can read.   err  io R-KEY-1, with errno: EEXIST if there is anything at `path`
  Result<void> write(const std::string& path) const;

  std::string_view name() const noexcept { return {name_.data(), name_size_}; }
  std::span<const std::uint8_t, kSecret> secret() const noexcept { return secret_; }
  static bool is_name(std::string_view text) noexcept;
  friend bool operator==(const Key& a,
                         const Key& b) noexcept;  ///< of secrets in a time that does not depend on where they differ

  Key(Key&& other) noexcept;
  Key& operator=(Key&& other) noexcept;
  ~Key();

 private:
  explicit Key(std::string_view name) noexcept;
  void wipe() noexcept;

  std::array<char, kLongestName> name_{};
  std::size_t name_size_ = 0;
  std::array<std::uint8_t, kSecret> secret_{};
};

}  // namespace tactus::seal
