// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/byte_source.h>

#include <zstd.h>
#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus {

// ==== compression ====

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

// ==== byte source ====

void ByteSource::CloseFile::operator()(std::FILE* file) const noexcept {
  if (file != stdin) std::fclose(file);
}

Result<ByteSource> ByteSource::open_file(const std::string& path) {
  ByteSource source;
  source.file_.reset(path == "-" ? stdin : std::fopen(path.c_str(), "rb"));
  if (!source.file_) return fail(Errc::io, "R-TRC-1");
  return source;
}

ByteSource ByteSource::over_memory(std::span<const std::uint8_t> bytes) noexcept {
  ByteSource source;
  source.memory_ = bytes;
  return source;
}

Result<std::size_t> ByteSource::read(std::span<std::uint8_t> out) noexcept {
  if (file_) {
    const std::size_t count = std::fread(out.data(), 1, out.size(), file_.get());
    if (count < out.size() && std::ferror(file_.get()) != 0) return fail(Errc::io, "R-TRC-1", 8 * position_);
    position_ += count;
    return count;
  }
  const auto part = memory_.subspan(static_cast<std::size_t>(position_))
                        .first(std::min(out.size(), memory_.size() - static_cast<std::size_t>(position_)));
  std::copy(part.begin(), part.end(), out.begin());
  position_ += part.size();
  return part.size();
}

std::optional<std::uint64_t> ByteSource::size() noexcept {
  if (!file_) return memory_.size();
  if (file_.get() == stdin || fseeko(file_.get(), 0, SEEK_END) != 0) return std::nullopt;
  const off_t end = ftello(file_.get());
  if (end < 0 || fseeko(file_.get(), static_cast<off_t>(position_), SEEK_SET) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(end);
}

bool ByteSource::read_at(std::uint64_t offset, std::span<std::uint8_t> out) noexcept {
  const auto end = size();
  if (!end || offset > *end || out.size() > *end - offset) return false;
  if (!file_) {
    std::copy_n(memory_.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
    return true;
  }
  if (fseeko(file_.get(), static_cast<off_t>(offset), SEEK_SET) != 0) return false;
  const bool whole = std::fread(out.data(), 1, out.size(), file_.get()) == out.size();
  return fseeko(file_.get(), static_cast<off_t>(position_), SEEK_SET) == 0 && whole;
}

}  // namespace tactus
