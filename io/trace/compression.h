// SPDX-License-Identifier: Apache-2.0
/// zstd; no other file calls it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/base/result.h>

namespace tactus {

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

}  // namespace tactus
