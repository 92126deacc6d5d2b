// SPDX-License-Identifier: Apache-2.0
/// Bytes of a file or a pipe, and the compression of what is read and written. Internal to the library.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/result.h>

namespace tactus {

// ==== compression ====
// zstd; no other file calls it.

/// Compresses independent blocks with one context.
class Compressor {
 public:
  Compressor();
  Compressor(Compressor&&) noexcept;
  Compressor& operator=(Compressor&&) noexcept;
  ~Compressor();
  /// The result stays valid until the next call.   err  internal R-TRC-8: zstd failed, which happens only without memory.
  Result<std::span<const std::uint8_t>> compress(std::span<const std::uint8_t> input);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// Decompress whole frames that hold exactly `output.size()` bytes; false when they do not.
bool decompress_exactly(std::span<const std::uint8_t> input, std::span<std::uint8_t> output) noexcept;

/// Decompresses a stream piece by piece, in bounded memory (window at most 128 MiB).
class StreamDecompressor {
 public:
  StreamDecompressor();
  StreamDecompressor(StreamDecompressor&&) noexcept;
  StreamDecompressor& operator=(StreamDecompressor&&) noexcept;
  ~StreamDecompressor();
  struct Progress {
    std::size_t consumed = 0, produced = 0;
  };
  /// err  malformed R-TRC-8: not zstd, or damaged.
  Result<Progress> decompress(std::span<const std::uint8_t> input, std::span<std::uint8_t> output) noexcept;
  /// True between frames: the only place where the input may end.
  bool at_frame_end() const noexcept { return at_frame_end_; }

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  bool at_frame_end_ = true;
};

// ==== byte source ====
// Where the bytes of an untrusted input come from: a file, a pipe or memory.

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
