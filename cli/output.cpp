// SPDX-License-Identifier: Apache-2.0
#include "cli/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <random>
#include <system_error>

#include <tactus/base/shown.h>
#include <tactus/trace/byte_source.h>

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
    if (const char* path = file.load(); path && unlink(path) != 0) rmdir(path);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Not for signals that whoever started the program wants ignored.
void catch_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(signal, remove_unfinished) == SIG_IGN) std::signal(signal, SIG_IGN);
}

tl::unexpected<Failure> refuse_existing(const std::string& path) {
  return refuse(shown_path(path) + ": the file already exists", "Give -f to replace it, or another name.");
}

/// Two names of one file, whether it is there already or not.
bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const auto whole = [&](const std::string& path) { return fs::weakly_canonical(fs::absolute(path, ignored), ignored); };
  return fs::equivalent(a, b, ignored) || whole(a) == whole(b);
}

/// A hidden name beside `path` or in a folder, which nobody can foresee.
std::string random_name(const fs::path& folder, const std::string& name) {
  constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuvwxyz";
  constexpr std::size_t kMostOfName = 200;  // of 255 bytes that file systems take
  std::random_device random;
  std::uniform_int_distribution<std::size_t> digit(0, kDigits.size() - 1);
  std::string out = "." + name.substr(0, kMostOfName) + ".";
  for (int i = 0; i < 8; ++i) out += kDigits[digit(random)];
  return (folder / out).string();
}

constexpr int kTries = 100;  // of random names

/// A path to the open file that stays valid if the file is renamed.
std::string name_of(const Descriptor& file, const std::string& otherwise) {
  std::string name = "/proc/self/fd/" + std::to_string(file.number());
  return access(name.c_str(), F_OK) == 0 ? name : otherwise;
}

/// Rename without taking the place of another file.   out  errno, 0 when done
int rename_to_free(const std::string& from, const std::string& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  if (link(from.c_str(), to.c_str()) != 0) return errno;  // file systems that cannot do the former
  return unlink(from.c_str()) == 0 ? 0 : errno;
}

}  // namespace

void remove_unfinished_on_signals() {
  static std::once_flag once;
  std::call_once(once, catch_signals);
}

