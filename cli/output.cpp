// SPDX-License-Identifier: Apache-2.0
#include "cli/output.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <system_error>

namespace tactus::cli {
namespace fs = std::filesystem;
namespace {

tl::unexpected<Failure> refuse_io(const std::string& path, const std::string& what) {
  return refuse(path + ": " + what + ": " + std::generic_category().message(errno),
                "Check that the path is right and that you may use it.");
}

}  // namespace

Outcome OutputFile::check_free(const std::string& path, Existing existing, std::initializer_list<std::string> others) {
  std::error_code ignored;
  for (const std::string& other : others) {
    if (path != "-" && (path == other || fs::equivalent(path, other, ignored))) {
      return refuse(fmt::format("{}: the output is also {}, which the command needs", path, other), "Give another name.");
    }
  }
  if (path == "-" || existing == Existing::replace || !fs::is_regular_file(path, ignored)) return {};
  return refuse(path + ": the file is there already", "Give -f to replace it, or another name.");
}

tl::expected<OutputFile, Failure> OutputFile::create(const std::string& path, Existing existing,
                                                     std::initializer_list<std::string> others) {
  if (auto free = check_free(path, existing, others); !free) return tl::unexpected(free.error());
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  const bool direct = path == "-" || (fs::exists(status) && !fs::is_regular_file(status));
  return OutputFile(path, direct ? path : path + ".part");
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)), working_path_(std::move(other.working_path_)), stream_(std::move(other.stream_)) {
  other.path_.clear();
  other.working_path_.clear();
}

tl::expected<std::ostream*, Failure> OutputFile::open() {
  if (working_path_ == "-") return &std::cout;
  stream_ = std::make_unique<std::ofstream>(working_path_, std::ios::binary);
  if (!*stream_) return refuse_io(path_, "cannot be written");
  return stream_.get();
}

Outcome OutputFile::keep() {
  if (stream_) stream_->close();
  if (stream_ && stream_->fail()) return refuse_io(path_, "cannot be written");
  if (!is_temporary()) return {};
  std::error_code error;
  fs::rename(working_path_, path_, error);
  if (error)
    return refuse(path_ + ": cannot be written: " + error.message(), "Check that the path is right and that you may use it.");
  working_path_ = path_;
  return {};
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (is_temporary()) fs::remove(working_path_, ignored);
}

tl::expected<std::string, Failure> read_file(const std::string& path) {
  std::ifstream file;
  if (fs::is_directory(path)) return refuse(path + ": this is a folder", "Give a file.");
  if (path != "-") {
    file.open(path, std::ios::binary);
    if (!file) return refuse_io(path, "cannot be read");
  }
  std::istream& in = path == "-" ? std::cin : file;
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) return refuse_io(path, "cannot be read");
  return bytes;
}

Outcome check_standard_output() {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return {};
  return refuse_io("standard output", "cannot be written");
}

}  // namespace tactus::cli
