// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/compression.h>

#include <zstd.h>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

struct FreeCompression {
  void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
};
struct FreeDecompression {
  void operator()(ZSTD_DCtx* context) const noexcept { ZSTD_freeDCtx(context); }
};

}  // namespace

struct Compressor::Context {
  std::unique_ptr<ZSTD_CCtx, FreeCompression> zstd{ZSTD_createCCtx()};
  std::vector<std::uint8_t> output;
};

Compressor::Compressor() : context_(std::make_unique<Context>()) {}
Compressor::Compressor(Compressor&&) noexcept = default;
Compressor& Compressor::operator=(Compressor&&) noexcept = default;
Compressor::~Compressor() = default;

Result<std::span<const std::uint8_t>> Compressor::compress(std::span<const std::uint8_t> input) {
  auto& output = context_->output;
  output.resize(ZSTD_compressBound(input.size()));
  const std::size_t size =
      ZSTD_compressCCtx(context_->zstd.get(), output.data(), output.size(), input.data(), input.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0) return fail(Errc::internal, "R-TRC-8");
  return std::span<const std::uint8_t>(output).first(size);
}

bool decompress_exactly(std::span<const std::uint8_t> input, std::span<std::uint8_t> output) noexcept {
  return ZSTD_decompress(output.data(), output.size(), input.data(), input.size()) == output.size();
}

struct StreamDecompressor::Context {
  std::unique_ptr<ZSTD_DCtx, FreeDecompression> zstd{ZSTD_createDCtx()};
};

StreamDecompressor::StreamDecompressor() : context_(std::make_unique<Context>()) {}
StreamDecompressor::StreamDecompressor(StreamDecompressor&&) noexcept = default;
StreamDecompressor& StreamDecompressor::operator=(StreamDecompressor&&) noexcept = default;
StreamDecompressor::~StreamDecompressor() = default;

Result<StreamDecompressor::Progress> StreamDecompressor::decompress(std::span<const std::uint8_t> input,
                                                                    std::span<std::uint8_t> output) noexcept {
  ZSTD_inBuffer in{input.data(), input.size(), 0};
  ZSTD_outBuffer out{output.data(), output.size(), 0};
  const std::size_t rest = ZSTD_decompressStream(context_->zstd.get(), &out, &in);
  if (ZSTD_isError(rest) != 0) return fail(Errc::malformed, "R-TRC-8");
  if (in.pos > 0 || out.pos > 0) at_frame_end_ = rest == 0;  // without progress the hint is about the next frame
  return Progress{in.pos, out.pos};
}

}  // namespace tactus
