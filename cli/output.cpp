// SPDX-License-Identifier: Apache-2.0
#include "cli/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <mutex>
#include <system_error>

namespace tactus::cli {
namespace fs = std::filesystem;
namespace {

tl::unexpected<Failure> refuse_io(const std::string& path, const std::string& what) {
  return tactus::cli::refuse_io(path, what, errno);
}

// Read by a signal handler: lock-free, and each path outlives its entry. More files than entries are left behind, no more.
std::array<std::atomic<const char*>, 16> unfinished;
static_assert(std::atomic<const char*>::is_always_lock_free);

extern "C" void remove_unfinished(int signal) {
  for (const auto& file : unfinished)
    if (const char* path = file.load()) unlink(path);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Not for signals that whoever started the program wants ignored.
void catch_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(signal, remove_unfinished) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

RemovedOnSignal::RemovedOnSignal(std::string path) : path_(std::move(path)) {
  static std::once_flag once;
  std::call_once(once, catch_signals);
  for (auto& entry : unfinished) {
    const char* none = nullptr;
    if (entry.compare_exchange_strong(none, path_.c_str())) return;
  }
}

RemovedOnSignal::~RemovedOnSignal() {
  for (auto& entry : unfinished) {
    const char* own = path_.c_str();
    if (entry.compare_exchange_strong(own, nullptr)) return;
  }
}

Outcome OutputFile::check_free(const std::string& path, Existing existing, std::initializer_list<std::string> others) {
  if (path.empty()) return refuse_arguments("the name of an output is empty", "Give a name, or - for standard output.");
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
  OutputFile file(path, direct ? path : path + ".part", Unfinished::goes);
  if (!direct) file.removal_ = std::make_unique<RemovedOnSignal>(file.working_path_);
  return file;
}

tl::expected<OutputFile, Failure> OutputFile::create_growing(const std::string& path, Existing existing,
                                                             std::initializer_list<std::string> others) {
  std::error_code ignored;
  if (path == "-" || fs::exists(path, ignored)) return create(path, existing, others);
  if (auto free = check_free(path, existing, others); !free) return tl::unexpected(free.error());
  return OutputFile(path, path, Unfinished::stays);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      working_path_(std::move(other.working_path_)),
      unfinished_(other.unfinished_),
      removal_(std::move(other.removal_)),
      stream_(std::move(other.stream_)) {
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
  removal_.reset();
  return {};
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (is_temporary()) fs::remove(working_path_, ignored);
}

void OutputFile::discard() noexcept {
  std::error_code ignored;
  if (stays()) fs::remove(working_path_, ignored);
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
