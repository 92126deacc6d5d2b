// SPDX-License-Identifier: Apache-2.0
/// The key of sealed sessions and the file that holds it. spec/70-session.md section 11.2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <tactus/base/diagnostic.h>

namespace tactus::seal {

/// A name and 256 random bits. Both are wiped from memory when the key goes; GnuTLS holds copies while a handshake runs.
class Key {
 public:
  static constexpr std::size_t kSecret = 32, kLongestName = 64;  // [bytes]

  /// A new one.   err  invalid_argument R-KEY-4: the name;  internal R-SEA-6: the system has no random bits
  static Result<Key> generate(std::string_view name);
  /// The text of a key file.   in  file  for the message   err  malformed R-KEY-3, with the line
  static tl::expected<Key, Diagnostic> parse(std::string_view text, const std::string& file);
  /// err  io R-KEY-1, with errno;  invalid R-KEY-2: others can read it;  malformed R-KEY-3
  static tl::expected<Key, Diagnostic> read(const std::string& path);
  /// Make a new file that only its owner can read.   err  io R-KEY-1, with errno: EEXIST if there is anything at `path`
  Result<void> write(const std::string& path) const;

  std::string_view name() const noexcept { return {name_.data(), name_size_}; }
  std::span<const std::uint8_t, kSecret> secret() const noexcept { return secret_; }

  Key(Key&& other) noexcept;
  Key& operator=(Key&& other) noexcept;
  ~Key();

 private:
  Key() = default;
  void wipe() noexcept;

  std::array<char, kLongestName> name_{};
  std::size_t name_size_ = 0;
  std::array<std::uint8_t, kSecret> secret_{};
};

}  // namespace tactus::seal
