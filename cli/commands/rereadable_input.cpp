// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/rereadable_input.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <filesystem>

#include <tactus/base/shown.h>
#include <tactus/trace/byte_source.h>

namespace tactus::cli {

tl::expected<RereadableInput, Failure> RereadableInput::open(const std::string& path, std::uint64_t most) {
  RereadableInput input;
  input.path_ = path;
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  const bool is_pipe = path == "-" || std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status);
  if (!is_pipe) return input;
  auto source = ByteSource::open_file(path);
  if (!source) return refuse(path, source.error());
  input.copy_.reset(std::tmpfile());
  if (!input.copy_) return refuse_io("a temporary file", "cannot be made", errno);
  std::array<std::uint8_t, 1 << 16> piece;
  for (std::uint64_t copied = 0;;) {
    const auto count = source->read(piece);
    if (!count) return refuse(path, count.error());
    if (*count == 0) break;
    copied += *count;
    if (copied > most)
      return refuse(fmt::format("{}: more than {} MiB from a pipe", shown_path(path), most >> 20), "Write it to a file first.");
    if (std::fwrite(piece.data(), 1, *count, input.copy_.get()) != *count)
      return refuse_io("a temporary file", "cannot be written", errno);
  }
  if (std::fflush(input.copy_.get()) != 0) return refuse_io("a temporary file", "cannot be written", errno);
  input.path_ = "/proc/self/fd/" + std::to_string(fileno(input.copy_.get()));
  return input;
}

}  // namespace tactus::cli
