// SPDX-License-Identifier: Apache-2.0
/// Where the bytes of an untrusted input come from: a file, a pipe or memory.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <tactus/base/result.h>

namespace tactus {

class ByteSource {
 public:
  /// path "-" is standard input.   err  io R-TRC-1
  static Result<ByteSource> open_file(const std::string& path);
  /// pre  `bytes` outlive the source.
  static ByteSource over_memory(std::span<const std::uint8_t> bytes) noexcept;

  /// Fill `out` from the current place; fewer bytes only at the end of the input.   err  io R-TRC-1
  Result<std::size_t> read(std::span<std::uint8_t> out) noexcept;

  /// Size in bytes; nothing when the input is a pipe.
  std::optional<std::uint64_t> size() noexcept;
  /// Fill `out` from `offset` and return to the current place; false when that cannot be done.
  bool read_at(std::uint64_t offset, std::span<std::uint8_t> out) noexcept;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const noexcept;
  };
  ByteSource() = default;

  std::unique_ptr<std::FILE, CloseFile> file_;  // none: memory_
  std::span<const std::uint8_t> memory_;
  std::uint64_t position_ = 0;
};

}  // namespace tactus
