// SPDX-License-Identifier: Apache-2.0
/// zstd and LZ4 frames: of chunks, of messages and of whole files. Internal to the library; no other file calls their libraries.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/result.h>

namespace tactus {

enum class Compression : std::uint8_t { none, zstd, lz4 };

/// From the name that the MCAP format gives it ("", "zstd", "lz4"); nothing if it has no such.
std::optional<Compression> compression_of_name(std::string_view name) noexcept;
/// From the first four bytes of what may be a frame of one; none when it is something else. Frames to be skipped count as zstd.
Compression compression_of_data(std::span<const std::uint8_t> data) noexcept;
/// "zstd" or "LZ4".
const char* name_of(Compression compression) noexcept;

/// Compresses independent blocks with one context, into zstd.
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

/// Decompress whole frames that hold exactly `output.size()` bytes; false when they do not.   pre  compression is not none
bool decompress_exactly(Compression compression, std::span<const std::uint8_t> input, std::span<std::uint8_t> output) noexcept;

/// Size that a frame of one message announces; nothing if it announces none.
std::optional<std::uint64_t> announced_size(Compression compression, std::span<const std::uint8_t> frame) noexcept;

/// Decompresses a stream piece by piece, in bounded memory (zstd: window at most 128 MiB; LZ4: 8 MiB).
class StreamDecompressor {
 public:
  /// pre  compression is not none
  explicit StreamDecompressor(Compression compression = Compression::zstd);
  StreamDecompressor(StreamDecompressor&&) noexcept;
  StreamDecompressor& operator=(StreamDecompressor&&) noexcept;
  ~StreamDecompressor();
  struct Progress {
    std::size_t consumed = 0, produced = 0;
  };
  /// err  malformed R-TRC-8: not of this compression, or damaged.
  Result<Progress> decompress(std::span<const std::uint8_t> input, std::span<std::uint8_t> output) noexcept;
  /// True between frames: the only place where the input may end.
  bool at_frame_end() const noexcept { return at_frame_end_; }

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  bool at_frame_end_ = true;
};

}  // namespace tactus
