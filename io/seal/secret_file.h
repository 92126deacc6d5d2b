// SPDX-License-Identifier: Apache-2.0
/// Files that hold secrets: for their owner only, and wiped from memory. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <tactus/base/diagnostic.h>
#include <tactus/seal/key_list.h>

namespace tactus::seal {

/// Text that holds secrets: its room is given once and wiped at the end, so that no copy stays in freed memory.
class SecretText {
 public:
  /// in   most  bytes that it can hold; what is added beyond them is left out
  explicit SecretText(std::size_t most) : bytes_(std::make_unique<char[]>(most)), most_(most) {}
  SecretText(SecretText&& other) noexcept = default;
  SecretText& operator=(SecretText&& other) = delete;
  ~SecretText();

  void add(std::string_view more) noexcept;
  void add_hex(std::span<const std::uint8_t> secret) noexcept;
  std::string_view view() const noexcept { return {bytes_.get(), size_}; }

 private:
  friend tl::expected<SecretText, Diagnostic> read_secret(const std::string& path, std::size_t most);
  std::unique_ptr<char[]> bytes_;
  std::size_t most_, size_ = 0;
};

/// Of a file that is not there: all 0.   time  one system call
FileStamp stamp_of(const std::string& path) noexcept;

/// A file of at most that many bytes; of a longer one so many and one more.
/// err  io R-KEY-1, with errno;  invalid R-KEY-2: others can read it, or it is no plain file
tl::expected<SecretText, Diagnostic> read_secret(const std::string& path, std::size_t most);
/// Make a new file that only its owner can read.   err  io R-KEY-1, with errno: EEXIST if there is anything at `path`
Result<void> create_secret(const std::string& path, std::string_view text);
/// Put another file of the same owner in the place of this one, or make it: a reader finds the old one or the new one, never half of it.
/// err  io R-KEY-1, with errno
Result<void> replace_secret(const std::string& path, std::string_view text);

/// Hexadecimal digits in lower case.   out  false: not these alone
bool read_hex(std::string_view text, std::span<std::uint8_t> secret) noexcept;

}  // namespace tactus::seal