RemovedOnSignal::RemovedOnSignal(std::string path) : path_(std::move(path)) {
  remove_unfinished_on_signals();
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

Descriptor::~Descriptor() {
  if (is_open()) ::close(number_);
}

Descriptor lock_beside(const std::string& path) {
  std::error_code ignored;
  const std::string folder = fs::absolute(path, ignored).parent_path();
  Descriptor out(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (out.is_open()) static_cast<void>(flock(out.number(), LOCK_EX));
  return out;
}

Outcome OutputFile::check_free(const std::string& path, Existing existing, const std::vector<std::string>& others) {
  if (path.empty()) return refuse_arguments("the name of an output is empty", "Give a name, or - for standard output.");
  for (const std::string& other : others) {
    if (path == "-" || other.empty() || !is_same_file(path, other)) continue;
    return refuse_arguments(
        fmt::format("{}: the output is {}, which this command also uses", shown_path(path), shown_path(other)),
        "Give another name.");
  }
  std::error_code ignored;
  if (path == "-" || existing == Existing::replace) return {};
  const bool is_loose_link = fs::is_symlink(path, ignored) && !fs::exists(path, ignored);
  return is_loose_link || fs::is_regular_file(path, ignored) ? refuse_existing(path) : Outcome();
}

tl::expected<OutputFile, Failure> OutputFile::create(const std::string& path, Existing existing,
                                                     const std::vector<std::string>& others) {
  TACTUS_CHECK(check_free(path, existing, others));
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  const bool direct = path == "-" || (fs::exists(status) && !fs::is_regular_file(status));
  OutputFile file(path, existing, direct ? Kind::direct : Kind::temporary);
  TACTUS_CHECK(direct ? file.open_directly() : file.open_temporary());
  return file;
}

tl::expected<OutputFile, Failure> OutputFile::create_growing(const std::string& path, Existing existing,
                                                             const std::vector<std::string>& others) {
  TACTUS_CHECK(check_free(path, existing, others));
  std::error_code ignored;
  if (path == "-" || fs::exists(path, ignored)) return create(path, existing, others);
  OutputFile file(path, existing, Kind::growing);
  file.file_ = Descriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!file.file_.is_open() && errno == EEXIST && existing == Existing::replace) return create(path, existing, others);
  if (!file.file_.is_open()) return errno == EEXIST ? refuse_existing(path) : refuse_io(path, "cannot be written");
  file.name_ = path;
  file.working_path_ = name_of(file.file_, path);
  return file;
}

Outcome OutputFile::open_temporary() {
  const fs::path target(path_);
  for (int i = 0; i < kTries && !file_.is_open(); ++i) {
    name_ = random_name(target.parent_path(), target.filename().string());
    file_ = Descriptor(::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!file_.is_open() && errno != EEXIST) break;
  }
  if (!file_.is_open()) return refuse_io(path_, "cannot be written");
  removal_ = std::make_unique<RemovedOnSignal>(name_);
  working_path_ = name_of(file_, name_);
  return {};
}

/// Opens a pipe or device. Refuses if the path has become a regular file since it was checked.
Outcome OutputFile::open_directly() {
  working_path_ = path_;
  if (path_ == "-") return {};
  file_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
  if (!file_.is_open()) return refuse_io(path_, "cannot be written");
  struct stat status {};
  if (fstat(file_.number(), &status) != 0 || S_ISREG(status.st_mode)) return refuse_existing(path_);
  working_path_ = name_of(file_, path_);
  return {};
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      name_(std::move(other.name_)),
      working_path_(std::move(other.working_path_)),
      existing_(other.existing_),
      kind_(std::exchange(other.kind_, Kind::kept)),
      file_(std::move(other.file_)),
      removal_(std::move(other.removal_)),
      stream_(std::move(other.stream_)) {}

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
  const bool free = existing_ == Existing::keep;
  errno = free ? rename_to_free(name_, path_) : std::rename(name_.c_str(), path_.c_str()) == 0 ? 0 : errno;
  if (errno != 0) return free && errno == EEXIST ? refuse_existing(path_) : refuse_io(path_, "cannot be written");
  kind_ = Kind::kept;
  removal_.reset();
  return {};
}

/// Remove the unfinished file, but none that has come to its name.
void OutputFile::remove_own() noexcept {
  struct stat own {
  }, there{};
  if (fstat(file_.number(), &own) == 0 && lstat(name_.c_str(), &there) == 0 && own.st_ino == there.st_ino &&
      own.st_dev == there.st_dev)
    unlink(name_.c_str());
}

OutputFile::~OutputFile() {
  struct stat own {};
  const bool is_empty = fstat(file_.number(), &own) == 0 && own.st_size == 0;
  if (is_temporary() || (stays() && is_empty)) remove_own();
}

void OutputFile::discard() noexcept {
  if (stays()) remove_own();
}

tl::expected<AsideFolder, Failure> AsideFolder::create(const std::string& parent, const std::string& name) {
  for (int i = 0; i < kTries; ++i) {
    std::string path = random_name(parent, name);
    if (mkdir(path.c_str(), 0777) == 0) return AsideFolder(std::move(path));
    if (errno != EEXIST) break;
  }
  return refuse_io(parent, "no folder can be made here");
}

Outcome AsideFolder::keep_as(const std::string& path) {
  if (std::rename(path_.c_str(), path.c_str()) != 0) return refuse_io(path, "cannot be written");
  path_.clear();
  removal_.reset();
  return {};
}

AsideFolder::~AsideFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

Outcome write_file(const std::string& path, const std::string& bytes, OutputFile::Existing existing) {
  TACTUS_TRY(auto file, OutputFile::create(path, existing));
  TACTUS_TRY(const auto out, file.open());
  *out << bytes;
  return file.keep();
}

tl::expected<std::string, Failure> read_file(const std::string& path, std::uint64_t most) {
  const auto refuse_size = [&] {
    return refuse(fmt::format("{}: larger than {} MiB", shown_path(path), most >> 20), "Give a smaller file.");
  };
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return refuse(shown_path(path) + ": this is a folder", "Give a file.");
  auto source = ByteSource::open_file(path);
  if (!source) return refuse_io(path, "cannot be read");
  const std::uint64_t size = source->size().value_or(0);
  if (size > most) return refuse_size();
  std::string bytes;
  bytes.reserve(size + 1);  // one more, so that the end is seen without growing
  std::array<std::uint8_t, 1 << 16> piece;
  while (true) {
    const auto count = source->read(piece);
    if (!count) return refuse_io(path, "cannot be read");
    if (*count == 0) return bytes;
    if (*count > most - bytes.size()) return refuse_size();
    bytes.append(reinterpret_cast<const char*>(piece.data()), *count);
  }
}

Outcome check_standard_output() {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return {};
  return refuse_io("standard output", "cannot be written");
}

}  // namespace tactus::cli
