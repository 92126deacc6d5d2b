// SPDX-License-Identifier: Apache-2.0
/// Where the bytes of an untrusted input come from: a file, a pipe or memory, as they are or unpacked. Internal to the library.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/trace/compression.h>

namespace tactus {

class ByteSource {
 public:
  /// path "-" is standard input.   err  io R-TRC-1
  static Result<ByteSource> open_file(const std::string& path);
  /// pre  `bytes` outlive the source.
  static ByteSource over_memory(std::span<const std::uint8_t> bytes) noexcept;

  /// If the first bytes are those of a zstd or LZ4 file, read() unpacks from now on. A name says nothing: only the bytes do.
  /// A frame that ends early ends the input.   pre  nothing was read.   err  io R-TRC-1
  Result<Compression> unpack();

  /// Fill `out` from the current position; fewer bytes only at the end of the input.   err  io R-TRC-1; malformed R-TRC-8
  Result<std::size_t> read(std::span<std::uint8_t> out) noexcept;
  /// The next bytes, up to `count`, without moving.   pre  not unpacking.   err  io R-TRC-1
  Result<std::span<const std::uint8_t>> peek(std::size_t count);

  /// Bytes of the file itself that were read, packed as they are.
  std::uint64_t stored_bytes_read() const noexcept { return stored_; }
  /// Size of the file itself; nothing when the input is a pipe.
  std::optional<std::uint64_t> stored_size() noexcept;
  /// Size of what read() gives in bytes; nothing when the input is a pipe or is unpacked.
  std::optional<std::uint64_t> size() noexcept { return unpacker_ ? std::nullopt : stored_size(); }
  /// Fill `out` from `offset` and return to the current position; false when that cannot be done.
  bool read_at(std::uint64_t offset, std::span<std::uint8_t> out) noexcept;
  /// The input ended within a compressed frame.
  bool ends_within_frame() const noexcept { return ends_within_frame_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const noexcept;
  };
  struct Unpacker {
    StreamDecompressor decompressor;
    std::vector<std::uint8_t> input;
    std::size_t begin = 0, end = 0;
  };
  ByteSource() = default;
  Result<std::size_t> read_stored(std::span<std::uint8_t> out) noexcept;
  Result<std::size_t> read_unpacked(std::span<std::uint8_t> out) noexcept;

  std::unique_ptr<std::FILE, CloseFile> file_;  // none: memory_
  std::span<const std::uint8_t> memory_;
  std::vector<std::uint8_t> head_;  // peeked at, not yet read
  std::uint64_t stored_ = 0;        // bytes read from the file or memory, without head_
  std::unique_ptr<Unpacker> unpacker_;
  bool ends_within_frame_ = false;
};

}  // namespace tactus
