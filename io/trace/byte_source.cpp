// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/byte_source.h>

#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr std::size_t kPacked = 64u << 10;  // bytes of a packed file read at once

}  // namespace

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

Result<Compression> ByteSource::unpack() {
  TACTUS_TRY(const auto first, peek(4));
  const Compression compression = compression_of_data(first);
  if (compression != Compression::none)
    unpacker_ = std::make_unique<Unpacker>(Unpacker{StreamDecompressor(compression), std::vector<std::uint8_t>(kPacked)});
  return compression;
}

Result<std::span<const std::uint8_t>> ByteSource::peek(std::size_t count) {
  if (head_.size() < count) {
    std::vector<std::uint8_t> head(count);
    TACTUS_TRY(const std::size_t got, read_stored(head));
    head.resize(got);
    stored_ -= got;
    head_ = std::move(head);
  }
  return std::span<const std::uint8_t>(head_).first(std::min(count, head_.size()));
}

Result<std::size_t> ByteSource::read(std::span<std::uint8_t> out) noexcept {
  return unpacker_ ? read_unpacked(out) : read_stored(out);
}

Result<std::size_t> ByteSource::read_stored(std::span<std::uint8_t> out) noexcept {
  std::size_t count = std::min(out.size(), head_.size());
  std::copy_n(head_.begin(), count, out.begin());
  head_.erase(head_.begin(), head_.begin() + static_cast<std::ptrdiff_t>(count));
  const auto rest = out.subspan(count);
  if (rest.empty()) {
    stored_ += count;
    return count;
  }
  if (file_) {
    const std::size_t got = std::fread(rest.data(), 1, rest.size(), file_.get());
    if (got < rest.size() && std::ferror(file_.get()) != 0) return fail(Errc::io, "R-TRC-1", 8 * stored_);
    count += got;
  } else {
    const auto part = memory_.subspan(static_cast<std::size_t>(stored_) + count);
    const std::size_t got = std::min(rest.size(), part.size());
    std::copy_n(part.begin(), got, rest.begin());
    count += got;
  }
  stored_ += count;
  return count;
}

Result<std::size_t> ByteSource::read_unpacked(std::span<std::uint8_t> out) noexcept {
  Unpacker& u = *unpacker_;
  std::size_t done = 0;
  while (done < out.size()) {
    const auto input = std::span<const std::uint8_t>(u.input).subspan(u.begin, u.end - u.begin);
    TACTUS_TRY(const auto progress, u.decompressor.decompress(input, out.subspan(done)));
    u.begin += progress.consumed;
    done += progress.produced;
    if (progress.consumed > 0 || progress.produced > 0) continue;
    u.begin = 0;
    TACTUS_TRY(u.end, read_stored(u.input));
    if (u.end > 0) continue;
    ends_within_frame_ = !u.decompressor.at_frame_end();
    break;
  }
  return done;
}

std::optional<std::uint64_t> ByteSource::stored_size() noexcept {
  if (!file_) return memory_.size();
  const off_t position = static_cast<off_t>(stored_ + head_.size());
  if (file_.get() == stdin || fseeko(file_.get(), 0, SEEK_END) != 0) return std::nullopt;
  const off_t end = ftello(file_.get());
  if (end < 0 || fseeko(file_.get(), position, SEEK_SET) != 0) return std::nullopt;
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
  return fseeko(file_.get(), static_cast<off_t>(stored_ + head_.size()), SEEK_SET) == 0 && whole;
}

}  // namespace tactus
