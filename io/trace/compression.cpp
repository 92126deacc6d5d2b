// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/compression.h>

#include <lz4frame.h>
#include <zstd.h>

#include <new>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

struct FreeCompression {
  void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
};
struct FreeDecompression {
  void operator()(ZSTD_DCtx* context) const noexcept { ZSTD_freeDCtx(context); }
  void operator()(LZ4F_dctx* context) const noexcept { LZ4F_freeDecompressionContext(context); }
};

using Lz4Context = std::unique_ptr<LZ4F_dctx, FreeDecompression>;

Lz4Context make_lz4() noexcept {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) return nullptr;
  return Lz4Context(context);
}

bool decompress_lz4(std::span<const std::uint8_t> input, std::span<std::uint8_t> output) noexcept {
  const Lz4Context context = make_lz4();
  if (!context) return false;
  std::size_t rest = 1;  // of the frame; 0: it is whole
  while (!input.empty()) {
    std::size_t consumed = input.size(), produced = output.size();
    rest = LZ4F_decompress(context.get(), output.data(), &produced, input.data(), &consumed, nullptr);
    if (LZ4F_isError(rest) != 0 || (consumed == 0 && produced == 0)) return false;
    input = input.subspan(consumed);
    output = output.subspan(produced);
  }
  return rest == 0 && output.empty();
}

}  // namespace

std::optional<Compression> compression_of_name(std::string_view name) noexcept {
  if (name.empty()) return Compression::none;
  if (name == "zstd") return Compression::zstd;
  if (name == "lz4") return Compression::lz4;
  return std::nullopt;
}

Compression compression_of_data(std::span<const std::uint8_t> data) noexcept {
  if (data.size() < 4) return Compression::none;
  std::uint32_t magic = 0;
  for (unsigned i = 0; i < 4; ++i) magic |= static_cast<std::uint32_t>(data[i]) << (8 * i);
  if (magic == ZSTD_MAGICNUMBER || (magic & 0xFFFFFFF0U) == 0x184D2A50U) return Compression::zstd;
  return magic == 0x184D2204U ? Compression::lz4 : Compression::none;
}

const char* name_of(Compression compression) noexcept {
  if (compression == Compression::none) return "";
  return compression == Compression::zstd ? "zstd" : "LZ4";
}

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

bool decompress_exactly(Compression compression, std::span<const std::uint8_t> input, std::span<std::uint8_t> output) noexcept {
  if (compression == Compression::lz4) return decompress_lz4(input, output);
  return ZSTD_decompress(output.data(), output.size(), input.data(), input.size()) == output.size();
}

std::optional<std::uint64_t> announced_size(Compression compression, std::span<const std::uint8_t> frame) noexcept {
  if (compression == Compression::zstd) {
    const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
    if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
    return size;
  }
  const Lz4Context context = make_lz4();
  LZ4F_frameInfo_t info{};
  std::size_t consumed = frame.size();
  if (!context || LZ4F_isError(LZ4F_getFrameInfo(context.get(), &info, frame.data(), &consumed)) != 0) return std::nullopt;
  return info.contentSize > 0 ? std::optional<std::uint64_t>(info.contentSize) : std::nullopt;  // 0: not stated
}

struct StreamDecompressor::Context {
  std::unique_ptr<ZSTD_DCtx, FreeDecompression> zstd;
  Lz4Context lz4;
};

StreamDecompressor::StreamDecompressor(Compression compression) : context_(std::make_unique<Context>()) {
  if (compression == Compression::lz4) context_->lz4 = make_lz4();
  else context_->zstd.reset(ZSTD_createDCtx());
  if (!context_->lz4 && !context_->zstd) throw std::bad_alloc();
}
StreamDecompressor::StreamDecompressor(StreamDecompressor&&) noexcept = default;
StreamDecompressor& StreamDecompressor::operator=(StreamDecompressor&&) noexcept = default;
StreamDecompressor::~StreamDecompressor() = default;

Result<StreamDecompressor::Progress> StreamDecompressor::decompress(std::span<const std::uint8_t> input,
                                                                    std::span<std::uint8_t> output) noexcept {
  Progress progress;
  std::size_t rest = 0;
  if (context_->lz4) {
    progress = {input.size(), output.size()};
    rest = LZ4F_decompress(context_->lz4.get(), output.data(), &progress.produced, input.data(), &progress.consumed, nullptr);
    if (LZ4F_isError(rest) != 0) return fail(Errc::malformed, "R-TRC-8");
  } else {
    ZSTD_inBuffer in{input.data(), input.size(), 0};
    ZSTD_outBuffer out{output.data(), output.size(), 0};
    rest = ZSTD_decompressStream(context_->zstd.get(), &out, &in);
    if (ZSTD_isError(rest) != 0) return fail(Errc::malformed, "R-TRC-8");
    progress = {in.pos, out.pos};
  }
  if (progress.consumed > 0 || progress.produced > 0)
    at_frame_end_ = rest == 0;  // without progress the hint is about the next frame
  return progress;
}

}  // namespace tactus
